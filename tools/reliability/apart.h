#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>

namespace mindahl::reliability {

/// How a piece of work ended.
struct Ending {
  std::optional<std::string> answer;  ///< empty where it gave none
  std::string fault;                  ///< why not
  double seconds = 0.0;               ///< of processor time
};

struct ApartOptions {
  std::size_t at_once = 1;
  unsigned seconds = 20;  ///< of processor time that a piece may take
};

/// Runs each piece of work in a process of its own, so that one that never returns, or ends the
/// program, is one of many.
/// @param work   called in the other process with the piece's number; what it throws is a fault
/// @param ended  called here as pieces end, in any order
/// @throws std::system_error where no process can be started
void RunApart(std::size_t pieces, const ApartOptions& options,
              const std::function<std::string(std::size_t)>& work,
              const std::function<void(std::size_t, const Ending&)>& ended);

}  // namespace mindahl::reliability
