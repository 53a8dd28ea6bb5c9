#pragma once

#include <array>
#include <cstddef>
#include <string_view>

#include "mindahl/identification/fit.h"

namespace mindahl::report {

/// Lists what the reports call the values of an enumeration, in their order.
template <typename Enum>
inline constexpr std::array<std::string_view, 0> kNamesOf{};

template <>
inline constexpr auto kNamesOf<identification::ParameterStatus> =
    std::to_array<std::string_view>({"free", "fixed", "at_lower_bound", "at_upper_bound"});
template <>
inline constexpr auto kNamesOf<identification::Identifiability> = std::to_array<std::string_view>(
    {"identifiable", "effective", "bounded_below", "not_identifiable"});
template <>
inline constexpr auto kNamesOf<models::InitialState> = std::to_array<std::string_view>({"virgin",
                                                                                        "steady"});
template <>
inline constexpr auto kNamesOf<identification::AdequacyVerdict> =
    std::to_array<std::string_view>({"adequate", "doubtful", "inadequate"});
template <>
inline constexpr auto kNamesOf<identification::Use> =
    std::to_array<std::string_view>({"quantitative", "indicative", "none"});

template <typename Enum>
constexpr std::string_view Name(Enum value) {
  const auto place = static_cast<std::size_t>(value);
  return place < kNamesOf<Enum>.size() ? kNamesOf<Enum>[place] : std::string_view();
}

}  // namespace mindahl::report
