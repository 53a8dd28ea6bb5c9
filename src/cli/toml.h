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

/// Returns the keys of a TOML text (toml.io), in its order: strings, numbers, booleans and arrays
/// of such.
/// @param file  the text's name, for messages
/// @throws InputError naming file and line: of what is no TOML, of a key that is given twice, and
/// of
///   a value that no option takes
std::vector<TomlItem> ReadToml(std::string_view text, std::string_view file);

}  // namespace mindahl::cli
