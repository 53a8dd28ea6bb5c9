#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace mindahl::cli {

/// One `key = value` of a TOML text.
struct TomlItem {
  std::string section;              ///< name in [section]; "" above the first
  std::string key;                  ///< without quotation marks
  std::vector<std::string> values;  ///< one, or those of an array, as the command line takes them
  std::size_t line = 0;             ///< 1-based, of the key
};

/// The part of TOML that options need: sections, and keys with a string, a number, a boolean or an
/// array of such, which may span lines, have comments between its values and end in a comma. A word
/// without quotation marks is a string too.
/// @param file  the text's name, for messages
/// @throws InputError naming file and line: what is not closed, has no value, or comes after one
std::vector<TomlItem> ReadToml(std::string_view text, std::string_view file);

}  // namespace mindahl::cli
