#include "mindahl/io/time_window.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "mindahl/core/error.h"

namespace mindahl::io {

void KeepTimeWindow(RecordFile& input, const std::string& file, double first, double last) {
  loop::Record& record = input.record;
  if (record.time.empty()) {
    throw InputError(
        fmt::format("{}: --time-window needs a time column: name it with --time", file));
  }
  loop::Record kept;
  std::vector<std::size_t> lines;
  for (const loop::Covariate& covariate : record.covariates) {
    kept.covariates.push_back({.name = covariate.name, .unit = covariate.unit, .values = {}});
  }
  for (std::size_t i = 0; i < record.size(); ++i) {
    if (record.time[i] < first || record.time[i] > last) continue;
    if (!input.lines.empty()) lines.push_back(input.lines[i]);
    kept.displacement.push_back(record.displacement[i]);
    kept.force.push_back(record.force[i]);
    kept.time.push_back(record.time[i]);
    if (!record.normal_load.empty()) kept.normal_load.push_back(record.normal_load[i]);
    for (std::size_t c = 0; c < kept.covariates.size(); ++c) {
      kept.covariates[c].values.push_back(record.covariates[c].values[i]);
    }
  }
  if (kept.size() == 0) {
    const auto [begin, end] = std::ranges::minmax(record.time);
    throw InputError(
        fmt::format("{}: --time-window {}:{} holds no sample: the record runs from {} to {} s",
                    file, first, last, begin, end));
  }
  input.notes.push_back(fmt::format("{}: {} of {} samples lie in the time window {}:{} s", file,
                                    kept.size(), record.size(), first, last));
  record = std::move(kept);
  input.lines = std::move(lines);
}

}  // namespace mindahl::io
