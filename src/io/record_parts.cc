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

void RequireJoinable(const RecordFile& first, const RecordFile& next) {
  const auto require = [&](bool same, std::string_view what) {
    if (same) return;
    Refuse(
        "--join: one of {} and {} has {} and the other does not: pieces of one record must have "
        "the same columns",
        first.name, next.name, what);
  };
  require(bool(next.time) == bool(first.time), "a time");
  require(bool(next.normal_load) == bool(first.normal_load), "a normal load");
  require(next.is_torsional == first.is_torsional, "a torque");
}

RecordFile Joined(std::vector<RecordFile> records) {
  RecordFile joined = std::move(records.front());
  joined.lines.clear();
  JoinedTimes times;
  const auto shift = [&](double time) { return times.Next(time); };
  std::ranges::transform(joined.record.time, joined.record.time.begin(), shift);
  for (std::size_t k = 1; k < records.size(); ++k) {
    RecordFile& next = records[k];
    RequireJoinable(joined, next);
    times.NextPiece();
    std::ranges::transform(next.record.time, next.record.time.begin(), shift);
    const auto append = [](const std::vector<double>& from, std::vector<double>& to) {
      to.insert(to.end(), from.begin(), from.end());
    };
    loop::Record& record = joined.record;
    for (const auto column : loop::kRecordColumns) append(next.record.*column, record.*column);
    for (std::size_t c = record.covariates.size(); c-- > 0;) {
      const auto same = std::ranges::find(next.record.covariates, record.covariates[c].name,
                                          &loop::Covariate::name);
      if (same != next.record.covariates.end()) {
        append(same->values, record.covariates[c].values);
      } else {
        record.covariates.erase(record.covariates.begin() + static_cast<std::ptrdiff_t>(c));
      }
    }
    joined.notes.insert(joined.notes.end(), next.notes.begin(), next.notes.end());
  }
  joined.name = fmt::format("{} … {}", joined.name, records.back().name);
  return joined;
}

}  // namespace mindahl::io
