#include "mindahl/identification/memory.h"
#include "report/field_table.h"
#include "report/names.h"

namespace mindahl::report {

using identification::MemoryComparison;
using identification::MemoryTest;

namespace {

const std::vector<Field<MemoryComparison>>& ComparisonFields() {
  using Item = MemoryComparison;
  static const std::vector<Field<Item>> fields = {
      {"code", "", "stable, for scripts", [](const Item& item) { return Text(item.code); }},
      {"p_value", "-", "that noise alone makes it of a contact of Masing's memory",
       [](const Item& item) { return Number(item.p_value); }},
      {"dahl_p_value", "-", "likewise of Dahl's",
       [](const Item& item) { return Number(item.dahl_p_value); }},
      {"size", "N", "rms of what is beyond Masing's memory and beyond noise",
       [](const Item& item) { return Number(item.size); }},
  };
  return fields;
}

std::string WhyNoMemory(const Report& report) {
  if (report.fit.depth < identification::Depth::kThorough) return "the fit was not asked for it";
  return "branches are not compared before the motion turns, where sigma or slip_force is held or "
         "bounded, under loads that vary or differ, with a lag or an asymmetry, and in a fit of "
         "the "
         "displacement";
}

template <typename Get>
Field<Report> MemoryRow(const char* path, const char* unit, const char* label, Get get) {
  return {path, unit, label,
          [get](const Report& report) {
            return report.fit.memory ? get(*report.fit.memory) : Missing();
          },
          WhyNoMemory};
}

}  // namespace

void AddMemoryFields(FieldTable& table) {
  table.Add({
      MemoryRow("memory.verdict", "", "masing, dahl, neither or undecided",
                [](const MemoryTest& memory) { return Text(Name(memory.verdict)); }),
      MemoryRow("memory.p_value", "-", "of Masing's memory, by all comparisons",
                [](const MemoryTest& memory) { return Number(memory.p_value); }),
      MemoryRow("memory.dahl_p_value", "-", "of Dahl's",
                [](const MemoryTest& memory) { return Number(memory.dahl_p_value); }),
      {"memory.tests", "", "comparisons that the record has; may be empty",
       [](const Report& report) {
         return report.fit.memory ? List(ComparisonFields(), report.fit.memory->comparisons)
                                  : Value{Value::Array{}};
       }},
  });
  table.Describe("memory.tests[].", ComparisonFields());
}

}  // namespace mindahl::report
