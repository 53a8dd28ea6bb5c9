#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace mindahl::io {

/// Returns SHA-256 (FIPS 180-4) of a file's bytes as 64 hexadecimal digits, as sha256sum prints it:
/// two files with one digest are one record. Empty for what is no regular file, which cannot be
/// read twice.
/// @throws InputError "cannot read '<path>': <reason>", also where libcrypto gives no digest
std::optional<std::string> Sha256OfFile(const std::filesystem::path& path);

}  // namespace mindahl::io
