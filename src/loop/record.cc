#include "mindahl/loop/record.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "mindahl/core/error.h"

namespace mindahl::loop {

void Validate(const RecordView& record) {
  const auto require = [&](std::string_view quantity, std::span<const double> column) {
    const std::string_view name = quantity.substr(0, quantity.find(" ["));
    RequireSameSize("displacement", record.size(), name, column.size());
    const auto row = std::ranges::find_if_not(column, [](double x) { return std::isfinite(x); });
    if (row == column.end()) return;
    ThrowInvalid(fmt::format("{} of sample {}", quantity, row - column.begin()), *row,
                 "must be finite");
  };
  require("displacement [m]", record.displacement);
  require("force [N]", record.force);
  if (!record.time.empty()) require("time [s]", record.time);
  if (!record.normal_load.empty()) require("normal load [N]", record.normal_load);
  for (const Covariate& covariate : record.covariates) require(covariate.name, covariate.values);
}

}  // namespace mindahl::loop
