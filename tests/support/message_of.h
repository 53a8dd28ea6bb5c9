#pragma once

#include <string>

#include "mindahl/core/error.h"

namespace mindahl {

/// Message of what the call throws; empty when it throws nothing.
template <typename Error = InvalidArgument, typename Call>
std::string MessageOf(Call&& call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

}  // namespace mindahl
