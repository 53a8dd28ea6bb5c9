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
std::function<Value(const Report&)> Sum(Get get) {
  return [get](const Report& report) {
    std::size_t sum = 0;
    for (const RecordFit& record : report.fit.records) sum += get(record);
    return Count(sum);
  };
}

template <typename Get>
std::function<Value(const Report&)> OneARecord(Get get) {
  return [get](const Report& report) {
    Value::Array array;
    for (const RecordFit& record : report.fit.records) array.push_back(Number(get(record)));
    return Value{std::move(array)};
  };
}

/// Makes a getter of the reversal gate of the widest record.
template <typename Get>
std::function<Value(const Report&)> OfGate(Get get) {
  return [get](const Report& report) { return get(report.fit.WidestRecord().gate); };
}

Value UnitOf(const std::optional<io::ChosenColumn>& column) {
  return column ? Text(column->unit) : Value{};
}

struct LoadPieceItem {
  std::string file;
  io::LoadPiece piece;
  std::size_t samples;
};

std::vector<LoadPieceItem> LoadPieces(const Report& report) {
  std::vector<LoadPieceItem> pieces;
  for (std::size_t r = 0; r < report.records.size(); ++r) {
    const io::RecordFile& record = report.records[r];
    if (!record.piece) continue;
    pieces.push_back(
        {.file = report.files[r], .piece = *record.piece, .samples = record.record.size()});
  }
  return pieces;
}

const std::vector<Field<LoadPieceItem>>& LoadPieceFields() {
  using Item = LoadPieceItem;
  static const std::vector<Field<Item>> fields = {
      {"file", "", "name of the record: that of the file with the lines of the piece",
       [](const Item& item) { return Text(item.file); }},
      {"normal_load", "N", "median of the load",
       [](const Item& item) { return Number(item.piece.normal_load); }},
      {"first_line", "", "first line of the piece in the file, counted from 1",
       [](const Item& item) { return Count(item.piece.first_line); }},
      {"last_line", "", "likewise", [](const Item& item) { return Count(item.piece.last_line); }},
      {"samples", "", "samples of the piece, including those that do not count",
       [](const Item& item) { return Count(item.samples); }},
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

void AddInputFields(FieldTable& table) {
  table.Add({
      {"schema", "", "name and version of the schema",
       [](const Report&) { return Text("mindahl.fit/1"); }},
      {"version", "", "version of mindahl", [](const Report&) { return Text(Version()); }},
      {"input.files", "",
       "names of the files, as given; with line numbers where a record is a piece of a file",
       [](const Report& report) {
         Value::Array files;
         for (const std::string& file : report.files) files.push_back(Text(file));
         return Value{std::move(files)};
       }},
      {"input.samples", "", "samples read, including those that do not count",
       [](const Report& report) {
         std::size_t samples = BetweenLoads(report);
         for (const io::RecordFile& input : report.records) samples += input.record.size();
         return Count(samples);
       }},
      {"input.load_pieces", "",
       "pieces that were fitted as records of their own, of files whose load changes in steps, "
       "or ramps with --trim auto; absent where there are none",
       [](const Report& report) {
         const std::vector<LoadPieceItem> pieces = LoadPieces(report);
         return pieces.empty() ? Value{} : List(LoadPieceFields(), pieces);
       }},
      {"input.between_loads", "",
       "samples in none of the pieces, which do not count: the load changes, or fewer than two "
       "turning points have passed since; absent likewise",
       [](const Report& report) {
         return LoadPieces(report).empty() ? Value{} : Count(BetweenLoads(report));
       }},
      {"input.trimmed", "",
       "samples that --trim auto leaves out under the fitted load; may be empty, absent without "
       "--trim auto",
       [](const Report& report) {
         return report.trims.empty() ? Value{} : List(TrimmedFields(), TrimmedItems(report));
       }},
      {"input.cycles", "", "complete cycles, of all files",
       Sum([](const RecordFit& record) { return record.measures.cycles; })},
      {"input.reversals", "", "turning points of the motion, of all files",
       Sum([](const RecordFit& record) { return record.reversals.size(); })},
      {"input.units.displacement", "", "unit of the column in the first file",
       [](const Report& report) { return Text(report.records.front().displacement.unit); }},
      {"input.units.force", "", "unit of the column in the first file",
       [](const Report& report) { return Text(report.records.front().force.unit); }},
      {"input.units.time", "", "likewise; absent where there is no such column",
       [](const Report& report) { return UnitOf(report.records.front().time); }},
      {"input.units.normal_load", "", "likewise; absent where there is no such column",
       [](const Report& report) { return UnitOf(report.records.front().normal_load); }},
      {"input.left_out", "", "samples that do not count",
       [](const Report& report) {
         std::size_t left_out = BetweenLoads(report);
         for (const RecordFit& record : report.fit.records) left_out += record.left_out;
         return Count(left_out);
       }},
      {"input.reversal_gate", kOfExcitation, "one per file: excursions up to it are noise",
       OneARecord([](const RecordFit& record) { return record.gate.gate; })},
      {"input.displacement_noise", "m", "one per file: standard deviation, given or estimated",
       OneARecord([](const RecordFit& record) { return record.displacement_noise; })},
      {"input.initial_state", "", "one per file: virgin or steady",
       [](const Report& report) {
         Value::Array array;
         for (const RecordFit& record : report.fit.records) {
           array.push_back(Text(Name(record.initial_state)));
         }
         return Value{std::move(array)};
       }},
      {"input.response_noise", kOfResponse,
       "one per file: standard deviation of the noise of the fitted channel, given or estimated",
       OneARecord([](const RecordFit& record) { return record.response_noise; })},
      {"input.force_sign", "", "same or opposite: sign of the force relative to the displacement",
       [](const Report& report) { return Text(report.fit.force_sense > 0 ? "same" : "opposite"); }},
      {"input.glitches.spikes", "", "samples left out that are far off their neighbours",
       Sum([](const RecordFit& record) { return record.glitches.spikes; })},
      {"input.glitches.dropouts", "", "samples left out that read 0 in both channels",
       Sum([](const RecordFit& record) { return record.glitches.dropouts; })},
      {"input.glitches.held", "", "samples left out that repeat a value before it jumps",
       Sum([](const RecordFit& record) { return record.glitches.held; })},
      {"reversals.count", "", "turning points of the motion in the widest record",
       [](const Report& report) { return Count(report.fit.WidestRecord().reversals.size()); }},
      {"reversals.gate", kOfExcitation, "excursions up to it are noise",
       OfGate([](const ReversalGate& gate) { return Number(gate.gate); })},
      {"reversals.certain", "", "true if no other gate is as plausible",
       OfGate([](const ReversalGate& gate) { return Flag(gate.certain); })},
      {"reversals.other_count", "", "turning points under the other gate; absent where certain",
       OfGate([](const ReversalGate& gate) {
         return gate.certain ? Value{} : Count(gate.other_count);
       })},
      {"reversals.other_gate", kOfExcitation, "the other gate; absent where certain",
       OfGate([](const ReversalGate& gate) {
         return gate.certain ? Value{} : Number(gate.other_gate);
       })},
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
  AddMemoryFields(table);
  AddResidualFields(table);
  AddSelectionFields(table);
  AddSolverFields(table);
  AddLoopFields(table);
  AddContactFields(table);
  AddMappingFields(table);
  AddLoadSeriesFields(table);
  AddBackboneFields(table);
  // In a fit that failed, every missing value is null for that reason.
  for (Field<Report>& row : table.rows) {
    const bool is_of_contact = row.path.starts_with("contact.") || row.path.starts_with("mapping.");
    row.why_null = [why = std::move(row.why_null), is_of_contact](const Report& report) {
      if (report.failed()) return WhyFailed(report);
      if (is_of_contact && report.is_torsional()) return std::string(kWhyNoContact);
      return why ? why(report) : std::string("not a finite number");
    };
  }
  return table;
}

const FieldTable& AllFields() {
  static const FieldTable table = MakeTable();
  return table;
}

/// Fields of a value and of its members, lists aside.
void Describe(const Report& report, const Value& value, const std::string& path,
              const std::vector<FieldDescription>& descriptions,
              std::vector<DescribedValue>& described) {
  if (const auto* object = std::get_if<Value::Object>(&value.content)) {
    for (const auto& [key, member] : *object) {
      Describe(report, member, path.empty() ? key : fmt::format("{}.{}", path, key), descriptions,
               described);
    }
    return;
  }
  if (std::holds_alternative<Value::Array>(value.content)) return;
  const auto found = std::ranges::find(descriptions, path, &FieldDescription::path);
  if (found == descriptions.end()) return;
  FieldDescription field = *found;
  field.unit = UnitIn(report.units, field.unit);
  described.push_back({.field = std::move(field), .value = value});
}

}  // namespace

std::string WhyFailed(const Report& report) {
  return "the fit failed: " + report.fit.solver.message;
}

std::vector<FieldDescription> DescribeFields() {
  std::vector<FieldDescription> descriptions;
  for (const Field<Report>& row : AllFields().rows) {
    descriptions.push_back({row.path, row.unit, row.label});
  }
  descriptions.insert(descriptions.end(), AllFields().items.begin(), AllFields().items.end());
  descriptions.push_back({"nulls[].path", "", "where the null is"});
  descriptions.push_back({"nulls[].why", "", "why it is one"});
  for (const char* list : {"warnings", "notes"}) {
    descriptions.push_back({std::string(list) + "[].code", "", "stable name, for scripts"});
    descriptions.push_back({std::string(list) + "[].message", "", "sentence, for people"});
  }
  return descriptions;
}

std::vector<DescribedValue> ValuesUnder(const Report& report, std::string_view prefix) {
  const std::vector<FieldDescription> descriptions = DescribeFields();
  std::vector<DescribedValue> described;
  const std::string_view subject = prefix.substr(0, prefix.find('.'));
  for (const Field<Report>& row : AllFields().rows) {
    if (row.path.substr(0, row.path.find('.')) != subject) continue;
    Describe(report, row.get(report), row.path, descriptions, described);
  }
  std::erase_if(described, [prefix](const DescribedValue& item) {
    return !item.field.path.starts_with(prefix);
  });
  return described;
}

Value::Object Document(const Report& report) { return Render(AllFields().rows, report); }

}  // namespace mindahl::report
