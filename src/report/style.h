#pragma once

#include <fmt/color.h>

#include <string>
#include <string_view>

namespace mindahl::report {

/// Colours of a terminal, or none.
class Style {
 public:
  explicit Style(bool has_colours) : has_colours_(has_colours) {}

  [[nodiscard]] std::string Good(std::string_view text) const {
    return Of(fmt::fg(fmt::terminal_color::green), text);
  }
  [[nodiscard]] std::string Caution(std::string_view text) const {
    return Of(fmt::fg(fmt::terminal_color::yellow), text);
  }
  [[nodiscard]] std::string Bad(std::string_view text) const {
    return Of(fmt::fg(fmt::terminal_color::red), text);
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

}  // namespace mindahl::report
