#include "mindahl/loop/record.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <span>
#include <string_view>

#include "mindahl/core/error.h"

namespace mindahl::loop {
namespace {

/// Vectors of integers tell it: one more in the exponent carries into the sign where all of its
/// bits are set.
bool AreAllFinite(std::span<const double> column) {
  constexpr std::uint64_t kExponent = 0x7ff0000000000000;
  constexpr std::uint64_t kOne = 0x0010000000000000;
  std::uint64_t carried = 0;
  for (const double value : column) {
    carried |= (std::bit_cast<std::uint64_t>(value) & kExponent) + kOne;
  }
  return (carried >> 63) == 0;
}

void RequireFiniteColumn(std::string_view quantity, std::span<const double> column) {
  if (AreAllFinite(column)) return;
  const auto row = std::ranges::find_if_not(column, [](double x) { return std::isfinite(x); });
  ThrowInvalid(fmt::format("{} of sample {}", quantity, row - column.begin()), *row,
               "must be finite");
}

}  // namespace

void Validate(const RecordView& record) {
  RequireSameSize("displacement", record.displacement.size(), "force", record.force.size());
  if (!record.time.empty()) {
    RequireSameSize("displacement", record.size(), "time", record.time.size());
  }
  if (!record.normal_load.empty()) {
    RequireSameSize("displacement", record.size(), "normal load", record.normal_load.size());
  }
  RequireFiniteColumn("displacement [m]", record.displacement);
  RequireFiniteColumn("force [N]", record.force);
  RequireFiniteColumn("time [s]", record.time);
  RequireFiniteColumn("normal load [N]", record.normal_load);
  for (const Covariate& covariate : record.covariates) {
    RequireSameSize("displacement", record.size(), covariate.name, covariate.values.size());
    RequireFiniteColumn(covariate.name, covariate.values);
  }
}

}  // namespace mindahl::loop
