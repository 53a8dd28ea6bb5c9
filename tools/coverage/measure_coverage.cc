#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "coverage.h"

namespace {

using mindahl::coverage::Coverage;
using mindahl::coverage::Scenario;

enum ExitStatus { kKept = 0, kNotKept = 1, kBadUsage = 2 };

std::optional<std::size_t> ReadCount(std::string_view text) {
  std::size_t count = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), count);
  const bool is_whole = error == std::errc() && end == text.data() + text.size();
  if (!is_whole || count == 0) return std::nullopt;
  return count;
}

void PrintHead(std::size_t loops) {
  fmt::print(
      "| {} loops each | interval covers the truth | | | stated error / scatter | | | "
      "efficiency | | | bias / scatter | | | doubted | p < 5 % |\n|---|",
      loops);
  for (int i = 0; i < 14; ++i) fmt::print("---|");
  fmt::print("\n| |");
  for (int i = 0; i < 4; ++i) fmt::print(" σ | α | Tc |");
  fmt::print(" | |\n");
}

void PrintRow(const Scenario& scenario, const Coverage& coverage) {
  const auto print = [&](std::string_view name, std::size_t begin, std::size_t end) {
    // A row has three places a column.
    const auto cells = [&](const auto& values, auto format) {
      for (std::size_t k = begin; k < end; ++k) format(values[k]);
      for (std::size_t k = end; k < begin + 3; ++k) fmt::print(" |");
    };
    fmt::print("| {} |", name);
    cells(coverage.covered, [](double share) { fmt::print(" {:.1f} % |", 100 * share); });
    cells(coverage.error_ratio, [](double ratio) { fmt::print(" {:.2f} |", ratio); });
    cells(coverage.efficiency, [](double efficiency) { fmt::print(" {:.2f} |", efficiency); });
    cells(coverage.bias, [](double bias) { fmt::print(" {:+.2f} |", bias); });
    if (begin == 0)
      fmt::print(" {:.1f} % | {:.1f} % |", 100 * coverage.doubted, 100 * coverage.rejected);
    fmt::print("\n");
  };
  print(scenario.name, 0, 3);
  if (coverage.parameters > 3) print(fmt::format("… its {}", scenario.FourthParameter()), 3, 4);
  std::fflush(stdout);
}

}  // namespace

/// Prints the table of docs/coverage.md; exit status 1 when a coverage is outside what is promised,
/// 2 for a number of loops that is none and for a name that no scenario has. Of fewer loops than
/// the promise is for three standard deviations of the counting are allowed.
///   measure_coverage [loops] [part of a scenario's name]
int main(int argc, char** argv) {
  using mindahl::coverage::kLoops;
  const std::optional<std::size_t> loops = argc > 1 ? ReadCount(argv[1]) : kLoops;
  if (!loops || argc > 3) {
    fmt::print(stderr, "usage: measure_coverage [loops > 0] [part of a scenario's name]\n");
    return kBadUsage;
  }
  const std::string wanted = argc > 2 ? argv[2] : "";
  std::vector<Scenario> scenarios = mindahl::coverage::Scenarios();
  std::erase_if(scenarios, [&](const Scenario& scenario) {
    return scenario.name.find(wanted) == std::string::npos;
  });
  if (scenarios.empty()) {
    fmt::print(stderr, "no scenario has '{}' in its name; there are:\n", wanted);
    for (const Scenario& scenario : mindahl::coverage::Scenarios()) {
      fmt::print(stderr, "  {}\n", scenario.name);
    }
    return kBadUsage;
  }

  PrintHead(*loops);
  const double slack =
      *loops >= kLoops ? 0.0 : 3 * std::sqrt(0.95 * 0.05 / static_cast<double>(*loops));
  bool kept = true;
  for (const Scenario& scenario : scenarios) {
    const Coverage coverage = Measure(scenario, *loops);
    PrintRow(scenario, coverage);
    std::vector<double> shares(
        coverage.covered.begin(),
        coverage.covered.begin() + static_cast<std::ptrdiff_t>(coverage.parameters));
    for (const double share : shares) {
      kept = kept && share >= scenario.lowest_coverage - slack &&
             share <= scenario.highest_coverage + slack;
    }
  }
  if (kept) return kKept;
  fmt::print("\nA coverage is outside what is promised.\n");
  return kNotKept;
}
