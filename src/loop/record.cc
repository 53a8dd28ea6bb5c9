#include "mindahl/loop/record.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <string_view>

#include "core/extremes.h"
#include "mindahl/core/error.h"

namespace mindahl::loop {
namespace {

void RequireFiniteColumn(std::string_view quantity, std::span<const double> column) {
  if (AreAllWithin(column, std::numeric_limits<double>::max())) return;
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
