#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace mindahl::cli {

/// Check for options that take one of several words: help lists them, and a word that is none is
/// refused with the nearest.
CLI::Validator OneOf(std::vector<std::string> words);

}  // namespace mindahl::cli
