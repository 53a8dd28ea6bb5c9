#pragma once

#include <string>
#include <string_view>

namespace mindahl::io {

/// Returns the text that a page of HTML shows as it is, between tags or in quotes: & < > " ' are
/// escaped; what is not UTF-8, and control characters but for the line feed, become U+FFFD.
std::string HtmlText(std::string_view text);

}  // namespace mindahl::io
