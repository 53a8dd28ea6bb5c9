#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <string>

#include "coverage.h"

/// Prints the table of docs/coverage.md; exit status 1 when a coverage is outside what is promised.
/// Of fewer than a thousand loops three standard deviations of the counting are allowed for.
///   measure_coverage [loops] [part of a scenario's name]
int main(int argc, char** argv) {
  using namespace mindahl::coverage;
  const std::size_t loops = argc > 1 ? std::strtoul(argv[1], nullptr, 10) : 1000;
  const std::string wanted = argc > 2 ? argv[2] : "";
  fmt::print(
      "| {} loops each | interval holds the truth | | | stated error / scatter | | | "
      "efficiency | | | bias / scatter | | |\n|---|",
      loops);
  for (int i = 0; i < 12; ++i) fmt::print("---|");
  fmt::print("\n| |");
  for (int i = 0; i < 4; ++i) fmt::print(" σ | α | Tc |");
  fmt::print("\n");
  constexpr std::size_t kEnough = 1000;
  const double slack =
      loops >= kEnough ? 0.0 : 3 * std::sqrt(0.95 * 0.05 / static_cast<double>(loops));
  bool kept = true;
  for (const Scenario& scenario : Scenarios()) {
    if (scenario.name.find(wanted) == std::string::npos) continue;
    const Coverage coverage = Measure(scenario, loops);
    fmt::print("| {} |", scenario.name);
    for (const double share : coverage.covered) {
      fmt::print(" {:.1f} % |", 100 * share);
      kept = kept && share >= scenario.lowest_coverage - slack &&
             share <= scenario.highest_coverage + slack;
    }
    for (const double ratio : coverage.error_ratio) fmt::print(" {:.2f} |", ratio);
    for (const double efficiency : coverage.efficiency) fmt::print(" {:.2f} |", efficiency);
    for (const double bias : coverage.bias) fmt::print(" {:+.2f} |", bias);
    fmt::print("\n");
    std::fflush(stdout);
  }
  if (!kept) fmt::print("\nA coverage is outside what is promised.\n");
  return kept ? 0 : 1;
}
