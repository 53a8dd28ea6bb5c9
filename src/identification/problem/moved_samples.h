#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "identification/problem/scaled_records.h"
#include "mindahl/identification/fit_options.h"
#include "mindahl/identification/terms.h"
#include "mindahl/loop/preparation.h"
#include "mindahl/models/friction_model.h"
#include "mindahl/models/loading_path.h"
#include "models/normalized_response.h"

/// Contacts that are elsewhere than the displacement at the time of the force: T_file(t) = T(δ(t −
/// lag)) of a force that is read late, and those behind a gap.
namespace mindahl::identification {

/// Gives every record a clock: its time, and where that stands still or steps back the time evenly
/// between the last reading that went on and the next that does.
void SetClocks(ScaledRecords& data);

/// Returns the longest lag that is looked for, either way [mean cycles]: 0.05, but ten samples
/// where cycles have fewer than 200, and never more than 0.2. A delay of filters is one of samples.
double LongestLag(double samples_a_cycle);

/// Samples whose displacement lies beyond the record's ends under any lag that the options allow do
/// not count; they still make history.
/// @throws InvalidArgument where nothing is left of a record, where some records have a time and
///   others not, or one never goes on
void LeaveOutBeyondLags(const FitOptions& options, loop::PreparedRecords& records);

/// Samples of a record at the displacements at which the contact is, where these are not the
/// measured ones: a path of its own, in which places may be put in between the samples.
class MovedSamples {
 public:
  MovedSamples() = default;
  MovedSamples(const MovedSamples&) = default;
  MovedSamples& operator=(const MovedSamples&) = default;
  virtual ~MovedSamples() = default;

  /// Moves the samples where they were moved by another amount, or from another initial state.
  /// @param record  the same in every call
  void MoveTo(const ScaledRecord& record, double amount, models::Memory memory,
              const models::InitialContact& initial);

  /// Displacements of all places, in order of time.
  [[nodiscard]] std::span<const double> displacement() const { return displacement_; }
  [[nodiscard]] const models::LoadingPath& path() const { return path_; }
  /// Index of each sample in displacement().
  [[nodiscard]] std::span<const std::size_t> places() const { return places_; }
  /// Returns ∂δ/∂amount of each place.
  [[nodiscard]] std::span<const double> rates() const { return rates_; }

  /// Takes the force at all places, on which it may depend at which of them a sample is.
  virtual void TakeForces(std::span<const double> /*t*/) {}

  /// Writes a value of each sample from that of its place; 0 where the contact bears no force.
  /// @param at_samples  may be the beginning of `at_places`: no place is before its sample
  void Gather(std::span<const double> at_places, std::span<double> at_samples) const;

  /// Computes ∂t/∂amount at all places.
  virtual void DifferentiateByAmount(const models::OriginSensitivity& sensitivity,
                                     std::span<double> at_places) const = 0;

  /// Copies the path with runs of samples only.
  void CopyPathOfSamples(models::LoadingPath& path) const;

 protected:
  /// Fills what follows from the amount: displacements, their rates, turning points and places.
  virtual void Fill(const ScaledRecord& record, double amount,
                    const models::InitialContact& initial) = 0;
  void Clear(std::size_t most);
  void Append(double displacement, double rate) {
    displacement_.push_back(displacement);
    rates_.push_back(rate);
  }

  std::vector<double> displacement_;
  std::vector<double> rates_;
  std::vector<std::size_t> reversals_;  // places
  std::vector<std::size_t> places_;
  std::vector<unsigned char> bears_;  // 0 for a sample without force; empty where all have one
  models::LoadingPath path_;

 private:
  std::optional<double> amount_;  // empty until they are moved
  double unloaded_ = 0.0;
};

/// Locates the contact, and its branch, at the time of each force of a record that is read late by
/// an amount in the record's scaled time. The motion runs straight from sample to sample of the
/// displacement and turns at its reversals, whatever the lag: these are put in between the moved
/// samples, and so are both ends of the record, beyond which the displacement is constant.
class LaggedSamples : public MovedSamples {
 public:
  void DifferentiateByAmount(const models::OriginSensitivity& sensitivity,
                             std::span<double> at_places) const override;

 private:
  void Fill(const ScaledRecord& record, double lag, const models::InitialContact& initial) override;
};

/// Locates a contact behind a gap of width g, which bears no force while it is crossed:
///   T = max(F(δ − g/2), 0) + min(F(δ + g/2), 0)
/// F the force on the branch of the stroke, that runs from where the contact was when the last one
/// ended. There the gap is closed on the side of the force that is measured, so that the path of
/// the contact depends on g alone: exact where no turning point lies within the gap. Each sample
/// has two places, of which it takes the one that bears force.
class SamplesBehindGap : public MovedSamples {
 public:
  void TakeForces(std::span<const double> t) override;
  void DifferentiateByAmount(const models::OriginSensitivity& sensitivity,
                             std::span<double> at_places) const override;

 private:
  struct Place {
    double displacement = 0.0;
    double rate = 0.0;
  };

  void Fill(const ScaledRecord& record, double gap, const models::InitialContact& initial) override;
  /// Fills the places of a stroke's samples from `first`, in the order in which the contact comes
  /// by.
  void FillStroke(const Stroke& stroke, std::size_t first, std::span<const double> x, Place from,
                  Place to);

  double gap_ = 0.0;
  std::vector<double> direction_;       // of the stroke of each sample
  std::vector<std::size_t> unloading_;  // place while the force is still that before the reversal
  std::vector<std::size_t> loading_;    // place once the gap is crossed
};

std::unique_ptr<MovedSamples> MakeMovedSamples(ContactMotion motion);

}  // namespace mindahl::identification
