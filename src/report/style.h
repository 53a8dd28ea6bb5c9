#pragma once

#include <fmt/color.h>

#include <cstddef>
#include <string>
#include <string_view>

#include "report/statements.h"

namespace mindahl::report {

/// Colours of a terminal, or none.
class Style {
 public:
  explicit Style(bool has_colours) : has_colours_(has_colours) {}

  [[nodiscard]] std::string Judged(Judgement judgement, std::string_view text) const {
    using enum fmt::terminal_color;
    const auto colour = judgement == Judgement::kGood   ? green
                        : judgement == Judgement::kPoor ? yellow
                                                        : red;
    return Of(fmt::fg(colour), text);
  }
  [[nodiscard]] std::string Strong(std::string_view text) const {
    return Of(fmt::emphasis::bold, text);
  }

 private:
  [[nodiscard]] std::string Of(const fmt::text_style& style, std::string_view text) const {
    return has_colours_ ? fmt::format(style, "{}", text) : std::string(text);
  }

  bool has_colours_;
};

/// Breaks a sentence between words at 100 columns, with a line feed at its end; lines after the
/// first are indented. A number stays with its error and its unit. No sentence has no line.
std::string Wrapped(std::string_view text, std::size_t indent);

}  // namespace mindahl::report
