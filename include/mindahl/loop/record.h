#pragma once

#include <cstddef>
#include <vector>

namespace mindahl::loop {

/// A measured or simulated hysteresis record in SI units, one entry a sample, in order of time.
struct Record {
  std::vector<double> displacement;  ///< tangential displacement δ [m]
  std::vector<double> force;         ///< tangential force T [N]
  std::vector<double> time;          ///< [s]; empty when not recorded
  std::vector<double> normal_load;   ///< N [N]; empty when not recorded

  [[nodiscard]] std::size_t size() const { return displacement.size(); }
};

/// @throws InvalidArgument when the lengths differ or a value is not finite (names the row).
void Validate(const Record& record);

}  // namespace mindahl::loop
