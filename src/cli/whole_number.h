#pragma once

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <charconv>
#include <cstdint>
#include <string>

namespace mindahl::cli {

/// Check for options that count: CLI11 itself reads -1 as 2⁶⁴ − 1.
inline CLI::Validator WholeNumber(std::uint64_t least, std::uint64_t most) {
  const auto check = [least, most](const std::string& text) -> std::string {
    std::uint64_t number = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    const bool whole = error == std::errc() && end == text.data() + text.size();
    if (whole && number >= least && number <= most) return {};
    return fmt::format("'{}' is invalid: must be a whole number from {} to {}", text, least, most);
  };
  return CLI::Validator(check, "");
}

}  // namespace mindahl::cli
