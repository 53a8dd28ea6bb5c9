#include "methods/tabulated.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "methods/path_operations.h"
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

}  // namespace mindahl::methods
