#include "cli/fit_records.h"

#include <fmt/format.h>

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cli/progress.h"
#include "mindahl/io/record_reader.h"
#include "mindahl/request/fit_records.h"

namespace mindahl::cli {

void Messages::Note(std::string_view text) const {
  stream << fmt::format("mindahl {}: note: {}\n", command, text);
}

void Messages::Warn(std::string_view text) const {
  stream << fmt::format("mindahl {}: warning: {}\n", command, text);
}

report::Report FitRecords(const FitRequest& request, const Messages& messages) {
  request::Validate(request);
  std::vector<io::RecordFile> inputs =
      request::ReadRecords(request, [&](std::string_view note) { messages.Note(note); });
  std::size_t samples = 0;
  for (const io::RecordFile& input : inputs) samples += input.record.size();
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
