#include <fmt/format.h>

#include "report/field_table.h"

namespace mindahl::report {

using identification::StartReport;
using models::BranchLaw;

namespace {

std::vector<Field<StartReport>> StartLawFields(const std::string& prefix, const char* where,
                                               BranchLaw StartReport::*law) {
  const auto why = [](const StartReport&) {
    return std::string("the solver came to nothing finite from here");
  };
  const auto row = [&](const char* name, const char* unit, double BranchLaw::*member) {
    return Field<StartReport>{
        prefix + "." + name, unit, fmt::format("{} of the law {}", name, where),
        [law, member](const StartReport& item) { return Number(item.*law.*member); }, why};
  };
  return {row("sigma", "N/m", &BranchLaw::tangential_stiffness),
          row("alpha", "-", &BranchLaw::shape_exponent),
          row("slip_force", "N", &BranchLaw::slip_force)};
}

const std::vector<Field<StartReport>>& StartFields() {
  using Item = StartReport;
  static const std::vector<Field<Item>> fields = [] {
    const auto why = [](const Item&) { return std::string("the cost is not finite here"); };
    std::vector<Field<Item>> rows = {
        {"from", "", "grid, or seed where it was drawn",
         [](const Item& item) { return Text(item.drawn ? "seed" : "grid"); }}};
    const auto append = [&](const std::vector<Field<Item>>& more) {
      rows.insert(rows.end(), more.begin(), more.end());
    };
    append(StartLawFields("start", "at the start", &Item::start));
    append({{"initial_rms", "N", "root mean square residual at the start",
             [](const Item& item) { return Number(item.initial_rms); }, why}});
    append(StartLawFields("reached", "where it ended", &Item::reached));
    append({{"final_rms", "N", "root mean square residual where it ended",
             [](const Item& item) { return Number(item.final_rms); }, why},
            {"converged", "", "whether the solver converged from here",
             [](const Item& item) { return Flag(item.converged); }}});
    return rows;
  }();
  return fields;
}

}  // namespace

void AddSolverFields(FieldTable& table) {
  table.Add({
      {"solver.converged", "", "whether it converged",
       [](const Report& report) { return Flag(report.fit.converged); }},
      {"solver.iterations", "", "number of iterations",
       [](const Report& report) { return Integer(report.fit.iterations); }},
      {"solver.termination", "", "why it stopped",
       [](const Report& report) { return Text(report.fit.termination); }},
      {"solver.starts", "", "the starting points that were refined",
       [](const Report& report) { return List(StartFields(), report.fit.starts); }},
  });
  table.Describe("solver.starts[].", StartFields());
}

}  // namespace mindahl::report
