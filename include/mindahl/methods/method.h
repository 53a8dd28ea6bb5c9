#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <limits>
#include <span>
#include <string_view>

#include "mindahl/models/branch_law.h"
#include "mindahl/models/friction_model.h"
#include "mindahl/models/loading_path.h"

namespace mindahl::methods {

/// An imposed displacement [m]; the contact is unloaded at 0.
struct Drive {
  std::span<const double> displacement;
  /// Amplitude [m] at each sample where it changes along the way, else empty. Only a model that
  /// refers to its steady loop looks at it.
  std::span<const double> envelope = {};
};

/// Makes the loading path of a drive, in which every change of direction is a reversal.
/// @throws InvalidArgument as MakeLoadingPath and MakeEnvelopePath
models::LoadingPath MakeDrivePath(const models::FrictionModel& model, const Drive& drive);

/// Sets how finely a method resolves.
struct Resolution {
  /// Substeps a sample, elements or nodes: what the method says. >= 1
  std::size_t steps = 1;
  /// Largest local error of T/Tc in a step of an adaptive method, >= kLeastTolerance.
  double tolerance = 1e-6;
};

/// 4 ε: what rounding does to u in [0, 1] over the stages of one step.
inline constexpr double kLeastTolerance = 4 * std::numeric_limits<double>::epsilon();

/// Force [N] along a drive, from displacement to force: reversals and branches are found within.
/// The spans must have one length.
using Evaluator = std::function<void(const Drive& drive, std::span<double> force)>;

class OperationCount;

/// A way to evaluate a friction model along a drive.
///
/// Each is given the reversals and the loops that close (the rules are the model's, and so is
/// the memory); what differs is how a branch is followed. The order below is that of the largest
/// force error in 1/steps while the contact does not slip grossly. At gross slip du/dy = −u^α is
/// not Lipschitz for α < 1: u reaches 0 as the power 1/(1−α) of the distance, which no step sees
/// coming, so that next to slip higher orders fall to 1/(1−α), 1.5 for Mindlin. A step later the
/// contact slips, exactly so, and what follows has the full order again. Every method is kept from
/// |T| > Tc by clamping u to [0, 1]; the elements of Iwan add up to Tc, to rounding.
struct Method {
  std::string_view name;   ///< on the command line
  std::string_view title;  ///< in reports
  /// Unit of Resolution::steps, a plural in -s first, as "substeps a sample"; "" if unused.
  std::string_view steps = {};
  std::size_t default_steps = 1;
  bool adaptive = false;     ///< uses Resolution::tolerance
  bool masing_only = false;  ///< serves only models whose memory is kReturnPoint
  /// Order of the error in 1/steps before gross slip; 0 when no step makes one.
  double order = 0.0;
  Evaluator (*prepare)(const models::FrictionModel& model, const models::BranchLaw& law,
                       const Resolution& resolution) = nullptr;
  /// Adds what an evaluation takes, samples read and written aside: CountOperations().
  void (*count)(const models::FrictionModel& model, const models::BranchLaw& law,
                const Resolution& resolution, const Drive& drive, OperationCount& count) = nullptr;
};

/// - exact: the closed form (models/response.h)
/// - euler, rk4: explicit, fixed steps of the displacement; orders 1 and 4
/// - dopri5: Dormand–Prince 5(4), error-controlled, `steps` its least number a sample; order 5 in
///   these where they are what limits it
/// - backward-euler: implicit, order 1, never oversteps Tc
/// - exponential: Rosenbrock–Euler with the local Jacobian, order 2; exact for α = 1
/// - iwan, iwan-optimal: `steps` Jenkins elements (methods/iwan.h); orders 1 and 2
/// - table: the branch law between `steps` equal intervals of y/(1+y), linear; order 2 while u > 0
///   at a fixed distance, min(2, 1/|1−α|) for any 0 < α: for α < 1/2 slip is a corner inside the
///   last interval's chord, for α > 3/2 the interval to infinity is one. Exact for α = 2
std::span<const Method> Methods();

/// Returns nullptr when there is no such method.
const Method* FindMethod(std::string_view name);

/// Returns a method made ready for a law: what a simulator does once.
/// @param model  must outlive the evaluator
/// @throws InvalidArgument for an invalid law or resolution, or a model that the method does not
///   serve, naming both
Evaluator Prepare(const Method& method, const models::FrictionModel& model,
                  const models::BranchLaw& law, const Resolution& resolution);

/// Names the operations of which a method for the force along a drive is made. The counts are
/// properties of the drive and of the method, whatever machine runs them and however busy it is.
enum class Operation : std::size_t {
  kSample,       ///< a displacement read and a force written
  kPlace,        ///< the branch found that a sample lies on
  kReversal,     ///< a branch opened
  kLinear,       ///< the branch law, α = 0
  kRoot,         ///< the branch law, α = 1/3: a square root and a division
  kPower,        ///< the branch law, any other α: two transcendentals
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

/// Counts the operations of each kind along a whole drive.
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
