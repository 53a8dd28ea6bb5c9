#pragma once

#include <array>
#include <cstddef>
#include <string_view>

#include "mindahl/methods/method.h"
#include "mindahl/models/branch_law.h"
#include "mindahl/models/friction_model.h"

namespace mindahl::methods {

/// Names the operations of which a method for the force along a drive is made. The counts are
/// properties of the drive and of the method, whatever machine runs them and however busy it is.
enum class Operation : std::size_t {
  kSample,       ///< a displacement read and a force written
  kPlace,        ///< the branch found that a sample lies on
  kReversal,     ///< a branch opened
  kLinear,       ///< the branch law, α = 0
  kRoot,         ///< the branch law, α = 1/3: a square root and a division
  kPower,        ///< the branch law, any other α: two transcendentals
  kNarrowing,    ///< a sample to single precision and back
  kElement,      ///< an element of Iwan's, moved on
  kSum,          ///< the sum of their forces
  kLookUp,       ///< the branch law from a table
  kStep,         ///< a step of fixed size
  kStage,        ///< a rate of a differential equation, whatever α, put to use
  kTrial,        ///< a step whose error is controlled, taken or not
  kCubicRoot,    ///< u^α of a differential equation, α = 1/3
  kRatePower,    ///< u^α, any other α but 0 and 1
  kExponential,  ///< exponential of an exponential step
  kIteration,    ///< iteration of Newton's rule in an implicit step
};

inline constexpr std::size_t kOperations = static_cast<std::size_t>(Operation::kIteration) + 1;

/// Returns "sample", "place", "reversal", …
std::string_view NameOf(Operation operation);

/// How many of each a whole drive takes.
class OperationCount {
 public:
  [[nodiscard]] double operator[](Operation operation) const {
    return count_[static_cast<std::size_t>(operation)];
  }
  void Add(Operation operation, double times = 1.0) {
    count_[static_cast<std::size_t>(operation)] += times;
  }

 private:
  std::array<double, kOperations> count_{};
};

/// Counts the operations of an evaluation along a drive, by running it where they depend on it.
/// @throws InvalidArgument as Prepare()
/// Cost: that of one evaluation at most.
OperationCount CountOperations(const Method& method, const models::FrictionModel& model,
                               const models::BranchLaw& law, const Resolution& resolution,
                               const Drive& drive);

}  // namespace mindahl::methods
