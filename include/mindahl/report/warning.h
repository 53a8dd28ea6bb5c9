#pragma once

#include <string>

namespace mindahl::report {

/// Something that a person should act on.
struct Warning {
  std::string code;  ///< stable, for scripts; docs/contract.md lists them
  std::string message;
};

}  // namespace mindahl::report
