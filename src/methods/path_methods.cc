#include "methods/path_methods.h"

#include <algorithm>
#include <boost/numeric/odeint/stepper/controlled_runge_kutta.hpp>
#include <boost/numeric/odeint/stepper/generation.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_dopri5.hpp>
#include <cmath>
#include <memory>
#include <vector>

#include "models/scaled_branches.h"

namespace mindahl::methods {

using models::BranchLaw;
using models::FrictionModel;
using models::LoadingPath;

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

constexpr double kCostOfRate = 33.0;   // [ns] a power
constexpr double kCostOfTrial = 52.0;  // [ns] a step, accepted or not, but for its powers

/// A branch as far as it has been followed.
struct FollowedBranch {
  models::ScaledBranch scaled;
  double y = 0.0;          // distance followed, in the branch's scale
  double remaining = 1.0;  // u there
};

/// Integrates du/dy = −u₊^α.
struct AdaptiveSteps {
  double shape_exponent;
  Resolution resolution;
  double* cost;

  void Spend(double nanoseconds) const {
    if (cost != nullptr) *cost += nanoseconds;
  }

  /// Returns u₊^α; 0 from slip on also for α = 0, and 1 before the branch, which a trial step asks
  /// for.
  [[nodiscard]] double Rate(double remaining) const {
    if (remaining <= 0) return 0.0;
    if (remaining >= 1 || shape_exponent == 0) return 1.0;
    if (shape_exponent == 1) return remaining;
    Spend(kCostOfRate);
    return shape_exponent == 1.0 / 3 ? std::cbrt(remaining) : std::pow(remaining, shape_exponent);
  }

  /// Returns u a distance further on.
  [[nodiscard]] double Advance(double remaining, double distance) const {
    namespace odeint = boost::numeric::odeint;
    auto stepper =
        odeint::make_controlled<odeint::runge_kutta_dopri5<double>>(resolution.tolerance, 0.0);
    const auto system = [&](double u, double& derivative, double /*y*/) { derivative = -Rate(u); };
    const double longest = distance / static_cast<double>(resolution.steps);
    double y = 0.0;
    double h = longest;
    while (remaining > 0 && y < distance) {
      h = std::min({h, longest, distance - y});
      if (y + h <= y) return remaining;
      // Ends also in the corner at slip: rates are within [0, 1], so that no step h <= tolerance
      // is rejected.
      Spend(kCostOfTrial);
      stepper.try_step(system, remaining, y, h);
    }
    return remaining;
  }
};

/// Follows every branch of a path.
class BranchFollower {
 public:
  BranchFollower(const FrictionModel& model, const BranchLaw& law, const LoadingPath& path,
                 const AdaptiveSteps& steps)
      : scaling_(model, law), path_(path), steps_(steps) {
    followed_.reserve(path.branches.size());
  }

  /// Returns the force over Tc.
  double MoveTo(std::size_t branch, double displacement) {
    while (followed_.size() <= branch) Open(path_.branches[followed_.size()]);
    FollowedBranch& on = followed_[branch];
    const double travel = displacement - on.scaled.origin;
    const double y = on.scaled.Normalize(travel);
    if (y > on.y) {
      on.remaining = std::clamp(steps_.Advance(on.remaining, y - on.y), 0.0, 1.0);
      on.y = y;
    }
    return on.scaled.force + std::copysign(on.scaled.height * (1 - on.remaining), travel);
  }

 private:
  void Open(const models::Branch& branch) {
    const double origin_force = scaling_.OriginForce(
        branch, [&](std::size_t parent) { return MoveTo(parent, branch.origin); });
    followed_.push_back({scaling_.Start(branch, origin_force)});
  }

  models::BranchScaling scaling_;
  const LoadingPath& path_;
  const AdaptiveSteps& steps_;
  std::vector<FollowedBranch> followed_;
};

}  // namespace

Evaluator PrepareTable(const FrictionModel& model, const BranchLaw& law,
                       const Resolution& resolution) {
  const auto shape = std::make_shared<const TableShape>(law.shape_exponent, resolution.steps);
  return [&model, law, shape](const Drive& drive, std::span<double> force) {
    models::EvaluatePath(model, law, 0.0, *shape, MakeDrivePath(model, drive), drive.displacement,
                         force);
  };
}

Evaluator MakeDopri5(const FrictionModel& model, const BranchLaw& law, const Resolution& resolution,
                     double* cost) {
  return [&model, law, steps = AdaptiveSteps{law.shape_exponent, resolution, cost}](
             const Drive& drive, std::span<double> force) {
    const LoadingPath path = MakeDrivePath(model, drive);
    BranchFollower follower(model, law, path, steps);
    const double limit = path.limit();
    for (const models::BranchRun& run : path.runs) {
      for (std::size_t i = run.begin; i < run.end; ++i) {
        const double t =
            follower.MoveTo(static_cast<std::size_t>(run.branch), drive.displacement[i]);
        force[i] = law.slip_force * std::clamp(t, -limit, limit);
      }
    }
  };
}

}  // namespace mindahl::methods
