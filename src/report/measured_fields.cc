#include "report/field_table.h"
#include "report/names.h"

namespace mindahl::report {

namespace {

std::function<double(const Report&)> Measured(double MeasuredLoop::*member) {
  return
      [member](const Report& report) { return MeasuredLoopOf(report.fit.WidestRecord()).*member; };
}

std::string WhyNoSlip(const Report& report) {
  return report.loop && !report.loop->knows_slip
             ? "sigma, alpha or slip_force is not identifiable"
             : "with alpha >= 1 the force only approaches slip_force";
}

constexpr const char* kWhyNoRegime =
    "slip_force is not identifiable, or its lower limit is within the loop";

}  // namespace

void AddLoopFields(FieldTable& table) {
  table.Add({
      {"loop.amplitude", "m", "X of the widest record", Measured(&MeasuredLoop::amplitude)},
      {"loop.centre", "m", "midway between the extremes of the displacement",
       [](const Report& report) { return report.fit.WidestRecord().measures.centre; }},
      {"loop.peak_force", "N", "T* of the widest record", Measured(&MeasuredLoop::peak_force)},
      {"loop.energy_per_cycle_measured", "J", "W, mean over the widest closed cycles",
       [](const Report& report) { return MeasuredLoopOf(report.fit.WidestRecord()).energy; },
       "the record closes no cycle"},
      {"loop.energy_per_cycle_model", "J",
       "W of the fitted law at the amplitude, without the rig's deflection",
       At(&Report::loop, &LoopDescription::model_energy)},
      {"loop.energy_ratio", "-", "W/(4XT*), the model's W where none was measured",
       At(&Report::loop, &LoopDescription::energy_ratio),
       "needs a force that differs between the extremes of the displacement"},
      {"loop.slip_regime", "", "partial or gross slip", At(&Report::loop, &LoopDescription::regime),
       kWhyNoRegime},
      {"loop.gross_slip_displacement", "m",
       "amplitude above which the whole contact slips: δc of the fitted law, 2^−α·δc of Dahl's own",
       At(&Report::loop, &LoopDescription::gross_slip_displacement), WhyNoSlip},
      {"loop.gross_slip_energy_ratio", "-",
       "W/(4XT*) of the fitted law where gross slip begins, X including the rig's deflection",
       At(&Report::loop, &LoopDescription::gross_slip_energy_ratio), WhyNoSlip},
      {"loop.stick_radius_ratio", "-", "c/a of a Mindlin contact",
       At([](const Report& report) { return If(report.loop && !report.is_torsional(), report); },
          &Report::loop, &LoopDescription::stick_radius_ratio),
       [](const Report& report) {
         return std::string(report.is_torsional() ? kWhyNoContact : kWhyNoRegime);
       }},
  });
}

using loop::CycleFacts;
using loop::LoopFacts;
using loop::Trend;

namespace {

std::string WhyNotMeasured(const LoopFacts& facts, const char* why) {
  return facts.closed ? why : "the record closes no cycle";
}

/// Returns a row whose null has one reason, besides that there is no cycle at all.
template <typename Get>
Field<LoopFacts> Fact(const std::string& path, const char* unit, const char* label, Get get,
                      const char* why = "not a finite number") {
  return {path, unit, label,
          At([](const LoopFacts& facts) { return If(facts.closed, facts); }, get),
          [why](const LoopFacts& facts) { return WhyNotMeasured(facts, why); }};
}

constexpr const char* kNoMiddle = "the strokes have too few samples in their middle";

const std::vector<Field<CycleFacts>>& CycleFields() {
  using Item = CycleFacts;
  static const std::vector<Field<Item>> fields = {
      {"start", "", "number of the cycle's first sample, from 0", &Item::start},
      {"amplitude", "m", "X: a quarter of the travel of its two strokes", &Item::amplitude},
      {"peak_force", "N", "T*: half the range of the force", &Item::peak_force},
      {"half_gap", "N", "half the force between the strokes in their middle", &Item::half_gap,
       kNoMiddle},
      {"energy", "J", "W = ∮ T dδ", &Item::energy},
      {"energy_ratio", "-", "W/(4XT*)", &Item::energy_ratio},
      {"sliding_amplitude", "m", "half the width of the loop midway between its strokes",
       &Item::sliding_amplitude, kNoMiddle},
  };
  return fields;
}

void AddTrend(std::vector<Field<LoopFacts>>& fields, const std::string& of, const char* unit,
              std::optional<Trend> LoopFacts::*trend) {
  const auto row = [&](const char* name, const char* row_unit, const char* label,
                       double Trend::*member) {
    fields.push_back(Fact("trend." + of + "." + name, row_unit, label, At(trend, member),
                          "needs three steady cycles"));
  };
  row("slope", unit, "slope of a straight line over the steady cycles, per cycle", &Trend::slope);
  row("standard_error", unit, "standard error of the slope", &Trend::standard_error);
  row("p_value", "-", "two-sided p-value of a zero slope", &Trend::p_value);
}

const std::vector<Field<LoopFacts>>& MeasuredFields() {
  using Item = LoopFacts;
  static const std::vector<Field<Item>> fields = [] {
    std::vector<Field<Item>> rows = {
        Fact("half_gap.value", "N", "half the force between the strokes in their middle",
             &Item::half_gap, kNoMiddle),
        Fact("half_gap.standard_deviation", "N",
             "standard deviation of half_gap between steady cycles",
             &Item::half_gap_standard_deviation, "needs two steady cycles"),
        Fact("sliding_amplitude", "m", "half the width of the loop midway between its strokes",
             &Item::sliding_amplitude, kNoMiddle),
        Fact("sliding_fraction", "-",
             "fraction of the strokes' travel after the force reached nine tenths of half_gap",
             &Item::sliding_fraction, kNoMiddle),
        Fact("backlash", "m", "travel after each reversal over which the force stays constant",
             At(&Item::backlash, &loop::Backlash::width),
             "the force does not stay constant after the reversals, or not over the same travel"),
        Fact("slope_after_reversal", "N/m", "slope over the first tenth of the strokes, median",
             &Item::slope_after_reversal, "the strokes have too few samples"),
        Fact("plateau_slope", "N/m", "slope over the last third of the strokes, median",
             &Item::plateau_slope, "the strokes have too few samples"),
        Fact("asymmetry", "-",
             "standard deviation between the falling strokes and the rising ones turned over, over "
             "T*",
             &Item::asymmetry, "the strokes have too few samples"),
        Fact("energy_per_cycle", "J", "W, mean over the steady cycles", &Item::energy_per_cycle),
        Fact("energy_ratio", "-", "W/(4XT*) of their means", &Item::energy_ratio),
        Fact("path_ratio", "-", "length of the path through the samples over that of the strokes",
             &Item::path_ratio),
        Fact("energy_friction_coefficient", "-", "W/(4·N·sliding_amplitude), N the mean load",
             &Item::energy_friction_coefficient,
             "needs a column of the normal load, and a sliding amplitude"),
        {"closed", "", "true if the record closes a cycle; otherwise the rest is null",
         &Item::closed},
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
      {"measured", "", "measured without a model, on the widest steady cycles of the widest record",
       [](const Report& report) {
         return Render(MeasuredFields(), report.fit.WidestRecord().facts);
       }},
  });
  table.Describe("measured.", MeasuredFields());
  table.Describe("measured.cycles[].", CycleFields());
}

}  // namespace mindahl::report
