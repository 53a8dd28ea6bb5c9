#include "methods/path_methods.h"

#include <algorithm>
#include <boost/numeric/odeint/stepper/controlled_runge_kutta.hpp>
#include <boost/numeric/odeint/stepper/generation.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_dopri5.hpp>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "models/scaled_branches.h"

namespace mindahl::methods {

namespace {

/// Implements a shape as backbone.h defines it.
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

}  // namespace

Evaluator PrepareTable(const models::FrictionModel& model, const models::BranchLaw& law,
                       const Resolution& resolution) {
  const auto shape = std::make_shared<const TableShape>(law.shape_exponent, resolution.steps);
  return [&model, law, shape](const Drive& drive, std::span<double> force) {
    const models::LoadingPath path = MakeDrivePath(model, drive);
    const models::ScaledBranches branches =
        models::ScaleBranches(models::BranchScaling(model, law), path, *shape);
    for (const models::BranchRun& run : path.runs) {
      const std::size_t count = run.end - run.begin;
      models::EvaluateRun(branches[static_cast<std::size_t>(run.branch)], *shape, law.slip_force,
                          models::ForceLimit(model), drive.displacement.subspan(run.begin, count),
                          force.subspan(run.begin, count));
    }
  };
}

void CountTable(const models::FrictionModel& model, const models::BranchLaw& /*law*/,
                const Resolution& /*resolution*/, const Drive& drive, OperationCount& count) {
  const std::size_t branches = CountPath(model, drive, count).branches.size();
  count.Add(Operation::kLookUp, static_cast<double>(drive.displacement.size() + branches));
}

using models::BranchLaw;
using models::FrictionModel;
using models::LoadingPath;

namespace {

/// u₊^α, 0 from slip on also for α = 0 and 1 before the branch: what a trial step asks for. Counts
/// what is done with it where that is asked for.
class Rate {
 public:
  Rate(double shape_exponent, OperationCount* count)
      : shape_exponent_(shape_exponent), count_(count) {}

  double operator()(double remaining) const {
    Count(Operation::kStage);
    if (remaining <= 0) return 0.0;
    if (remaining >= 1) return 1.0;
    if (shape_exponent_ == 1.0 / 3.0) {
      Count(Operation::kCubicRoot);
      return std::cbrt(remaining);
    }
    if (shape_exponent_ == 1) return remaining;
    if (shape_exponent_ == 0) return 1.0;
    Count(Operation::kRatePower);
    return std::pow(remaining, shape_exponent_);
  }

  void Count(Operation operation) const {
    if (count_ != nullptr) count_->Add(operation);
  }

  [[nodiscard]] double shape_exponent() const { return shape_exponent_; }

 private:
  double shape_exponent_;
  OperationCount* count_;
};

/// A branch as far as it has been followed.
struct FollowedBranch {
  models::ScaledBranch scaled;
  double y = 0.0;          // distance followed, in the branch's scale
  double remaining = 1.0;  // u there

  [[nodiscard]] double Force(double displacement) const {
    return scaled.force +
           std::copysign(scaled.height * (1 - remaining), displacement - scaled.origin);
  }
};

/// Follows every branch of a path by `advance(u, Δy)`, which returns the next u.
template <typename Advance>
class BranchFollower {
 public:
  BranchFollower(const FrictionModel& model, const BranchLaw& law, const LoadingPath& path,
                 const Advance& advance)
      : scaling_(model, law), path_(path), advance_(advance) {
    followed_.reserve(path.branches.size());
  }

  /// Returns the force over Tc.
  double MoveTo(std::size_t branch, double displacement) {
    while (followed_.size() <= branch) Open(path_.branches[followed_.size()]);
    FollowedBranch& on = followed_[branch];
    const double y = on.scaled.Normalize(displacement - on.scaled.origin);
    if (y > on.y) {
      on.remaining = std::clamp(advance_(on.remaining, y - on.y), 0.0, 1.0);
      on.y = y;
    }
    return on.Force(displacement);
  }

 private:
  void Open(const models::Branch& branch) {
    const double origin_force = scaling_.OriginForce(
        branch, [&](std::size_t parent) { return MoveTo(parent, branch.origin); });
    followed_.push_back({scaling_.Start(branch, origin_force)});
  }

  models::BranchScaling scaling_;
  const LoadingPath& path_;
  const Advance& advance_;
  std::vector<FollowedBranch> followed_;
};

template <typename Advance>
Evaluator Follow(const FrictionModel& model, const BranchLaw& law, Advance advance) {
  return [&model, law, advance = std::move(advance)](const Drive& drive, std::span<double> force) {
    const LoadingPath path = MakeDrivePath(model, drive);
    BranchFollower follower(model, law, path, advance);
    const double limit = models::ForceLimit(model);
    for (const models::BranchRun& run : path.runs) {
      const auto branch = static_cast<std::size_t>(run.branch);
      for (std::size_t i = run.begin; i < run.end; ++i) {
        const double t = follower.MoveTo(branch, drive.displacement[i]);
        force[i] = law.slip_force * std::clamp(t, -limit, limit);
      }
    }
  };
}

/// Makes equal steps by `step(rate, u, h)`.
template <typename Step>
Evaluator FollowInSteps(const FrictionModel& model, const BranchLaw& law, std::size_t steps,
                        OperationCount* count, Step step) {
  return Follow(model, law,
                [steps, rate = Rate(law.shape_exponent, count), step = std::move(step)](
                    double remaining, double distance) {
                  const double h = distance / static_cast<double>(steps);
                  for (std::size_t i = 0; i < steps && remaining > 0; ++i) {
                    rate.Count(Operation::kStep);
                    remaining = step(rate, remaining, h);
                  }
                  return remaining;
                });
}

/// Returns u' with u' + h·u'^α = u. In x = u'^α for α < 1, else in u' itself, that is
///   a·x + b·x^q = u,  q = max(α, 1/α) >= 1,
/// convex: Newton's rule falls to the root from either term's own, in 2 to 4 steps on average and
/// at most 7 for α from 0.2 to 5.
double SolveBackwardStep(const Rate& rate, double remaining, double h) {
  constexpr int kMostSteps = 100;  // α or 1/α in the thousands takes its logarithm
  const double alpha = rate.shape_exponent();
  if (alpha == 0) return remaining - h;
  if (alpha == 1) return remaining / (1 + h);
  const bool in_rate = alpha < 1;
  const double linear = in_rate ? h : 1.0;
  const double factor = in_rate ? 1.0 : h;
  const double exponent = in_rate ? 1 / alpha : alpha;
  rate.Count(Operation::kRatePower);
  double x = std::min(remaining / linear, std::pow(remaining / factor, 1 / exponent));
  for (int i = 0; i < kMostSteps; ++i) {
    rate.Count(Operation::kIteration);
    if (exponent != 3) rate.Count(Operation::kRatePower);
    const double power = factor * (exponent == 3 ? x * x * x : std::pow(x, exponent));
    const double excess = linear * x + power - remaining;
    const double change = excess / (linear + exponent * power / x);
    if (!(change > std::numeric_limits<double>::epsilon() * x)) break;
    x -= change;
  }
  return in_rate ? remaining - h * x : x;
}

}  // namespace

Evaluator MakeEuler(const FrictionModel& model, const BranchLaw& law, const Resolution& resolution,
                    OperationCount* count) {
  return FollowInSteps(model, law, resolution.steps, count,
                       [](const Rate& rate, double u, double h) { return u - h * rate(u); });
}

Evaluator MakeRk4(const FrictionModel& model, const BranchLaw& law, const Resolution& resolution,
                  OperationCount* count) {
  return FollowInSteps(model, law, resolution.steps, count,
                       [](const Rate& rate, double u, double h) {
                         const double k1 = rate(u);
                         const double k2 = rate(u - h / 2 * k1);
                         const double k3 = rate(u - h / 2 * k2);
                         const double k4 = rate(u - h * k3);
                         return u - h / 6 * (k1 + 2 * (k2 + k3) + k4);
                       });
}

Evaluator MakeBackwardEuler(const FrictionModel& model, const BranchLaw& law,
                            const Resolution& resolution, OperationCount* count) {
  return FollowInSteps(
      model, law, resolution.steps, count,
      [](const Rate& rate, double u, double h) { return SolveBackwardStep(rate, u, h); });
}

/// Makes steps u' = u − h·u^α·φ₁(−αh·u^{α−1}), φ₁(q) = (e^q − 1)/q.
Evaluator MakeExponential(const FrictionModel& model, const BranchLaw& law,
                          const Resolution& resolution, OperationCount* count) {
  return FollowInSteps(model, law, resolution.steps, count,
                       [](const Rate& rate, double u, double h) {
                         const double slope = rate(u);
                         const double q = rate.shape_exponent() * h * slope / u;
                         if (q == 0) return u - h * slope;
                         rate.Count(Operation::kExponential);
                         const double mean = -std::expm1(-q) / q;
                         return u - h * slope * mean;
                       });
}

Evaluator MakeDopri5(const FrictionModel& model, const BranchLaw& law, const Resolution& resolution,
                     OperationCount* count) {
  namespace odeint = boost::numeric::odeint;
  const auto follow = [rate = Rate(law.shape_exponent, count), steps = resolution.steps,
                       tolerance = resolution.tolerance](double remaining, double distance) {
    auto stepper = odeint::make_controlled<odeint::runge_kutta_dopri5<double>>(tolerance, 0.0);
    const auto system = [&rate](double u, double& derivative, double /*y*/) {
      derivative = -rate(u);
    };
    const double longest = distance / static_cast<double>(steps);
    double y = 0.0;
    double h = longest;
    while (remaining > 0 && y < distance) {
      h = std::min({h, longest, distance - y});
      if (y + h <= y) return remaining;
      // Ends also in the corner at slip: rates are within [0, 1], so that no step h <= tolerance
      // is rejected.
      rate.Count(Operation::kTrial);
      stepper.try_step(system, remaining, y, h);
    }
    return remaining;
  };
  return Follow(model, law, follow);
}

}  // namespace mindahl::methods
