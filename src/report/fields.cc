#include "report/fields.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <utility>

#include "mindahl/core/version.h"
#include "report/field_table.h"
#include "report/names.h"
#include "report/trims.h"

namespace mindahl::report {

using identification::RecordFit;
using loop::ReversalGate;

namespace {

/// Returns the sum over the records of what one of them has.
template <typename Get>
std::function<std::size_t(const Report&)> Sum(Get get) {
  return [get](const Report& report) {
    std::size_t sum = 0;
    for (const RecordFit& record : report.fit.records) sum += get(record);
    return sum;
  };
}

template <typename Get>
auto OneARecord(Get get) {
  return [get](const Report& report) {
    std::vector<std::optional<typename Result<Get, RecordFit>::Type>> list;
    list.reserve(report.fit.records.size());
    for (const RecordFit& record : report.fit.records) list.push_back(std::invoke(get, record));
    return list;
  };
}

const ReversalGate& GateOf(const Report& report) { return report.fit.WidestRecord().gate; }

/// Makes a getter of the gate that competes, absent where the gate is certain.
template <typename Member>
auto OfOtherGate(Member member) {
  return IfAny([](const Report& report) { return If(!GateOf(report).certain, GateOf(report)); },
               member);
}

struct LoadPieceItem {
  std::string file;
  io::LoadPiece piece;
  std::size_t samples;
};

/// Returns the pieces; empty where no record is one.
std::optional<std::vector<LoadPieceItem>> LoadPieces(const Report& report) {
  std::vector<LoadPieceItem> pieces;
  for (std::size_t r = 0; r < report.records.size(); ++r) {
    const io::RecordFile& record = report.records[r];
    if (!record.piece) continue;
    pieces.push_back(
        {.file = report.files[r], .piece = *record.piece, .samples = record.record.size()});
  }
  return pieces.empty() ? std::nullopt : std::optional(std::move(pieces));
}

const std::vector<Field<LoadPieceItem>>& LoadPieceFields() {
  using Item = LoadPieceItem;
  static const std::vector<Field<Item>> fields = {
      {"file", "", "name of the record: that of the file with the lines of the piece", &Item::file},
      {"normal_load", "N", "median of the load", At(&Item::piece, &io::LoadPiece::normal_load)},
      {"first_line", "", "first line of the piece in the file, counted from 1",
       At(&Item::piece, &io::LoadPiece::first_line)},
      {"last_line", "", "likewise", At(&Item::piece, &io::LoadPiece::last_line)},
      {"samples", "", "samples of the piece, including those that do not count", &Item::samples},
  };
  return fields;
}

std::size_t BetweenLoads(const Report& report) {
  std::size_t samples = 0;
  for (const io::RecordFile& record : report.records) {
    if (record.piece) samples += record.piece->left_out;
  }
  return samples;
}

const io::RecordFile& FirstRecord(const Report& report) { return report.records.front(); }
constexpr auto kFirst = &FirstRecord;

void AddInputFields(FieldTable& table) {
  table.Add({
      {"schema", "", "name and version of the schema",
       [](const Report&) { return "mindahl.fit/1"; }},
      {"version", "", "version of mindahl", [](const Report&) { return Version(); }},
      {"input.files", "",
       "names of the files, as given; with line numbers where a record is a piece of a file",
       &Report::files},
      {"input.samples", "", "samples read, including those that do not count",
       [](const Report& report) {
         std::size_t samples = BetweenLoads(report);
         for (const io::RecordFile& input : report.records) samples += input.record.size();
         return samples;
       }},
      {"input.load_pieces", "",
       "pieces that were fitted as records of their own, of files whose load changes in steps, or "
       "ramps with --trim auto; absent where there are none",
       IfAny(&LoadPieces, [](const auto& pieces) { return List(LoadPieceFields(), pieces); })},
      {"input.between_loads", "",
       "samples in none of the pieces, which do not count: the load changes, or fewer than two "
       "turning points have passed since; absent likewise",
       IfAny([](const Report& report) { return If(LoadPieces(report).has_value(), report); },
             &BetweenLoads)},
      {"input.trimmed", "",
       "samples that --trim auto leaves out under the fitted load; may be empty, absent without "
       "--trim auto",
       IfAny([](const Report& report) { return If(!report.trims.empty(), report); },
             [](const Report& report) { return List(TrimmedFields(), TrimmedItems(report)); })},
      {"input.cycles", "", "complete cycles, of all files",
       Sum([](const RecordFit& record) { return record.measures.cycles; })},
      {"input.reversals", "", "turning points of the motion, of all files",
       Sum([](const RecordFit& record) { return record.reversals.size(); })},
      {"input.units.displacement", "", "unit of the column in the first file",
       At(kFirst, &io::RecordFile::displacement, &io::ChosenColumn::unit)},
      {"input.units.force", "", "unit of the column in the first file",
       At(kFirst, &io::RecordFile::force, &io::ChosenColumn::unit)},
      {"input.units.time", "", "likewise; absent where there is no such column",
       IfAny(kFirst, &io::RecordFile::time, &io::ChosenColumn::unit)},
      {"input.units.normal_load", "", "likewise; absent where there is no such column",
       IfAny(kFirst, &io::RecordFile::normal_load, &io::ChosenColumn::unit)},
      {"input.left_out", "", "samples that do not count",
       [](const Report& report) {
         std::size_t left_out = BetweenLoads(report);
         for (const RecordFit& record : report.fit.records) left_out += record.left_out;
         return left_out;
       }},
      {"input.reversal_gate", kOfExcitation, "one per file: excursions up to it are noise",
       OneARecord([](const RecordFit& record) { return record.gate.gate; })},
      {"input.displacement_noise", "m", "one per file: standard deviation, given or estimated",
       OneARecord(&RecordFit::displacement_noise)},
      {"input.initial_state", "", "one per file: virgin or steady",
       OneARecord(&RecordFit::initial_state)},
      {"input.response_noise", kOfResponse,
       "one per file: standard deviation of the noise of the fitted channel, given or estimated",
       OneARecord(&RecordFit::response_noise)},
      {"input.force_sign", "", "same or opposite: sign of the force relative to the displacement",
       [](const Report& report) { return report.fit.force_sense > 0 ? "same" : "opposite"; }},
      {"input.glitches.spikes", "", "samples left out that are far off their neighbours",
       Sum([](const RecordFit& record) { return record.glitches.spikes; })},
      {"input.glitches.dropouts", "", "samples left out that read 0 in both channels",
       Sum([](const RecordFit& record) { return record.glitches.dropouts; })},
      {"input.glitches.held", "", "samples left out that repeat a value before it jumps",
       Sum([](const RecordFit& record) { return record.glitches.held; })},
      {"reversals.count", "", "turning points of the motion in the widest record",
       [](const Report& report) { return report.fit.WidestRecord().reversals.size(); }},
      {"reversals.gate", kOfExcitation, "excursions up to it are noise",
       At(&GateOf, &ReversalGate::gate)},
      {"reversals.certain", "", "true if no other gate is as plausible",
       At(&GateOf, &ReversalGate::certain)},
      {"reversals.other_count", "", "turning points under the other gate; absent where certain",
       OfOtherGate(&ReversalGate::other_count)},
      {"reversals.other_gate", kOfExcitation, "the other gate; absent where certain",
       OfOtherGate(&ReversalGate::other_gate)},
  });
}

FieldTable MakeTable() {
  FieldTable table;
  AddInputFields(table);
  table.Describe("input.load_pieces[].", LoadPieceFields());
  table.Describe("input.trimmed[].", TrimmedFields());
  AddAdequacyFields(table);
  AddMeasuredFields(table);
  AddParameterFields(table);
  AddSlipForceFields(table);
  AddLawFields(table);
  AddResidualFields(table);
  AddSelectionFields(table);
  AddSolverFields(table);
  AddLoopFields(table);
  AddContactFields(table);
  AddMappingFields(table);
  AddLoadSeriesFields(table);
  // In a fit that failed, every missing value is null for that reason.
  for (Field<Report>& row : table.rows) {
    const bool is_of_contact = row.path.starts_with("contact.") || row.path.starts_with("mapping.");
    row.why_null = [why = std::move(row.why_null), is_of_contact](const Report& report) {
      if (report.failed()) return WhyFailed(report);
      return is_of_contact && report.is_torsional() ? std::string(kWhyNoContact) : why(report);
    };
  }
  return table;
}

const FieldTable& AllFields() {
  static const FieldTable table = MakeTable();
  return table;
}

}  // namespace

std::string WhyFailed(const Report& report) {
  return "the fit failed: " + report.fit.solver.message;
}

std::vector<FieldDescription> DescribeFields() {
  std::vector<FieldDescription> descriptions;
  for (const FieldDescription& row : AllFields().rows) descriptions.push_back(row);
  descriptions.insert(descriptions.end(), AllFields().items.begin(), AllFields().items.end());
  descriptions.push_back({"nulls[].path", "", "where the null is"});
  descriptions.push_back({"nulls[].why", "", "why it is one"});
  for (const char* list : {"warnings", "notes"}) {
    descriptions.push_back({std::string(list) + "[].code", "", "stable name, for scripts"});
    descriptions.push_back({std::string(list) + "[].message", "", "sentence, for people"});
  }
  return descriptions;
}

std::vector<DescribedValue> ValuesUnder(const Report& report, const Json& document,
                                        std::string_view prefix) {
  static const std::vector<FieldDescription> descriptions = DescribeFields();
  std::vector<DescribedValue> described;
  for (const FieldDescription& field : descriptions) {
    const bool is_in_list = field.path.find("[]") != std::string::npos;
    if (is_in_list || !field.path.starts_with(prefix)) continue;
    const Json::json_pointer place = PointerTo(field.path);
    if (!document.contains(place)) continue;
    const Json& value = document.at(place);
    if (value.is_structured() || value.is_null()) continue;
    described.push_back({.field = field, .value = value});
    described.back().field.unit = UnitIn(report.units, field.unit);
  }
  return described;
}

Json JsonDocument(const Report& report) {
  Value document = Render(AllFields().rows, report);
  Json json = std::move(document.json);
  json["nulls"] = Json::array();
  for (const NullPlace& null : document.nulls) {
    json["nulls"].push_back({{"path", null.path}, {"why", null.why}});
  }
  const auto append = [](Json& list, const std::vector<Warning>& warnings) {
    for (const Warning& warning : warnings) {
      list.push_back({{"code", warning.code}, {"message", warning.message}});
    }
  };
  append(json["warnings"] = Json::array(), report.fit_warnings);
  append(json["warnings"], report.contact_warnings);
  append(json["notes"] = Json::array(), report.notes);
  return json;
}

}  // namespace mindahl::report
