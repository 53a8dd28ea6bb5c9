#pragma once

#include "mindahl/core/error.h"

namespace mindahl::identification {

/// A fit has fewer samples that count than free parameters. The message has both numbers, and how
/// many samples of how many were left out for what.
class TooFewSamples : public InvalidArgument {
 public:
  using InvalidArgument::InvalidArgument;
};

}  // namespace mindahl::identification
