#include "table.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

namespace mindahl::reliability {
namespace {

constexpr std::string_view kOutcomeHead = "right | undecided | warned | silent | failed |";

void PrintOutcomes(std::FILE* file, const Tally& tally) {
  for (const std::size_t count : tally.outcomes) fmt::print(file, " {} |", count);
}

void PrintHalf(std::FILE* file, Half half, const std::vector<Case>& cases,
               const std::vector<Result>& results) {
  const bool clean = half == Half::kClean;
  fmt::print(file, "\n| {} | {} {} slowest [s] | how |\n|---|---|---|---|---|---|---|---|---|\n",
             Name(half), kOutcomeHead,
             clean ? "alarms · misses of intervals |" : "silent by level |");
  for (std::size_t i = 0; i < cases.size();) {
    const Kind& kind = *cases[i].kind;
    Tally tally;
    for (; i < cases.size() && cases[i].kind == &kind; ++i) tally.Add(cases[i], results[i]);
    if (kind.half != half) continue;
    fmt::print(file, "| {} |", kind.name);
    PrintOutcomes(file, tally);
    if (clean) {
      fmt::print(file, " {} · {} of {} |", tally.alarms, tally.misses, tally.intervals);
    } else {
      fmt::print(file, " {} · {} · {} |", tally.silent[0], tally.silent[1], tally.silent[2]);
    }
    fmt::print(file, " {:.2g} | {} |\n", tally.slowest, kind.sentence);
  }
}

bool IsOfInterest(const Case& of, const Judgement& judgement) {
  if (judgement.outcome >= Outcome::kWarned || judgement.false_limit) return true;
  return of.kind->half == Half::kClean && (judgement.alarms || judgement.misses > 0);
}

}  // namespace

std::vector<HalfTally> TallyHalves(const std::vector<Case>& cases,
                                   const std::vector<Result>& results) {
  std::vector<HalfTally> halves;
  for (const Half half : {Half::kDevelopment, Half::kHeldOut, Half::kClean}) {
    Tally tally;
    for (std::size_t i = 0; i < cases.size(); ++i) {
      if (cases[i].kind->half == half) tally.Add(cases[i], results[i]);
    }
    if (tally.fits > 0) halves.push_back({half, tally});
  }
  return halves;
}

void PrintTables(std::FILE* file, const std::vector<Case>& cases,
                 const std::vector<Result>& results) {
  const std::vector<HalfTally> halves = TallyHalves(cases, results);
  fmt::print(file,
             "| | fits | {} alarms | misses of intervals | false limits | slowest [s] |\n"
             "|---|---|---|---|---|---|---|---|---|---|---|\n",
             kOutcomeHead);
  for (const auto& [half, tally] : halves) {
    fmt::print(file, "| {} | {} |", Name(half), tally.fits);
    for (std::size_t k = 0; k < kOutcomes; ++k) {
      fmt::print(file, " {:.1f} % |", 100 * tally.Share(static_cast<Outcome>(k)));
    }
    fmt::print(file, " {:.1f} % | {:.1f} % | {:.1f} % | {:.2g} |\n", 100 * tally.AlarmShare(),
               100 * tally.MissShare(), 100 * tally.FalseLimitShare(), tally.slowest);
  }
  for (const HalfTally& half : halves) PrintHalf(file, half.half, cases, results);
}

void PrintDetails(std::FILE* file, const std::vector<Case>& cases,
                  const std::vector<Result>& results) {
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const auto& [kind, level, seed] = cases[i];
    const Judgement& judgement = results[i].judgement;
    if (!IsOfInterest(cases[i], judgement)) continue;
    fmt::print(file, "\n{}: --write '{}' {} {}  ({}; {:.2f} s)\n{}", Name(judgement.outcome),
               kind->name, level + 1, seed, Name(kind->half), results[i].seconds,
               judgement.account);
  }
}

}  // namespace mindahl::reliability
