#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <cstdio>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "mindahl/io/csv_table.h"
#include "mindahl/io/output_file.h"
#include "program.h"
#include "small_run.h"
#include "study.h"
#include "table.h"

namespace mindahl::reliability {
namespace {

enum ExitStatus { kKept = 0, kNotKept = 1, kBadUsage = 2 };

struct Options {
  std::size_t loops = 10;
  std::uint64_t seed = 1;
  std::string kind;
  std::string half;
  bool details = false;
  bool small = false;
  bool adds_terms = false;
  ApartOptions apart;
  std::vector<std::string> write;  // kind, level, seed, file
};

int RefuseKind(std::string_view name) {
  fmt::print(stderr, "no kind that was asked for is called '{}'; there are:\n", name);
  for (const Kind& kind : Kinds()) fmt::print(stderr, "  {}\n", kind.name);
  return kBadUsage;
}

std::optional<std::uint64_t> ReadNumber(std::string_view text) {
  std::uint64_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

int Write(const std::vector<std::string>& what) {
  const std::vector<Kind> kinds = Kinds();
  const auto kind = std::ranges::find(kinds, what[0], &Kind::name);
  if (kind == kinds.end()) return RefuseKind(what[0]);
  const std::optional<std::uint64_t> level = ReadNumber(what[1]);
  const std::optional<std::uint64_t> seed = ReadNumber(what[2]);
  if (!level || *level < 1 || *level > kLevels || !seed) {
    fmt::print(stderr, "--write takes a kind, a level of 1 to {}, a seed and a file\n", kLevels);
    return kBadUsage;
  }
  const loop::Record record = MakeLoop(*kind, *level - 1, *seed).record;
  std::vector<io::CsvColumn> columns = {{"time [s]", record.time},
                                        {"displacement [m]", record.displacement},
                                        {"force [N]", record.force}};
  if (!record.normal_load.empty()) columns.push_back({"normal load [N]", record.normal_load});
  io::WriteFileAtomically(what[3], io::CsvText(columns));
  return kKept;
}

/// Those that the options ask for; empty where there is none.
std::vector<Kind> Wanted(const Options& options) {
  std::vector<Kind> kinds = Kinds();
  std::erase_if(kinds, [&](const Kind& kind) {
    return kind.name.find(options.kind) == std::string_view::npos ||
           (!options.half.empty() && Name(kind.half) != options.half) ||
           (options.small && !kind.quick);
  });
  return kinds;
}

void ShowProgress(std::size_t done, std::size_t all) {
  if (isatty(STDERR_FILENO) == 0) return;
  fmt::print(stderr, "\r{} of {} fits{}", done, all, done == all ? "\n" : "");
}

bool IsKept(const HalfTally& half) {
  const Tally& tally = half.tally;
  const Rates& rates = *std::ranges::find(kMeasured, half.half, &Rates::half);
  bool kept = true;
  const auto require = [&](std::string_view what, double share, double rate, std::size_t count) {
    const double limit = LimitOf(rate, count);
    if (share <= limit) return;
    fmt::print("\n{}: {} {:.1f} %, above the limit of {:.1f} % of small_run.h\n", Name(half.half),
               what, 100 * share, 100 * limit);
    kept = false;
  };
  require("silent", tally.Share(Outcome::kSilent), rates.silent, tally.fits);
  require("warned", tally.Share(Outcome::kWarned), rates.warned, tally.fits);
  require("failed", tally.Share(Outcome::kFailed), rates.failed, tally.fits);
  require("false limits", tally.FalseLimitShare(), rates.false_limits, tally.fits);
  require("alarms", tally.AlarmShare(), rates.alarms, tally.fits);
  require("misses of intervals", tally.MissShare(), rates.misses, tally.intervals);
  return kept;
}

int Measure(const Options& options) {
  const std::vector<Kind> kinds = Wanted(options);
  if (kinds.empty()) return RefuseKind(options.kind);
  const std::vector<Case> cases = CasesOf(kinds, options.small ? kSmallLoops : options.loops,
                                          options.small ? kSmallSeed : options.seed);
  const std::vector<Result> results =
      Run(cases, options.adds_terms, options.apart,
          [&](std::size_t done) { ShowProgress(done, cases.size()); });
  PrintTables(stdout, cases, results);
  if (options.details) PrintDetails(stdout, cases, results);
  if (!options.small) return kKept;
  bool kept = true;
  for (const HalfTally& half : TallyHalves(cases, results)) kept = IsKept(half) && kept;
  return kept ? kKept : kNotKept;
}

int Main(int argc, char** argv) {
  Options options;
  CLI::App app(
      "Fits loops that something is wrong with and counts how often the answer is wrong without a "
      "word: docs/reliability.md");
  app.add_option("--loops", options.loops, "loops a kind and level")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--seed", options.seed, "of the first loop; the next one has the next")
      ->capture_default_str();
  auto* kind = app.add_option("--kind", options.kind, "kinds with this in their name");
  auto* half = app.add_option("--half", options.half, "kinds of one half")
                   ->check(CLI::IsMember({"development", "held-out", "clean"}));
  app.add_flag("--add-terms", options.adds_terms,
               "fit with the terms that each record requires, as fit --terms auto");
  app.add_flag("--details", options.details,
               "print every fit that was silent, warned or failed or gave a false limit, and clean "
               "ones that alarmed or missed");
  app.add_option("--jobs", options.apart.at_once, "fits at once")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--time-limit", options.apart.seconds, "seconds that a fit may take")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_flag("--small", options.small,
               "the run that the tests make; exit status 1 where a rate is above its limit, "
               "small_run.h")
      ->excludes(kind, half);
  app.add_option("--write", options.write, "write one loop as CSV and fit nothing")
      ->type_name("KIND LEVEL SEED FILE")
      ->expected(4);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? kKept : kBadUsage;
  }
  return options.write.empty() ? Measure(options) : Write(options.write);
}

}  // namespace
}  // namespace mindahl::reliability

/// Prints the tables of docs/reliability.md. Exit status 1 where the small run is not within its
/// limits, or nothing could be run or written; 2 for options that are none and for a kind that
/// there is not.
int main(int argc, char** argv) {
  return mindahl::reliability::RunProgram("measure_reliability", &mindahl::reliability::Main, argc,
                                          argv);
}
