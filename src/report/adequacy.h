#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "mindahl/identification/fit.h"
#include "mindahl/report/report.h"

namespace mindahl::report {

inline constexpr const char* kWhyNotJudged =
    "the record has too few samples to identify anything in addition to the model";

/// True if the adequacy was judged: the fit did not fail, and omitted terms were tried.
bool IsJudged(const Report& report);

/// Returns why no option takes a cause into account.
std::string WhyNoOption(const identification::Cause& cause);

/// Puts the causes into the units of the record.
void AdaptCauses(const Units& units, std::vector<identification::Cause>& causes);

/// Returns a cause in words, without an end of line: what it looks like with its size, how much it
/// explains, and the option that takes it into account or, where there is none, what to look at.
/// @param response  the channel that is fitted
/// @throws std::logic_error for a code without a row
std::string Sentence(const identification::Cause& cause,
                     loop::Channel response = loop::Channel::kForce);

/// Returns every code that has a sentence.
std::vector<std::string_view> CauseCodes();

/// False of an inadequate fit: nothing of its parameters is shown.
bool IsUsable(const Report& report);

/// Says how far the model is from the record: the rms in its unit and of the measured half gap, and
/// how much of it comes back in every stroke.
std::string MisfitSentence(const Report& report);

/// Returns the verdict in words, with the misfit.
std::string VerdictSentence(const Report& report);

/// Names the first cause and the remedy; empty of an adequate fit, or where there is none.
std::string NextStep(const Report& report);

}  // namespace mindahl::report
