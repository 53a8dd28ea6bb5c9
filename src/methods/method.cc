#include "mindahl/methods/method.h"

#include <algorithm>
#include <array>
#include <boost/numeric/odeint/stepper/controlled_runge_kutta.hpp>
#include <boost/numeric/odeint/stepper/generation.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_dopri5.hpp>
#include <cmath>
#include <vector>

#include "core/refuse.h"
#include "mindahl/loop/reversals.h"
#include "mindahl/methods/iwan.h"
#include "mindahl/models/response.h"
#include "models/scaled_branches.h"

namespace mindahl::methods {

using models::BranchLaw;
using models::FrictionModel;
using models::LoadingPath;

namespace {

// Costs of operations [ns].
constexpr double kPlace = 4.1;       // to find the branch that a sample lies on
constexpr double kReversal = 100.0;  // to open a branch
constexpr double kRoot = 1.4;        // the branch law, α = 1/3: a square root and a division
constexpr double kPower = 17.0;      // the branch law, any other α: two transcendentals
constexpr double kLookUp = 2.3;      // the branch law from a table
constexpr double kElement = 0.35;    // an element of Iwan's, moved on
constexpr double kSum = 4.0;         // the sum of their forces
constexpr double kRate = 33.0;       // of dopri5, a power
constexpr double kTrial = 52.0;      // of dopri5, a step, accepted or not, but for its powers

/// Returns the time [ns] of finding the path and evaluating a law at every sample and reversal.
double CostOf(const LoadingPath& path, std::size_t samples, double evaluation) {
  const auto branches = static_cast<double>(path.branches.size());
  const auto places = static_cast<double>(samples);
  return kPlace * places + kReversal * branches + evaluation * (places + branches);
}

LoadingPath PathOf(const FrictionModel& model, const Drive& drive) {
  return models::MakeLoadingPath(drive.displacement, loop::FindReversals(drive.displacement, 0.0),
                                 model.memory, {.state = models::InitialState::kVirgin});
}

Evaluator PrepareExact(const FrictionModel& model, const BranchLaw& law, const Resolution&) {
  // The law of a Jenkins element (α = 0) adds no measurable time to finding the branch.
  const double evaluation = law.shape_exponent == 0         ? 0.0
                            : law.shape_exponent == 1.0 / 3 ? kRoot
                                                            : kPower;
  return [&model, law, evaluation](const Drive& drive, std::span<double> force) {
    const LoadingPath path = PathOf(model, drive);
    models::EvaluateForce(model, law, path, drive.displacement, force);
    return CostOf(path, force.size(), evaluation);
  };
}

/// A shape as backbone.h defines it: φ between equal intervals of r = y/(1+y), which takes every y
/// to [0, 1), linearly.
class TableShape {
 public:
  TableShape(double shape_exponent, std::size_t intervals) : node_(intervals + 1) {
    // Slip, y = 1/(1−α), is the last node; for α >= 1 that is infinity.
    const double last = shape_exponent < 1 ? 1 / (2 - shape_exponent) : 1.0;
    const models::backbone::GeneralShape<double> shape{shape_exponent};
    for (std::size_t i = 0; i < intervals; ++i) {
      const double r = last * static_cast<double>(i) / static_cast<double>(intervals);
      node_[i] = shape.Force(r / (1 - r));
    }
    node_.back() = 1.0;
    intervals_per_unit_ = static_cast<double>(intervals) / last;
  }

  [[nodiscard]] double Force(double y) const {
    const double at = intervals_per_unit_ * (y / (1 + y));
    const double intervals = static_cast<double>(node_.size() - 1);
    if (at >= intervals) return 1.0;
    const auto node = static_cast<std::size_t>(at);
    return node_[node] + (at - static_cast<double>(node)) * (node_[node + 1] - node_[node]);
  }

 private:
  std::vector<double> node_;
  double intervals_per_unit_ = 1.0;
};

/// Follows each branch by the equation du/dy = −u₊^α, u(0) = 1, in the branch's own scale, in which
/// it is one for every model and branch. A branch that is left and taken up again goes on from
/// where it was left: that is return-point memory.
class BranchFollower {
 public:
  BranchFollower(const FrictionModel& model, const BranchLaw& law, const LoadingPath& path,
                 const Resolution& resolution)
      : scaling_(model, models::Normalized(law)),
        path_(path),
        shape_exponent_(law.shape_exponent),
        resolution_(resolution) {
    followed_.reserve(path.branches.size());
  }

  /// Returns the force over Tc.
  double MoveTo(std::size_t branch, double displacement) {
    while (followed_.size() <= branch) {
      const models::Branch& next = path_.branches[followed_.size()];
      const double origin_force = scaling_.OriginForce(
          next, [&](std::size_t parent) { return MoveTo(parent, next.origin); });
      followed_.push_back({scaling_.Start(next, origin_force)});
    }
    FollowedBranch& on = followed_[branch];
    const double travel = displacement - on.scaled.origin;
    const double y = on.scaled.Normalize(travel);
    if (y > on.y) {
      on.remaining = std::clamp(Advance(on.remaining, y - on.y), 0.0, 1.0);
      on.y = y;
    }
    return on.scaled.force + std::copysign(on.scaled.height * (1 - on.remaining), travel);
  }

  /// Returns the time [ns] that steps took so far.
  [[nodiscard]] double cost() const { return cost_; }

 private:
  /// A branch as far as it has been followed.
  struct FollowedBranch {
    models::ScaledBranch scaled;
    double y = 0.0;          // distance followed, in the branch's scale
    double remaining = 1.0;  // u there
  };

  /// Returns u₊^α; 0 from slip on also for α = 0, and 1 before the branch, which a trial step asks
  /// for.
  double Rate(double remaining) {
    if (remaining <= 0) return 0.0;
    if (remaining >= 1 || shape_exponent_ == 0) return 1.0;
    cost_ += kRate;
    return shape_exponent_ == 1.0 / 3 ? std::cbrt(remaining) : std::pow(remaining, shape_exponent_);
  }

  /// Returns u a distance further on.
  double Advance(double remaining, double distance) {
    namespace odeint = boost::numeric::odeint;
    auto stepper =
        odeint::make_controlled<odeint::runge_kutta_dopri5<double>>(resolution_.tolerance, 0.0);
    const auto system = [&](double u, double& derivative, double /*y*/) { derivative = -Rate(u); };
    const double longest = distance / static_cast<double>(resolution_.steps);
    double y = 0.0;
    double h = longest;
    while (remaining > 0 && y < distance) {
      h = std::min({h, longest, distance - y});
      if (y + h <= y) return remaining;
      // Ends also in the corner at slip: rates are within [0, 1], so that no step h <= tolerance
      // is rejected.
      cost_ += kTrial;
      stepper.try_step(system, remaining, y, h);
    }
    return remaining;
  }

  models::BranchScaling scaling_;
  const LoadingPath& path_;
  double shape_exponent_;
  Resolution resolution_;
  double cost_ = 0.0;
  std::vector<FollowedBranch> followed_;
};

Evaluator PrepareDopri5(const FrictionModel& model, const BranchLaw& law,
                        const Resolution& resolution) {
  return [&model, law, resolution](const Drive& drive, std::span<double> force) {
    const LoadingPath path = PathOf(model, drive);
    BranchFollower follower(model, law, path, resolution);
    for (const models::BranchRun& run : path.runs) {
      for (std::size_t i = run.begin; i < run.end; ++i) {
        const double t =
            follower.MoveTo(static_cast<std::size_t>(run.branch), drive.displacement[i]);
        force[i] = law.slip_force * std::clamp(t, -1.0, 1.0);
      }
    }
    return CostOf(path, force.size(), 0.0) + follower.cost();
  };
}

Evaluator PrepareIwan(const FrictionModel&, const BranchLaw& law, const Resolution& resolution) {
  return [elements = MakeIwanElements(law, resolution.steps)](const Drive& drive,
                                                              std::span<double> force) {
    EvaluateIwanForce(elements, drive.displacement, force);
    const auto moved = static_cast<double>(elements.size());
    return static_cast<double>(force.size()) * (kElement * moved + kSum);
  };
}

Evaluator PrepareTable(const FrictionModel& model, const BranchLaw& law,
                       const Resolution& resolution) {
  const TableShape shape(law.shape_exponent, resolution.steps);
  return [&model, law, shape](const Drive& drive, std::span<double> force) {
    const LoadingPath path = PathOf(model, drive);
    models::EvaluatePath(model, models::Normalized(law), shape, law.slip_force, path,
                         drive.displacement, force);
    return CostOf(path, force.size(), kLookUp);
  };
}

constexpr std::array kMethods{
    Method{.name = "exact", .title = "closed form", .prepare = PrepareExact},
    Method{.name = "dopri5",
           .title = "Dormand-Prince 5(4), adaptive",
           .steps = "substeps a sample at least",
           .adaptive = true,
           .prepare = PrepareDopri5},
    Method{.name = "iwan",
           .title = "Jenkins elements in parallel",
           .steps = "elements",
           .default_steps = 32,
           .masing_only = true,
           .prepare = PrepareIwan},
    Method{.name = "table",
           .title = "tabulated branch law",
           .steps = "intervals",
           .default_steps = 256,
           .prepare = PrepareTable},
};

}  // namespace

std::span<const Method> Methods() { return kMethods; }

const Method* FindMethod(std::string_view name) {
  const auto method = std::ranges::find(kMethods, name, &Method::name);
  return method == kMethods.end() ? nullptr : &*method;
}

Evaluator Prepare(const Method& method, const FrictionModel& model, const BranchLaw& law,
                  const Resolution& resolution) {
  Validate(law);
  if (resolution.steps == 0) ThrowInvalid("steps [-]", 0.0, "must be >= 1");
  RequirePositive("tolerance [-]", resolution.tolerance);
  if (method.masing_only && model.memory != models::Memory::kReturnPoint) {
    Refuse<InvalidArgument>(
        "method {} cannot compute model {}: its elements remember every reversal, the model does "
        "not",
        method.name, model.name);
  }
  return [evaluate = method.prepare(model, law, resolution)](const Drive& drive,
                                                             std::span<double> force) {
    RequireSameSize("displacement", drive.displacement.size(), "force", force.size());
    return evaluate(drive, force);
  };
}

}  // namespace mindahl::methods
