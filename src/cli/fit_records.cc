#include "cli/fit_records.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cli/progress.h"
#include "mindahl/core/memory.h"
#include "mindahl/io/record_reader.h"
#include "mindahl/request/fit_records.h"

namespace mindahl::cli {

using io::RecordFile;

namespace {

std::vector<RecordFile> ReadInputs(const FitRequest& request, const Messages& messages) {
  io::RecordColumns columns = request.columns;
  columns.covariates = CovariateColumns(request);
  std::vector<RecordFile> inputs;
  io::ReadLimits left{.rows = request.max_rows,
                      .memory = request.max_memory.value_or(MemoryOfProcess())};
  for (const std::string& file : request.files) {
    RecordFile& input = inputs.emplace_back(io::ReadRecord(file, columns, left));
    const std::size_t rows = input.record.size();
    left.rows -= std::min<std::uintmax_t>(left.rows, rows);
    left.memory -= std::min(left.memory, io::ReadLimits::MemoryOf(rows, 0));
    request::KeepTimeWindow(request, file, input);
    for (const std::string& note : input.notes) messages.Note(note);
  }
  return inputs;
}

}  // namespace

void Messages::Note(std::string_view text) const {
  stream << fmt::format("mindahl {}: note: {}\n", command, text);
}

void Messages::Warn(std::string_view text) const {
  stream << fmt::format("mindahl {}: warning: {}\n", command, text);
}

report::Report FitRecords(const FitRequest& request, const Messages& messages) {
  request::Validate(request);
  std::vector<RecordFile> inputs = ReadInputs(request, messages);
  std::size_t samples = 0;
  for (const RecordFile& input : inputs) samples += input.record.size();
  std::vector<std::string> notes;  // not into the line of progress
  std::optional<Progress> progress(std::in_place, messages.stream,
                                   fmt::format("fitting {} samples", samples));
  report::Report report = request::FitRecords(
      request, std::move(inputs), [&](std::string_view note) { notes.emplace_back(note); });
  progress.reset();
  for (const std::string& note : notes) messages.Note(note);
  return report;
}

}  // namespace mindahl::cli
