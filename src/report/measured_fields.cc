#include "report/field_table.h"

namespace mindahl::report {

using loop::CycleFacts;
using loop::LoopFacts;
using loop::Trend;

namespace {

std::string WhyNotMeasured(const LoopFacts& facts, const char* why) {
  return facts.closed ? why : "the record closes no cycle";
}

/// Returns a row whose null has one reason, besides that there is no cycle at all.
Field<LoopFacts> Fact(const char* path, const char* unit, const char* label,
                      Field<LoopFacts>::Get get, const char* why = "not a finite number") {
  return {path, unit, label,
          [get = std::move(get)](const LoopFacts& facts) {
            return facts.closed ? get(facts) : Missing();
          },
          [why](const LoopFacts& facts) { return WhyNotMeasured(facts, why); }};
}

constexpr const char* kNoMiddle = "the strokes have too few samples in their middle";

const std::vector<Field<CycleFacts>>& CycleFields() {
  using Item = CycleFacts;
  static const std::vector<Field<Item>> fields = {
      {"start", "", "number of the sample at which it starts, from 0",
       [](const Item& item) { return Count(item.start); }},
      {"amplitude", "m", "X: a quarter of the travel of its two strokes",
       [](const Item& item) { return Number(item.amplitude); }},
      {"peak_force", "N", "T*: half the range of the force",
       [](const Item& item) { return Number(item.peak_force); }},
      {"half_gap", "N", "half the force between the strokes in their middle",
       [](const Item& item) { return Number(item.half_gap); },
       [](const Item&) { return std::string(kNoMiddle); }},
      {"energy", "J", "W = ∮ T dδ", [](const Item& item) { return Number(item.energy); }},
      {"energy_ratio", "-", "W/(4XT*)", [](const Item& item) { return Number(item.energy_ratio); }},
      {"sliding_amplitude", "m", "half the width of the loop midway between its strokes",
       [](const Item& item) { return Number(item.sliding_amplitude); },
       [](const Item&) { return std::string(kNoMiddle); }},
  };
  return fields;
}

void AddTrend(std::vector<Field<LoopFacts>>& fields, const std::string& of, const char* unit,
              std::optional<Trend> LoopFacts::*trend) {
  const auto row = [&](const char* name, const char* row_unit, const char* label,
                       double Trend::*member) {
    const auto get = [trend, member](const LoopFacts& facts) {
      return facts.*trend ? Number((*(facts.*trend)).*member) : Missing();
    };
    fields.push_back(Fact(("trend." + of + "." + name).c_str(), row_unit, label, get,
                          "needs three steady cycles"));
  };
  row("slope", unit, "of a straight line over the steady cycles, a cycle", &Trend::slope);
  row("standard_error", unit, "of the slope", &Trend::standard_error);
  row("p_value", "-", "of no slope, two-sided", &Trend::p_value);
}

const std::vector<Field<LoopFacts>>& MeasuredFields() {
  using Item = LoopFacts;
  static const std::vector<Field<Item>> fields = [] {
    std::vector<Field<Item>> rows = {
        Fact(
            "half_gap.value", "N", "half the force between the strokes in their middle",
            [](const Item& item) { return Number(item.half_gap); }, kNoMiddle),
        Fact(
            "half_gap.standard_deviation", "N", "of half_gap, between steady cycles",
            [](const Item& item) { return Number(item.half_gap_standard_deviation); },
            "needs two steady cycles"),
        Fact(
            "sliding_amplitude", "m", "half the width of the loop midway between its strokes",
            [](const Item& item) { return Number(item.sliding_amplitude); }, kNoMiddle),
        Fact(
            "sliding_fraction", "-",
            "of the strokes' travel, after the force came to nine tenths of half_gap",
            [](const Item& item) { return Number(item.sliding_fraction); }, kNoMiddle),
        Fact(
            "backlash", "m", "travel after each reversal over which the force stands still",
            [](const Item& item) {
              return item.backlash ? Number(item.backlash->width) : Missing();
            },
            "the force does not stand still after the reversals, or not over the same travel"),
        Fact(
            "slope_after_reversal", "N/m", "over the first tenth of the strokes, their median",
            [](const Item& item) { return Number(item.slope_after_reversal); },
            "the strokes have too few samples"),
        Fact(
            "plateau_slope", "N/m", "over the last third of the strokes, their median",
            [](const Item& item) { return Number(item.plateau_slope); },
            "the strokes have too few samples"),
        Fact(
            "asymmetry", "-",
            "standard deviation of the falling strokes from the turned rising ones, over T*",
            [](const Item& item) { return Number(item.asymmetry); },
            "the strokes have too few samples"),
        Fact("energy_per_cycle", "J", "W, mean over the steady cycles",
             [](const Item& item) { return Number(item.energy_per_cycle); }),
        Fact("energy_ratio", "-", "W/(4XT*) of their means",
             [](const Item& item) { return Number(item.energy_ratio); }),
        Fact("path_ratio", "-", "way between the samples over that of the strokes",
             [](const Item& item) { return Number(item.path_ratio); }),
        Fact(
            "energy_friction_coefficient", "-", "W/(4·N·sliding_amplitude), N the mean load",
            [](const Item& item) { return Number(item.energy_friction_coefficient); },
            "needs a column of the normal load, and a sliding amplitude"),
        {"closed", "", "whether the record closes a cycle; without one the rest is null",
         [](const Item& item) { return Flag(item.closed); }},
        {"cycles", "", "every closed cycle",
         [](const Item& item) { return List(CycleFields(), item.cycles); }},
    };
    AddTrend(rows, "half_gap", "N", &LoopFacts::half_gap_trend);
    AddTrend(rows, "energy", "J", &LoopFacts::energy_trend);
    return rows;
  }();
  return fields;
}

}  // namespace

void AddMeasuredFields(FieldTable& table) {
  table.Add({
      {"measured", "", "what the widest record says without a model, of its widest steady cycles",
       [](const Report& report) {
         return Value{Render(MeasuredFields(), report.fit.WidestRecord().facts)};
       }},
  });
  table.Describe("measured.", MeasuredFields());
  table.Describe("measured.cycles[].", CycleFields());
}

}  // namespace mindahl::report
