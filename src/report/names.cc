#include "report/names.h"

#include <fmt/format.h>

#include <algorithm>

namespace mindahl::report {

using identification::Identifiability;
using identification::ParameterStatus;

std::string_view Name(ParameterStatus status) {
  switch (status) {
    case ParameterStatus::kFree:
      return "free";
    case ParameterStatus::kFixed:
      return "fixed";
    case ParameterStatus::kAtLowerBound:
      return "at_lower_bound";
    case ParameterStatus::kAtUpperBound:
      return "at_upper_bound";
  }
  return "";
}

std::string_view Name(Identifiability identifiability) {
  switch (identifiability) {
    case Identifiability::kIdentifiable:
      return "identifiable";
    case Identifiability::kEffective:
      return "effective";
    case Identifiability::kExtrapolated:
      return "extrapolated";
    case Identifiability::kBoundedBelow:
      return "bounded_below";
    case Identifiability::kNotIdentifiable:
      return "not_identifiable";
  }
  return "";
}

std::string Words(Identifiability identifiability) {
  std::string words(Name(identifiability));
  std::ranges::replace(words, '_', ' ');
  return words;
}

std::string_view Name(identification::IntervalSource source) {
  using enum identification::IntervalSource;
  switch (source) {
    case kParabola:
      return "parabola";
    case kProfile:
      return "profile";
    case kInitialState:
      return "initial_state";
    case kOtherMinimum:
      return "other_minimum";
    case kOmittedTerms:
      return "omitted_terms";
    case kPlateau:
      return "plateau";
    case kSmallShape:
      return "small_alpha";
    case kDiscrepancy:
      return "discrepancy";
    case kCarriedForce:
      return "carried_force";
  }
  return "";
}

std::string_view Name(models::InitialState state) {
  return state == models::InitialState::kVirgin ? "virgin" : "steady";
}

std::string_view Name(loop::Channel channel) {
  return channel == loop::Channel::kForce ? "force" : "displacement";
}

std::string_view Name(SlipRegime regime) {
  return regime == SlipRegime::kGross ? "gross" : "partial";
}

std::string_view Name(identification::AdequacyVerdict verdict) {
  switch (verdict) {
    case identification::AdequacyVerdict::kAdequate:
      return "adequate";
    case identification::AdequacyVerdict::kDoubtful:
      return "doubtful";
    case identification::AdequacyVerdict::kInadequate:
      return "inadequate";
  }
  return "";
}

std::string_view Name(identification::Use use) {
  switch (use) {
    case identification::Use::kQuantitative:
      return "quantitative";
    case identification::Use::kIndicative:
      return "indicative";
    case identification::Use::kNone:
      return "none";
  }
  return "";
}

std::string_view Name(identification::MemoryVerdict verdict) {
  switch (verdict) {
    case identification::MemoryVerdict::kMasing:
      return "masing";
    case identification::MemoryVerdict::kDahl:
      return "dahl";
    case identification::MemoryVerdict::kNeither:
      return "neither";
    case identification::MemoryVerdict::kUndecided:
      return "undecided";
  }
  return "";
}

std::string PlainName(std::string_view key) {
  if (key == "sigma") return "stiffness σ";
  if (key == "alpha") return "shape exponent α";
  if (key == "slip_force") return "slip force Tc";
  if (key.ends_with(".value")) key.remove_suffix(std::string_view(".value").size());
  std::string name;
  for (const char character : key) {
    if (character == '.') name += ',';
    name += character == '_' || character == '.' ? ' ' : character;
  }
  return name;
}

std::string ConfidenceWords(const identification::FitResult& fit) {
  return fmt::format("{:g} %", 100 * fit.confidence);
}

}  // namespace mindahl::report
