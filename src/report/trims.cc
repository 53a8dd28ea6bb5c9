#include "report/trims.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <string_view>

#include "report/field_table.h"

namespace mindahl::report {

using loop::Trim;
using loop::TrimmedPart;

namespace {

std::string TrimmedPartInWords(const TrimmedPart& part) {
  return fmt::format("{} samples at rest {}", part.samples(),
                     part.at_start ? "before the motion" : "after it");
}

std::size_t LineOf(const io::RecordFile& file, std::size_t sample) {
  return sample < file.lines.size() ? file.lines[sample] : sample + 1;
}

Warning NoteOf(const Report& report, std::size_t r) {
  const Trim& trim = report.trims[r];
  std::vector<std::string> parts;
  const auto& piece = report.records[r].piece;
  if (piece && piece->is_between_ramps) {
    parts.push_back(
        fmt::format("{} samples under another normal load than {:.4g} N, and up to the second "
                    "turning point under it",
                    piece->left_out, piece->normal_load));
  }
  for (const TrimmedPart& part : trim.parts) parts.push_back(TrimmedPartInWords(part));
  if (parts.empty()) {
    return {"nothing_trimmed",
            fmt::format("--trim auto leaves nothing out of {}: it has no rest", report.files[r])};
  }
  const std::string text =
      fmt::format("--trim auto leaves out of {}: {}", report.files[r], fmt::join(parts, ", "));
  return {"trimmed", text};
}

}  // namespace

std::vector<Warning> TrimNotes(const Report& report) {
  std::vector<Warning> notes;
  notes.reserve(report.trims.size());
  for (std::size_t r = 0; r < report.trims.size(); ++r) notes.push_back(NoteOf(report, r));
  return notes;
}

std::vector<TrimmedItem> TrimmedItems(const Report& report) {
  std::vector<TrimmedItem> items;
  for (std::size_t r = 0; r < report.trims.size(); ++r) {
    const Trim& trim = report.trims[r];
    for (const TrimmedPart& part : trim.parts) {
      items.push_back({.file = report.files[r],
                       .part = part,
                       .first_line = LineOf(report.records[r], part.first),
                       .last_line = LineOf(report.records[r], part.last - 1)});
    }
  }
  return items;
}

const std::vector<Field<TrimmedItem>>& TrimmedFields() {
  using Item = TrimmedItem;
  static const std::vector<Field<Item>> fields = {
      {"file", "", "name of the record", &Item::file},
      {"reason", "", "rest", [](const Item&) { return std::string_view("rest"); }},
      {"first_line", "", "first line of the part in the file, counted from 1", &Item::first_line},
      {"last_line", "", "likewise", &Item::last_line},
      {"samples", "", "samples that do not count",
       [](const Item& item) { return item.part.samples(); }},
  };
  return fields;
}

}  // namespace mindahl::report
