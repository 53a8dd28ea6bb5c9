#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include "mindahl/identification/fit.h"
#include "mindahl/report/loop_description.h"

namespace mindahl::report {

/// Returns what the reports call the values of an enumeration, in their order.
template <typename Enum>
std::span<const std::string_view> Names();

template <>
std::span<const std::string_view> Names<identification::ParameterStatus>();
template <>
std::span<const std::string_view> Names<identification::Identifiability>();
template <>
std::span<const std::string_view> Names<identification::IntervalSource>();
template <>
std::span<const std::string_view> Names<models::InitialState>();
template <>
std::span<const std::string_view> Names<loop::Channel>();
template <>
std::span<const std::string_view> Names<SlipRegime>();
template <>
std::span<const std::string_view> Names<identification::AdequacyVerdict>();
template <>
std::span<const std::string_view> Names<identification::Use>();
template <>
std::span<const std::string_view> Names<identification::MemoryVerdict>();

template <typename Enum>
std::string_view Name(Enum value) {
  const auto place = static_cast<std::size_t>(value);
  return place < Names<Enum>().size() ? Names<Enum>()[place] : std::string_view();
}

/// Returns the name with blanks, for people.
std::string Words(identification::Identifiability identifiability);

/// Returns the name of a parameter or of a key of the JSON for people: "slip force Tc", "half gap".
std::string PlainName(std::string_view key);

/// Returns the confidence of a fit's intervals for people: "95 %".
std::string ConfidenceWords(const identification::FitResult& fit);

}  // namespace mindahl::report
