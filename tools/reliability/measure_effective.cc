#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <string>

#include "other_laws.h"
#include "program.h"

namespace mindahl::reliability {
namespace {

std::string Cells(const Effective& tally) {
  if (tally.loops == 0) return "– | – | – | –";
  const auto share = [](std::size_t part, std::size_t all) {
    return all == 0 ? std::string("–")
                    : fmt::format("{:.1f} %",
                                  100.0 * static_cast<double>(part) / static_cast<double>(all));
  };
  return fmt::format("{} | {} | {} | {:.1f}", share(tally.given, tally.loops),
                     share(tally.held, tally.given), share(tally.narrow, tally.given),
                     tally.inflation);
}

void Print(std::size_t loops, std::uint64_t seed) {
  fmt::print(
      "| law of the contact | half | adequate | Tc given | contains the plateau | narrow and wrong "
      "| inflation | sigma given | contains the secant | narrow and wrong | inflation |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|\n");
  for (const OtherLaw& law : OtherLaws()) {
    const EffectiveTally tally = Measure(law, loops, seed);
    fmt::print("| {}: {} | {} | {} | {} | {} |\n", law.name, law.sentence, Name(law.half),
               tally.adequate, Cells(tally.slip_force), Cells(tally.stiffness));
    std::fflush(stdout);
  }
}

int Main(int argc, char** argv) {
  std::size_t loops = 200;
  std::uint64_t seed = 1;
  CLI::App app(
      "Fits loops of other laws than the fitted one and counts how often the intervals of Tc and "
      "sigma contain what is true: docs/reliability.md");
  app.add_option("--loops", loops, "loops a law")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--seed", seed, "of the first loop; the next one has the next")
      ->capture_default_str();
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  Print(loops, seed);
  return 0;
}

}  // namespace
}  // namespace mindahl::reliability

/// Prints a table of docs/reliability.md. Exit status 1 for an internal error, 2 for options that
/// are none.
int main(int argc, char** argv) {
  return mindahl::reliability::RunProgram("measure_effective", &mindahl::reliability::Main, argc,
                                          argv);
}
