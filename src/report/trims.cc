#include "report/trims.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <string_view>

#include "report/field_table.h"

namespace mindahl::report {

using loop::Settling;
using loop::Trim;
using loop::TrimmedPart;
using loop::TrimReason;

namespace {

std::string CyclesText(std::size_t cycles) {
  return fmt::format("{} cycle{}", cycles, cycles == 1 ? "" : "s");
}

std::string TrimmedPartInWords(const TrimmedPart& part) {
  switch (part.reason) {
    case TrimReason::kRest:
      return fmt::format("{} samples at rest {}", part.samples(),
                         part.at_start ? "before the motion" : "after it");
    case TrimReason::kRamp:
      return fmt::format("{} in which the amplitude {}", CyclesText(part.cycles),
                         part.at_start ? "grows" : "falls");
    case TrimReason::kRunningIn:
      break;
  }
  return fmt::format("{} of running in", CyclesText(part.cycles));
}

/// Returns the reason why cycles do not show that the contact has run in.
std::string_view WhyNotSettled(Settling settling) {
  switch (settling) {
    case Settling::kFewCycles:
      return "there are too few cycles of one amplitude to see a running-in";
    case Settling::kUnsettled:
      return "the half gap or the energy does not settle, so no running-in is left out: look at "
             "how they change, and choose cycles with --cycles";
    case Settling::kSettled:
      break;
  }
  return "";
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
  const std::string_view why = WhyNotSettled(trim.settling);
  if (parts.empty()) {
    return {"nothing_trimmed",
            fmt::format("--trim auto leaves nothing out of {}: {}", report.files[r],
                        why.empty() ? "it has no rest and no ramp, and its cycles agree" : why)};
  }
  std::string text =
      fmt::format("--trim auto leaves out of {}: {}", report.files[r], fmt::join(parts, ", "));
  if (trim.has_first_loading()) {
    text +=
        "; the first loading is among them, which distinguishes Masing's law from Dahl's own and a "
        "virgin "
        "contact from a steady one";
  }
  if (trim.begins_later()) {
    const bool is_steady = report.fit.initial_state == models::InitialState::kSteady;
    text += fmt::format(
        "; the rest is fitted as a {}",
        is_steady ? "steady contact, unless --initial-state says otherwise" : "virgin contact");
  }
  if (!why.empty()) text += fmt::format("; {}", why);
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
      {"reason", "", "rest, ramp of the amplitude, or running_in",
       [](const Item& item) { return loop::NameOf(item.part.reason); }},
      {"first_line", "", "first line of the part in the file, counted from 1", &Item::first_line},
      {"last_line", "", "likewise", &Item::last_line},
      {"samples", "", "samples that do not count",
       [](const Item& item) { return item.part.samples(); }},
      {"cycles", "", "closed cycles among them", [](const Item& item) { return item.part.cycles; }},
      {"first_loading", "",
       "true if the first loading, before the first turning point, is left out",
       [](const Item& item) { return item.part.has_first_loading; }},
  };
  return fields;
}

}  // namespace mindahl::report
