#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "mindahl/core/error.h"
#include "mindahl/io/record_reader.h"
#include "mindahl/loop/segments.h"

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

namespace {

std::vector<double> Part(const std::vector<double>& column, const loop::ConstantLoad& piece) {
  if (column.empty()) return {};
  return {column.begin() + static_cast<std::ptrdiff_t>(piece.first),
          column.begin() + static_cast<std::ptrdiff_t>(piece.last)};
}

LoadPiece Described(const RecordFile& input, const loop::ConstantLoad& piece) {
  const auto line = [&](std::size_t sample) {
    return sample < input.lines.size() ? input.lines[sample] : sample + 1;
  };
  return {.normal_load = piece.normal_load,
          .first_line = line(piece.first),
          .last_line = line(piece.last - 1)};
}

NamedRecord NamedPieceOf(const RecordFile& input, const loop::ConstantLoad& piece,
                         const LoadPiece& description, const std::string& file) {
  RecordFile part = input;
  loop::Record& record = part.record;
  record.displacement = Part(input.record.displacement, piece);
  record.force = Part(input.record.force, piece);
  record.time = Part(input.record.time, piece);
  record.normal_load = Part(input.record.normal_load, piece);
  for (loop::Covariate& covariate : record.covariates) {
    covariate.values = Part(covariate.values, piece);
  }
  part.notes.clear();
  part.lines.clear();
  for (std::size_t i = piece.first; i < piece.last && i < input.lines.size(); ++i) {
    part.lines.push_back(input.lines[i]);
  }
  part.piece = description;
  std::string name = fmt::format("{}:{}-{}", file, description.first_line, description.last_line);
  return {.name = std::move(name), .file = std::move(part)};
}

}  // namespace

NamedRecord CutAtLoadRamps(const RecordFile& input, const std::string& file) {
  const std::optional<loop::ConstantLoad> piece = loop::FindSettledLoad(input.record);
  if (!piece) return {.name = file, .file = input};
  LoadPiece description = Described(input, *piece);
  description.is_between_ramps = true;
  description.left_out = input.record.size() - (piece->last - piece->first);
  return NamedPieceOf(input, *piece, description, file);
}

std::vector<NamedRecord> SplitAtLoadSteps(const RecordFile& input, const std::string& file) {
  const std::vector<loop::ConstantLoad> pieces = loop::FindLoadSteps(input.record);
  if (pieces.empty()) return {{.name = file, .file = input}};
  std::vector<NamedRecord> records;
  std::size_t kept = 0;
  for (const loop::ConstantLoad& piece : pieces) {
    kept += piece.last - piece.first;
    LoadPiece description = Described(input, piece);
    if (&piece == &pieces.back()) description.left_out = input.record.size() - kept;
    records.push_back(NamedPieceOf(input, piece, description, file));
  }
  return records;
}

}  // namespace mindahl::io
