#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <functional>
#include <span>
#include <string_view>
#include <vector>

#include "mindahl/identification/fit_options.h"
#include "mindahl/identification/terms.h"
#include "mindahl/loop/preparation.h"

namespace mindahl::identification {

/// Holds a record in units of the data, with the force's sign that of the displacement.
struct ScaledRecord {
  std::vector<double> displacement;  // (δ − displacement_reference)/length
  std::vector<double> force;         // (sign·T − force_reference)/force unit
  std::vector<double> time;          // −1 … 1 over the record; by sample where it has no time
  std::vector<double> velocity;      // in the first record's time; empty where there is none
  std::vector<double> acceleration;  // likewise; empty unless a term asks for it
  /// ln of the speed, in units of `velocity`, with its resolution; empty unless a term asks for it.
  std::vector<double> log_speed;
  /// N over its mean, where the law knows that it varies: empty where it is taken as constant.
  std::vector<double> load_ratio;
  std::vector<double> load_change;    // N over its mean less 1, where it varies and is not known
  std::vector<double> root_weight;    // of each residual; 0 where the sample does not count
  std::vector<unsigned char> counts;  // 1 where the sample counts, else 0
  /// Those of ScaledRecords::covariates, over half their range; empty where there are none.
  std::vector<std::vector<double>> covariates;
  /// The channel that is imposed, of those two; the other one answers, and is fitted.
  loop::Channel imposed = loop::Channel::kDisplacement;
  bool is_smoothed = false;    // does the displacement have noise, which was smoothed?
  bool turns_between = false;  // does the motion turn between samples, or at the outermost ones?
  std::vector<std::size_t> reversals;  // samples
  bool begins_at_turn = false;
  /// The record that this one has some samples of, of whose motion a lag is; else null.
  const ScaledRecord* whole = nullptr;
  TermUnits units;
  std::size_t first = 0;  // its place among the samples of all records, one after the other
  double load = 1.0;      // mean of N over that of all records; 1 where they are not a load series

  /// Returns the number of turns before the last sample that counts: later ones make no history.
  [[nodiscard]] std::size_t CountTurns() const;
  [[nodiscard]] bool Turns() const { return CountTurns() > 0; }
  /// True if the record begins further from the ends of its strokes than a share of their range.
  [[nodiscard]] bool StartsInside(double share) const;
  /// True if the record begins at both zeros of its file: there the contact is unloaded.
  [[nodiscard]] bool BeginsAtZeros(const Thresholds& thresholds) const;
  /// True if a record that turns twice or more begins on its later loop, as an excerpt of a steady
  /// loop does, also one from where its force is zero: the next stroke runs near the opposite
  /// place, and not near this one, as in a loop so narrow that an unloaded contact lies within.
  [[nodiscard]] bool BeginsOnLoop() const;

  [[nodiscard]] std::span<const double> excitation() const {
    return imposed == loop::Channel::kForce ? force : displacement;
  }
  [[nodiscard]] std::span<const double> response() const {
    return imposed == loop::Channel::kForce ? displacement : force;
  }
  [[nodiscard]] std::size_t size() const { return force.size(); }
  [[nodiscard]] const ScaledRecord& motion() const { return whole != nullptr ? *whole : *this; }

  /// Returns the record's part of values of all samples, one record after the other.
  template <typename T>
  [[nodiscard]] std::span<T> Of(std::span<T> all) const {
    return all.subspan(first, size());
  }
};

/// Returns the memory of a column, as the models write it.
inline std::span<double> SpanOf(Eigen::Ref<Eigen::VectorXd> column) {
  return {column.data(), static_cast<std::size_t>(column.size())};
}

/// Rms residual of a noise-free record, by rounding alone [of the force unit]: smaller differences
/// between fits mean nothing.
inline constexpr double kRoundingRms = 1e-13;

/// Returns the mean duration of a record's cycles, of two strokes each; 1 where it has none.
inline double MeanCycleDuration(double duration, std::size_t reversals) {
  return duration > 0 ? 2 * duration / static_cast<double>(reversals + 1) : 1.0;
}

/// Describes a column besides displacement and force that all records have.
struct CovariateColumn {
  std::string_view name = {};  // in the records' memory
  std::string_view unit = {};
  double scale = 1.0;  // half its largest range in a record, in its unit
};

/// All records in common units: what makes a fit independent of the units of its files.
struct ScaledRecords {
  std::vector<ScaledRecord> records;
  std::vector<CovariateColumn> covariates;  // that are fitted
  double length = 1.0;                      // [m]: largest half range of displacement
  double force = 1.0;                       // [N]: largest half range of force
  loop::Channel excitation = loop::Channel::kDisplacement;
  std::size_t counted = 0;        // samples that count
  std::vector<double> mean_load;  // [N] of each record; empty unless all are known
  double reference_load = 0.0;    // [N]: the mean of these; 0 where they are not known
  bool is_load_series = false;    // do these differ?
  bool load_varies = false;       // within a record, and the law knows it
  double prior_noise = 0.0;       // noise against which priors weigh, in response units

  /// True if the force is imposed, and the displacement fitted.
  [[nodiscard]] bool is_forced() const { return excitation == loop::Channel::kForce; }
  /// Returns the unit of the channel that is fitted [N or m].
  [[nodiscard]] double response_unit() const { return is_forced() ? length : force; }
  [[nodiscard]] std::size_t samples() const {
    return records.empty() ? 0 : records.back().first + records.back().size();
  }
  /// Returns a member of the records, a value a sample, one record after the other.
  template <typename Member>
  [[nodiscard]] Eigen::VectorXd All(Member member) const {
    Eigen::VectorXd all(static_cast<Eigen::Index>(samples()));
    auto end = all.begin();
    for (const ScaledRecord& record : records) {
      end = std::ranges::copy(std::invoke(member, record), end).out;
    }
    return all;
  }
};

/// Makes the records of a fit from prepared ones, of which samples beyond any lag that the options
/// allow are left out (motion.h), with the columns that the terms need (accelerations, speeds), and
/// covariates: each less the middle of its range in the record, so that the offset of the force
/// keeps its meaning; literally where there are no offsets. Normal loads are those of the options,
/// else the means of their columns over what counts, and a series where they differ by more than
/// the threshold. A column that varies by more than it enters the law where that knows such loads;
/// a reading below 0 is lift-off, of Dahl's own law a load from the other side.
/// @throws InvalidArgument when displacement or force does not change, or by less than 1e-100 or
///   more than 1e100, for loads that are not one for all or one a record, and positive, and where a
///   record has no covariate that is fitted, or it never changes, or is the force in other units
/// @param with  options for whose terms there are columns; null: for these
ScaledRecords Scale(loop::PreparedRecords& records, const FitOptions& options,
                    const FitOptions* with = nullptr);

/// A stroke: from the record's beginning or a reversal to the next reversal or its end.
struct Stroke {
  std::size_t begin = 0;
  std::size_t end = 0;     // the sample where it ends
  double direction = 1.0;  // +1 where the excitation grows, else −1
  double length = 0.0;     // of the change of the excitation, > 0 unless it rests
};
std::vector<Stroke> StrokesOf(const ScaledRecord& record);

/// Returns the strokes that are no shorter than `main_stroke` of the longest.
std::vector<Stroke> MainStrokes(const ScaledRecord& record, const Thresholds& thresholds);

/// Returns the direction of the stroke of each sample; a reversal is the last one's.
std::vector<double> DirectionsOf(const ScaledRecord& record);

/// Returns the records by fewer samples: all reversals, and of each stroke some, densest at its
/// start: the same history for a law that knows no rate. The records given must outlive them.
ScaledRecords Thinned(const ScaledRecords& data);

/// Returns the correlation of two columns of one size; 0 where one is constant.
double ColumnCorrelation(std::span<const double> one, std::span<const double> other);

/// True if two columns are one channel: linear in each other but for a tenth of their deviation.
bool AreOneChannel(std::span<const double> one, std::span<const double> other);

}  // namespace mindahl::identification
