#include "mindahl/loop/record.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <span>
#include <string_view>

#include "mindahl/core/error.h"

namespace mindahl::loop {
namespace {

void RequireFiniteColumn(std::string_view quantity, std::span<const double> column) {
  bool all = true;  // without a jump: the usual case
  for (const double value : column) all &= std::abs(value) <= std::numeric_limits<double>::max();
  for (std::size_t row = 0; !all && row < column.size(); ++row) {
    if (!std::isfinite(column[row])) {
      ThrowInvalid(fmt::format("{} of sample {}", quantity, row), column[row], "must be finite");
    }
  }
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
}

}  // namespace mindahl::loop
