#include "report/names.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace mindahl::report {

using identification::Identifiability;
using identification::ParameterStatus;

using NameList = std::span<const std::string_view>;

template <>
NameList Names<ParameterStatus>() {
  static constexpr auto kNames =
      std::to_array<std::string_view>({"free", "fixed", "at_lower_bound", "at_upper_bound"});
  return kNames;
}

template <>
NameList Names<Identifiability>() {
  static constexpr auto kNames = std::to_array<std::string_view>(
      {"identifiable", "effective", "extrapolated", "bounded_below", "not_identifiable"});
  return kNames;
}

template <>
NameList Names<identification::IntervalSource>() {
  static constexpr auto kNames = std::to_array<std::string_view>(
      {"parabola", "profile", "initial_state", "other_minimum", "omitted_terms", "plateau",
       "small_alpha", "discrepancy", "carried_force"});
  return kNames;
}

template <>
NameList Names<models::InitialState>() {
  static constexpr auto kNames = std::to_array<std::string_view>({"virgin", "steady"});
  return kNames;
}

template <>
NameList Names<loop::Channel>() {
  static constexpr auto kNames = std::to_array<std::string_view>({"displacement", "force"});
  return kNames;
}

template <>
NameList Names<SlipRegime>() {
  static constexpr auto kNames = std::to_array<std::string_view>({"partial", "gross"});
  return kNames;
}

template <>
NameList Names<identification::AdequacyVerdict>() {
  static constexpr auto kNames =
      std::to_array<std::string_view>({"adequate", "doubtful", "inadequate"});
  return kNames;
}

template <>
NameList Names<identification::Use>() {
  static constexpr auto kNames =
      std::to_array<std::string_view>({"quantitative", "indicative", "none"});
  return kNames;
}

template <>
NameList Names<identification::MemoryVerdict>() {
  static constexpr auto kNames =
      std::to_array<std::string_view>({"masing", "dahl", "neither", "undecided"});
  return kNames;
}

std::string Words(Identifiability identifiability) {
  std::string words(Name(identifiability));
  std::ranges::replace(words, '_', ' ');
  return words;
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
