#pragma once

#include <fmt/format.h>

#include <cstring>
#include <filesystem>

#include "mindahl/core/error.h"

namespace mindahl::io {

/// @param error  errno of what failed
/// @throws InputError always
[[noreturn]] inline void ThrowCannotWrite(const std::filesystem::path& path, int error) {
  throw InputError(fmt::format("cannot write '{}': {}", path.string(), std::strerror(error)));
}

}  // namespace mindahl::io
