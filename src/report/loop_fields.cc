#include "report/field_table.h"
#include "report/names.h"

namespace mindahl::report {

namespace {

std::function<Value(const Report&)> Measured(double MeasuredLoop::*member) {
  return [member](const Report& report) {
    return Number(MeasuredLoopOf(report.fit.WidestRecord()).*member);
  };
}

std::string WhyNoSlip(const Report& report) {
  return report.loop && !report.loop->knows_slip
             ? "sigma, alpha or slip_force is not identifiable"
             : "with alpha >= 1 the force only approaches slip_force";
}

constexpr const char* kWhyNoRegime =
    "slip_force is not identifiable, or has a lower limit that the loop reaches";

/// Makes a getter of the loop's description, null where there is none.
template <typename Get>
std::function<Value(const Report&)> OfLoop(Get get) {
  return [get](const Report& report) { return report.loop ? get(*report.loop) : Missing(); };
}

}  // namespace

void AddLoopFields(FieldTable& table) {
  table.Add({
      {"loop.amplitude", "m", "X of the widest record", Measured(&MeasuredLoop::amplitude)},
      {"loop.centre", "m", "midway between the extremes of the displacement",
       [](const Report& report) { return Number(report.fit.WidestRecord().measures.centre); }},
      {"loop.peak_force", "N", "T* of the widest record", Measured(&MeasuredLoop::peak_force)},
      {"loop.energy_per_cycle_measured", "J", "W, mean over the widest closed cycles",
       [](const Report& report) {
         return Number(MeasuredLoopOf(report.fit.WidestRecord()).energy);
       },
       [](const Report&) { return std::string("the record closes no cycle"); }},
      {"loop.energy_per_cycle_model", "J",
       "W of the fitted law at the amplitude, the rig's travel taken off",
       OfLoop([](const LoopDescription& loop) { return Number(loop.model_energy); })},
      {"loop.energy_ratio", "-", "W/(4XT*), the model's W where none was measured",
       OfLoop([](const LoopDescription& loop) { return Number(loop.energy_ratio); }),
       [](const Report&) {
         return std::string("needs a force that differs between the extremes of the displacement");
       }},
      {"loop.slip_regime", "", "partial or gross slip", OfLoop([](const LoopDescription& loop) {
         return loop.regime ? Text(Name(*loop.regime)) : Missing();
       }),
       [](const Report&) { return std::string(kWhyNoRegime); }},
      {"loop.gross_slip_displacement", "m",
       "amplitude of the contact from which it slips: δc of the fitted law, 2^−α·δc of Dahl's own",
       OfLoop([](const LoopDescription& loop) { return Number(loop.gross_slip_displacement); }),
       WhyNoSlip},
      {"loop.gross_slip_energy_ratio", "-",
       "W/(4XT*) of the fitted law where it begins to slip, the rig's travel in X",
       OfLoop([](const LoopDescription& loop) { return Number(loop.gross_slip_energy_ratio); }),
       WhyNoSlip},
      {"loop.stick_radius_ratio", "-", "c/a of a Mindlin contact",
       [](const Report& report) {
         return report.loop && !report.is_torsional() ? Number(report.loop->stick_radius_ratio)
                                                      : Missing();
       },
       [](const Report& report) {
         return std::string(report.is_torsional() ? kWhyNoContact : kWhyNoRegime);
       }},
  });
}

}  // namespace mindahl::report
