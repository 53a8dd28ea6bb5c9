#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "identification/problem/scaled_records.h"
#include "mindahl/identification/fit_options.h"
#include "mindahl/loop/preparation.h"
#include "mindahl/models/friction_model.h"
#include "mindahl/models/loading_path.h"

/// Forces that are read some time after the displacement: T_file(t) = T(δ(t − lag)).
namespace mindahl::identification {

/// True if all records have a time that increases, or none has a time.
bool MayHaveClocks(const ScaledRecords& data);

/// Gives every record a clock: its time, and where that stands still or steps back the time evenly
/// between the last reading that went on and the next that does.
/// @param data  MayHaveClocks()
void SetClocks(ScaledRecords& data);

/// Returns the longest lag that is looked for, either way [mean cycles]: 0.05, but ten samples
/// where cycles have fewer than 200, and never more than 0.2. A delay of filters is one of samples.
double LongestLag(double samples_a_cycle);

/// Samples whose displacement lies beyond the record's ends under any lag that the options allow do
/// not count; they still make history.
/// @throws InvalidArgument where nothing is left of a record, where some records have a time and
///   others not, or one never goes on
void LeaveOutBeyondLags(const FitOptions& options, loop::PreparedRecords& records);

/// Locates the contact, and its branch, at the time of each force of a record. The motion runs
/// straight from sample to sample of the displacement and turns at its reversals, whatever the lag:
/// these are put in between the moved samples, and so are both ends of the record, beyond which the
/// displacement is constant.
class LaggedMotion {
 public:
  /// @param record  with a clock; must not have moved since the last call that bound it
  /// @param lag     by which the force is late, in the record's scaled time
  void MoveTo(const ScaledRecord& record, double lag, models::Memory memory,
              const models::InitialContact& initial);
  void Forget() { valid_ = false; }
  /// True if it is valid for this lag and initial state.
  [[nodiscard]] bool IsAt(double lag, const models::InitialContact& initial) const {
    return valid_ && lag == lag_ && initial.unloaded_displacement == unloaded_ &&
           initial.asymmetry == path_.asymmetry;
  }

  /// Displacements of moved samples, reversals and ends, in order of time.
  [[nodiscard]] std::span<const double> displacement() const { return displacement_; }
  [[nodiscard]] const models::LoadingPath& path() const { return path_; }
  /// Index of each sample in displacement().
  [[nodiscard]] std::span<const std::size_t> places() const { return places_; }
  /// ∂δ/∂lag of each sample, 0 beyond the ends.
  [[nodiscard]] std::span<const double> rates() const { return rates_; }

  /// The path with runs of samples only.
  void CopyPathOfSamples(models::LoadingPath& path) const;

 private:
  bool valid_ = false;
  double lag_ = 0.0;
  double unloaded_ = 0.0;
  std::vector<double> displacement_;
  std::vector<std::size_t> reversals_;
  std::vector<std::size_t> places_;
  std::vector<double> rates_;
  models::LoadingPath path_;
};

}  // namespace mindahl::identification
