#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "io/source.h"
#include "mindahl/io/record_reader.h"
#include "mindahl/loop/segments.h"

namespace mindahl::io {

void KeepTimeWindow(RecordFile& input, double first, double last) {
  const std::vector<double>& time = input.record.time;
  if (time.empty()) {
    Refuse("{}: --time-window needs a time column: name it with --time", input.name);
  }
  const auto begin = std::ranges::lower_bound(time, first);
  const auto end = std::ranges::upper_bound(time, last);
  if (begin >= end) {
    Refuse("{}: --time-window {}:{} holds no sample: the record runs from {} to {} s", input.name,
           first, last, time.front(), time.back());
  }
  input.notes.push_back(fmt::format("{}: {} of {} samples lie in the time window {}:{} s",
                                    input.name, end - begin, time.size(), first, last));
  KeepSamples(input, static_cast<std::size_t>(begin - time.begin()),
              static_cast<std::size_t>(end - time.begin()));
}

void KeepSamples(RecordFile& input, std::size_t first, std::size_t last) {
  const auto keep = [first, last](auto& column) {
    if (column.empty()) return;
    column.resize(last);
    column.erase(column.begin(), column.begin() + static_cast<std::ptrdiff_t>(first));
  };
  for (const auto column : loop::kRecordColumns) keep(input.record.*column);
  for (loop::Covariate& covariate : input.record.covariates) keep(covariate.values);
  keep(input.lines);
}

std::vector<RecordFile> SplitAtLoadSteps(const RecordFile& input) {
  const std::vector<loop::ConstantLoad> pieces = loop::FindLoadSteps(input.record);
  if (pieces.empty()) return {input};
  std::vector<RecordFile> records;
  for (const loop::ConstantLoad& piece : pieces) {
    RecordFile& added = records.emplace_back(input);
    KeepSamples(added, piece.first, piece.last);
    added.notes.clear();
    added.name = fmt::format("{}:{}-{}", input.name, input.LineOf(piece.first),
                             input.LineOf(piece.last - 1));
  }
  return records;
}

double JoinedTimes::Next(double time) {
  if (begins_ && time + shift_ < last_) shift_ = last_ + step_ - time;
  begins_ = false;
  time += shift_;
  if (std::isfinite(last_) && time >= last_) step_ = time - last_;
  last_ = time;
  return time;
}

}  // namespace mindahl::io
