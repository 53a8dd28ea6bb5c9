// Makes figures 3-8 of Peyret et al. (2017) with the corrected equations and checks the numbers of
// docs/paper.md. Prints them as markdown; exits with 1 when a check fails.
//   reproduce_paper DIR

#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <filesystem>
#include <iostream>
#include <string>
#include <string_view>
#include <vector>

#include "checks.h"
#include "figures.h"

namespace {

using mindahl::paper::Check;
using mindahl::paper::ErrorsByCycle;

void PrintErrors(std::string_view of, std::string_view against,
                 const std::vector<ErrorsByCycle>& rows) {
  fmt::print("| {:24} | {:12} |  cycle 1 |        2 |        3 |        4 |        5 |\n", of,
             against);
  fmt::print("|---|---|---|---|---|---|---|\n");
  for (const ErrorsByCycle& row : rows) {
    fmt::print("| {:24} | {:12} |", row.model, row.excitation);
    for (const double worst : row.worst) fmt::print(" {:8.3g} |", worst);
    fmt::print("\n");
  }
  fmt::print("\n");
}

bool PrintChecks(const std::vector<Check>& checks) {
  fmt::print("| {:70} | {:>12} | {:>10} |      |\n|---|---|---|---|\n", "check", "expected",
             "found");
  for (const Check& check : checks) {
    fmt::print("| {:70} | {:>12} | {:>10.5g} | {} |\n", check.quantity, check.expected, check.found,
               check.Passes() ? "pass" : "FAIL");
  }
  const auto passed = std::ranges::count_if(checks, &Check::Passes);
  fmt::print("\n{} of {} checks pass.\n", passed, checks.size());
  return static_cast<std::size_t>(passed) == checks.size();
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: reproduce_paper DIR\n";
    return 2;
  }
  try {
    const std::filesystem::path directory = argv[1];
    std::filesystem::create_directories(directory);
    const auto sine_errors = mindahl::paper::SineErrors();
    const auto growing_errors = mindahl::paper::GrowingSineErrors();
    fmt::print("Largest |error| in each cycle against Mindlin, in % of T*:\n\n");
    PrintErrors("model", "excitation", sine_errors);
    fmt::print("The same under the growing sine, with T* of the envelope:\n\n");
    PrintErrors("model with the envelope", "against", growing_errors);
    const bool passed = PrintChecks(MakeChecks(sine_errors, growing_errors));
    mindahl::paper::WriteFigures(directory);
    return passed ? 0 : 1;
  } catch (const std::exception& error) {
    std::cerr << "reproduce_paper: " << error.what() << '\n';
    return 2;
  }
}
