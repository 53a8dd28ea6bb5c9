#pragma once

#include <filesystem>

namespace mindahl::paper {

/// Writes paper_fig3 … paper_fig8, each as .csv in SI units and as .png, into an existing
/// directory.
/// @throws InputError when a file cannot be written or the program that makes PNG is missing
void WriteFigures(const std::filesystem::path& directory);

}  // namespace mindahl::paper
