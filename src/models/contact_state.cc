#include "mindahl/models/contact_state.h"

#include <cstdint>

#include "models/madelung.h"
#include "models/scaled_branches.h"

namespace mindahl::models {

ContactState::ContactState(const FrictionModel& model, const BranchLaw& law,
                           const ContactStateOptions& options)
    : model_(&model),
      law_(law),
      unloaded_displacement_(options.unloaded_displacement),
      rig_(options.rig) {
  Validate(law);
  RequireWithinReach("unloaded displacement [m]", unloaded_displacement_);
  Reset();
}

void ContactState::Reset() {
  suspended_.clear();
  displacement_ = unloaded_displacement_;
  force_over_slip_ = 0.0;
  course_ = {};
  course_.branch = Open({.origin = unloaded_displacement_, .start = BranchStart::kUnloaded}, 0.0);
  course_.shape = ShapeOn(course_.branch);
}

ScaledBranch ContactState::Open(const Branch& branch, double origin_force) const {
  return BranchScaling(*model_, Normalized(law_, rig_)).Start(branch, origin_force);
}

ContactState::Shape ContactState::ShapeOn(const ScaledBranch& branch) const {
  Shape on_branch;
  WithShapeBehindSpring(Normalized(law_, rig_), [&](const auto& shape) {
    on_branch.kind = models::ShapeOn(shape, branch);
  });
  return on_branch;
}

ContactState::Course ContactState::Enter(double displacement) const {
  RequireWithinReach("displacement [m]", displacement);
  const double direction = displacement > displacement_   ? 1.0
                           : displacement < displacement_ ? -1.0
                                                          : course_.direction;
  const bool reverses = direction * course_.direction < 0;
  const ScaledBranch present =
      reverses ? Open({.origin = displacement_, .direction = static_cast<std::int8_t>(direction)},
                      force_over_slip_)
               : course_.branch;
  Course next{.branch = present,
              .direction = direction,
              .end = direction == 0 ? 0.0 : kLargestPathDisplacement};
  if (model_->memory == Memory::kReturnPoint) {
    const auto branch_of = [&](std::size_t i) -> const ScaledBranch& {
      return i < suspended_.size() ? suspended_[i] : i < course_.open ? course_.branch : present;
    };
    const auto origin_of = [&](std::size_t i) { return branch_of(i).origin; };
    next.open = StillOpen(course_.open + (reverses ? 1 : 0), origin_of, direction, displacement);
    next.branch = branch_of(next.open - 1);
    if (next.open >= 2) {
      next.end = std::min(next.end, direction * ClosingDisplacement(next.open, origin_of));
    }
  }
  next.shape = ShapeOn(next.branch);
  next.start = direction * next.branch.origin;
  next.rise = direction * next.branch.height;
  return next;
}

void ContactState::Turn(double displacement) {
  const Course next = Enter(displacement);
  if (next.open > course_.open) {
    suspended_.push_back(course_.branch);
  } else {
    suspended_.resize(next.open - 1);
  }
  course_ = next;
}

double ContactState::Shape::TranscendentalForce(double y) const {
  return std::visit([y](const auto& shape) { return shape.Force(y); }, kind);
}

double ContactState::TangentStiffness() const {
  const double y = course_.Reduced(displacement_);
  const double slope =
      std::visit([y](const auto& shape) { return shape.Slope(y); }, course_.shape.kind);
  return law_.slip_force * (course_.branch.height * course_.branch.rate * slope);
}

}  // namespace mindahl::models
