#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>

#include "minima.h"
#include "program.h"

namespace mindahl::reliability {
namespace {

void Print(const MinimaTally& tally) {
  fmt::print("| {} | {} | {} | {} | {} | {} | {} | {:.2g} |\n", tally.kind, tally.problems,
             tally.not_converged, tally.worse, tally.told, tally.told_and_identifiable,
             tally.judge_worse, tally.largest);
  std::fflush(stdout);
}

int Main(int argc, char** argv) {
  std::size_t problems = 40;
  std::uint64_t seed = 1;
  CLI::App app(
      "Fits hard problems and compares the cost with the least that ceres::Solve finds from the "
      "truth and from random starts: docs/reliability.md");
  app.add_option("--problems", problems, "problems a kind")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--seed", seed, "of the first problem; the next one has the next")
      ->capture_default_str();
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  fmt::print(
      "| kind | problems | not converged | worse by 1e-6 of the cost | and 2 ln Λ > 1 | and called "
      "identifiable | judge worse | largest 2 ln Λ |\n|---|---|---|---|---|---|---|---|\n");
  MinimaTally all{.kind = "all"};
  for (const std::string_view kind : KindsOfMinima()) {
    const MinimaTally tally = MeasureMinima(kind, problems, seed);
    Print(tally);
    all.problems += tally.problems;
    all.not_converged += tally.not_converged;
    all.worse += tally.worse;
    all.told += tally.told;
    all.told_and_identifiable += tally.told_and_identifiable;
    all.judge_worse += tally.judge_worse;
    all.largest = std::max(all.largest, tally.largest);
  }
  Print(all);
  return 100 * all.worse > all.problems || all.told_and_identifiable > 0 ? 3 : 0;
}

}  // namespace
}  // namespace mindahl::reliability

/// Prints a table of docs/reliability.md. Exit status 3 where more than one fit in a hundred is
/// worse, or one that is called identifiable by more than noise hides; 1 for an internal error, 2
/// for options that are none.
int main(int argc, char** argv) {
  return mindahl::reliability::RunProgram("measure_minima", &mindahl::reliability::Main, argc,
                                          argv);
}
