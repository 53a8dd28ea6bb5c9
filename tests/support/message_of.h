#pragma once

#include <string>

#include "mindahl/core/error.h"

namespace mindahl {

/// Message of the InvalidArgument that the call throws; empty when it throws none.
template <typename Call>
std::string MessageOf(Call call) {
  try {
    call();
  } catch (const InvalidArgument& error) {
    return error.what();
  }
  return {};
}

}  // namespace mindahl
