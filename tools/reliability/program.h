#pragma once

#include <fmt/format.h>

#include <cstdio>
#include <exception>

namespace mindahl::reliability {

/// Runs a program of this folder: an error that it does not expect is a line and exit status 1.
inline int RunProgram(const char* name, int (*program)(int, char**), int argc, char** argv) {
  try {
    return program(argc, argv);
  } catch (const std::exception& fault) {
    fmt::print(stderr, "{}: {}\n", name, fault.what());
    return 1;
  }
}

}  // namespace mindahl::reliability
