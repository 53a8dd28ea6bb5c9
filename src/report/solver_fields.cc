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
       [](const Report& report) { return Integer(report.fit.solver.iterations); }},
      {"solver.solver", "",
       "which search of Ceres solved: tiny_solver, solve (with bounds), or none",
       [](const Report& report) { return Text(report.fit.solver.solver); }},
      {"solver.termination", "", "Ceres' termination type",
       [](const Report& report) { return Text(report.fit.solver.termination); }},
      {"solver.message", "", "why it stopped",
       [](const Report& report) { return Text(report.fit.solver.message); }},
      {"solver.initial_cost", "", "half the sum of the squared weighted residuals at the start",
       [](const Report& report) { return Number(report.fit.solver.initial_cost); },
       [](const Report&) { return std::string("the residuals at the start are not finite"); }},
      {"solver.final_cost", "", "half the sum of the squared weighted residuals at the end",
       [](const Report& report) { return Number(report.fit.solver.final_cost); },
       [](const Report&) { return std::string("the residuals at the end are not finite"); }},
      {"solver.starts", "", "the starting points that were refined",
       [](const Report& report) { return List(StartFields(), report.fit.starts); }},
  });
  table.Describe("solver.starts[].", StartFields());
}

}  // namespace mindahl::report
