#include <string>

#include "report/field_table.h"

namespace mindahl::report {

namespace {

std::string WhySlipForceOpen(const Report& report) {
  return report.slip_forces ? "slip_force and asymmetry are held, or the record leaves it open"
                            : "slip_force or asymmetry is not identifiable";
}

/// Makes a row, absent of a fit that has one slip force.
template <typename Get>
Field<Report> SlipForceRow(const std::string& path, const char* label, Get get) {
  return {path, "N", label,
          [get](const Report& report) {
            if (report.fit.Find("asymmetry") == nullptr) return Value{};
            return report.slip_forces ? get(*report.slip_forces) : Missing();
          },
          WhySlipForceOpen};
}

std::vector<Field<Report>> RowsOf(const std::string& sense, const char* label,
                                  SlipForce SlipForces::*member) {
  const std::string path = "slip_forces." + sense;
  return {
      SlipForceRow(path + ".value", label,
                   [member](const SlipForces& forces) { return Number((forces.*member).value); }),
      SlipForceRow(
          path + ".standard_error", "standard error",
          [member](const SlipForces& forces) { return Number((forces.*member).standard_error); }),
      SlipForceRow(path + ".ci95[0]", "lower end of the interval",
                   [member](const SlipForces& forces) { return Number((forces.*member).lower95); }),
      SlipForceRow(
          path + ".ci95[1]", "upper end of the interval",
          [member](const SlipForces& forces) { return Number((forces.*member).upper95); })};
}

}  // namespace

void AddSlipForceFields(FieldTable& table) {
  table.Add(
      RowsOf("positive",
             "Tc(1 + A), where the motion is in the direction of positive displacement; absent, "
             "as is slip_forces.negative, unless the fit has an asymmetry",
             &SlipForces::positive));
  table.Add(RowsOf("negative", "Tc(1 − A), where it is not", &SlipForces::negative));
}

}  // namespace mindahl::report
