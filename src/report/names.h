#pragma once

#include <string>
#include <string_view>

#include "mindahl/identification/fit.h"
#include "mindahl/report/loop_description.h"

namespace mindahl::report {

// How the reports call what the library has as enumerations.
std::string_view Name(identification::ParameterStatus status);
std::string_view Name(identification::Identifiability identifiability);
/// Returns the name with blanks, for people.
std::string Words(identification::Identifiability identifiability);
std::string_view Name(identification::IntervalSource source);
std::string_view Name(models::InitialState state);
std::string_view Name(loop::Channel channel);
std::string_view Name(SlipRegime regime);
std::string_view Name(identification::AdequacyVerdict verdict);
std::string_view Name(identification::Use use);
std::string_view Name(identification::MemoryVerdict verdict);

/// Returns the name of a parameter or of a key of the JSON for people: "slip force Tc", "half gap".
std::string PlainName(std::string_view key);

/// Returns the confidence of a fit's intervals for people: "95 %".
std::string ConfidenceWords(const identification::FitResult& fit);

}  // namespace mindahl::report
