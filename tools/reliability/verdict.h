#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>

#include "kind.h"
#include "mindahl/identification/fit.h"

/// What a fit said, held against what is true.
namespace mindahl::reliability {

/// Of a fit; of several that hold for its parameters the worst, which is the last.
enum class Outcome {
  kRight,      ///< every parameter that is asked is identifiable and not far off
  kUndecided,  ///< one is not identifiable, or there is no answer; none is wrong
  kWarned,     ///< one is called identifiable and is far off, but something is warned of
  kSilent,     ///< the same without a word
  kFailed,     ///< ran out of time, or ended the program
};
inline constexpr std::size_t kOutcomes = 5;

/// "right", "undecided", "warned", "silent", "failed"
std::string_view Name(Outcome outcome);

/// A parameter is far off when the truth is this many half widths of the 95 % interval from its
/// middle …
inline constexpr double kHalfWidths = 2.0;
/// … and the estimate off by more than this share of the truth; of alpha, by as much.
inline constexpr double kShare = 0.02;

/// What a fit lets its reader know beside the numbers.
struct Caution {
  bool no_answer = false;  ///< it failed or did not converge
  bool warns = false;      ///< of anything
  bool alarms = false;     ///< of more than what the record leaves open
};

/// The one place that knows how a fit speaks: by its convergence and the severity of its findings.
/// A verdict on the adequacy of its model belongs here too: inadequate is no answer, doubtful warns
/// and alarms.
Caution CautionOf(const identification::FitResult& fit);

struct Judgement {
  Outcome outcome = Outcome::kFailed;
  bool alarms = false;        ///< Caution::alarms
  std::size_t intervals = 0;  ///< of parameters that are asked and identifiable
  std::size_t misses = 0;     ///< of these, those that do not cover the truth
  bool false_limit = false;   ///< a lower limit lies above the truth by more than kShare
  std::string account;        ///< truth, estimate, interval and findings, some lines
};

Judgement Judge(const identification::FitResult& fit, const Expected& expected);

/// Makes a loop, fits it in full and judges the fit. One that is refused has no answer.
/// @param adds_terms  fits as with `--terms auto`, else as with `--terms none`
Judgement Try(const Kind& kind, std::size_t level, std::uint64_t seed, bool adds_terms);

}  // namespace mindahl::reliability
