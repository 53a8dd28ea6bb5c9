#pragma once

#include <span>
#include <vector>

#include "mindahl/loop/record.h"

namespace mindahl::identification {

/// A record in units of the data, with the force in the displacement's sense.
struct ScaledRecord {
  std::vector<double> displacement;    // (δ − displacement_reference)/length
  std::vector<double> force;           // (sense·T − force_reference)/force unit
  std::vector<double> time;            // −1 … 1 over the record; by sample where it has no time
  std::vector<double> load_ratio;      // N over its mean; empty where the load is taken as constant
  std::vector<double> root_weight;     // of each residual; 0 where the sample does not count
  std::vector<std::size_t> reversals;  // samples
  double displacement_reference = 0.0;  // [m]
  double force_reference = 0.0;         // [N], in the displacement's sense
  double half_duration = 1.0;           // [s], or samples where the record has no time
};

/// Residuals of a noise-free record are rounding errors, to here [of the force unit]; smaller
/// differences between fits mean nothing.
inline constexpr double kRoundingRms = 1e-13;

/// All records in common units: what makes a fit independent of the units of its files.
struct ScaledRecords {
  std::vector<ScaledRecord> records;
  double length = 1.0;  // [m]: largest half range of displacement
  double force = 1.0;   // [N]: largest half range of force
  int sense = 1;

  [[nodiscard]] std::size_t samples() const;
  /// Samples that count.
  [[nodiscard]] std::size_t weighted_samples() const;
};

/// One series a record from all records' values one after the other.
std::vector<std::vector<double>> SplitByRecord(const ScaledRecords& data,
                                               std::span<const double> values);

/// Every sample counts alike, and the load as constant.
/// @param reversals  of each record
/// @throws InvalidArgument when displacement or force does not change, or by less than 1e-100 or
/// more
///   than 1e100
ScaledRecords Scale(std::span<const loop::Record> records,
                    std::span<const std::vector<std::size_t>> reversals, int sense);

}  // namespace mindahl::identification
