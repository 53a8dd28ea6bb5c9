#include "study.h"

#include <algorithm>
#include <cstring>
#include <string>

namespace mindahl::reliability {
namespace {

/// A judgement on its way from one process of this program to another.
struct Figures {
  Outcome outcome;
  bool alarms;
  std::size_t intervals;
  std::size_t misses;
  bool false_limit;
};

std::string Packed(const Judgement& judgement) {
  const Figures figures{judgement.outcome, judgement.alarms, judgement.intervals, judgement.misses,
                        judgement.false_limit};
  std::string text(sizeof figures, '\0');
  std::memcpy(text.data(), &figures, sizeof figures);
  return text + judgement.account;
}

Judgement Unpacked(const std::string& text) {
  Figures figures{};
  std::memcpy(&figures, text.data(), sizeof figures);
  return {figures.outcome, figures.alarms,      figures.intervals,
          figures.misses,  figures.false_limit, text.substr(sizeof figures)};
}

double Ratio(std::size_t part, std::size_t whole) {
  return whole == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(whole);
}

}  // namespace

std::vector<Case> CasesOf(const std::vector<Kind>& kinds, std::size_t loops, std::uint64_t first) {
  std::vector<Case> cases;
  for (const Kind& kind : kinds) {
    for (std::size_t level = 0; level < kLevels; ++level) {
      for (std::size_t i = 0; i < loops; ++i) cases.push_back({&kind, level, first + i});
    }
  }
  return cases;
}

std::vector<Result> Run(const std::vector<Case>& cases, bool adds_terms,
                        const ApartOptions& options,
                        const std::function<void(std::size_t)>& progress) {
  std::vector<Result> results(cases.size());
  std::size_t done = 0;
  const auto work = [&](std::size_t i) {
    return Packed(Try(*cases[i].kind, cases[i].level, cases[i].seed, adds_terms));
  };
  RunApart(cases.size(), options, work, [&](std::size_t i, const Ending& ending) {
    results[i].seconds = ending.seconds;
    if (ending.answer) {
      results[i].judgement = Unpacked(*ending.answer);
    } else {
      results[i].judgement = {
          .outcome = Outcome::kFailed, .alarms = true, .account = "   " + ending.fault + '\n'};
    }
    if (progress) progress(++done);
  });
  return results;
}

void Tally::Add(const Case& of, const Result& result) {
  const Judgement& judgement = result.judgement;
  ++fits;
  ++outcomes[static_cast<std::size_t>(judgement.outcome)];
  if (judgement.outcome == Outcome::kSilent) ++silent[of.level];
  if (judgement.alarms) ++alarms;
  intervals += judgement.intervals;
  misses += judgement.misses;
  if (judgement.false_limit) ++false_limits;
  slowest = std::max(slowest, result.seconds);
}

double Tally::Share(Outcome outcome) const { return Ratio(Of(outcome), fits); }
double Tally::AlarmShare() const { return Ratio(alarms, fits); }
double Tally::FalseLimitShare() const { return Ratio(false_limits, fits); }
double Tally::MissShare() const { return Ratio(misses, intervals); }

}  // namespace mindahl::reliability
