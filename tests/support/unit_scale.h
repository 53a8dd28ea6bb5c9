#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <string_view>

/// Converts numbers to other units. Powers of two round nothing: a scaled number differs from the
/// original in its exponent only.
namespace mindahl::testing {

/// Holds the factors of lengths, forces and times.
struct UnitScale {
  double length = 1.0;
  double force = 1.0;
  double time = 1.0;

  /// Returns the factor of a unit such as "N s/m" or "N/m²"; 1 of one without a dimension.
  [[nodiscard]] double Of(std::string_view unit) const {
    static const std::map<std::string_view, std::array<int, 3>> kPowers = {
        {"N", {0, 1, 0}},  {"m", {1, 0, 0}},   {"s", {0, 0, 1}},
        {"J", {1, 1, 0}},  {"Pa", {-2, 1, 0}}, {"kg", {-1, 1, 2}},
        {"m²", {2, 0, 0}}, {"N²", {0, 2, 0}},  {"1", {0, 0, 0}}};
    double factor = 1.0;
    bool divides = false;
    for (std::size_t begin = 0; begin < unit.size();) {
      const std::size_t end = std::min(unit.find_first_of(" /", begin), unit.size());
      const auto powers = kPowers.find(unit.substr(begin, end - begin));
      if (powers == kPowers.end()) return 1.0;
      const double of_token = std::pow(length, powers->second[0]) *
                              std::pow(force, powers->second[1]) *
                              std::pow(time, powers->second[2]);
      factor *= divides ? 1 / of_token : of_token;
      divides = end < unit.size() && unit[end] == '/';
      begin = end + 1;
    }
    return factor;
  }
};

}  // namespace mindahl::testing
