#include "mindahl/models/contact_state.h"

#include <cstdint>

#include "mindahl/core/error.h"
#include "models/madelung.h"
#include "models/requirements.h"
#include "models/scaled_branches.h"

namespace mindahl::models {

ContactState::ContactState(const FrictionModel& model, const BranchLaw& law,
                           const ContactStateOptions& options)
    : model_(&model), law_(law), unloaded_displacement_(options.unloaded_displacement) {
  Validate(law);
  RequireWithinReach("unloaded displacement [m]", unloaded_displacement_);
  spring_travel_ = SpringTravel(law, options.rig);
  Reset();
}

void ContactState::Reset() {
  suspended_.clear();
  displacement_ = unloaded_displacement_;
  force_over_slip_ = 0.0;
  course_ = {};
  course_.branch = Open({.origin = unloaded_displacement_, .start = BranchStart::kUnloaded}, 0.0);
  shape_ = ShapeOn(course_.branch);
}

ScaledBranch ContactState::Open(const Branch& branch, double origin_force) const {
  return BranchScaling(*model_, law_, spring_travel_).Start(branch, origin_force);
}

ContactState::Shape ContactState::ShapeOn(const ScaledBranch& branch) const {
  if (spring_travel_ > 0) {
    return models::ShapeOn(SprungShape{law_.shape_exponent, spring_travel_}, branch);
  }
  return backbone::WithShape(law_.shape_exponent,
                             [](const auto& contact) -> Shape { return contact; });
}

ContactState::Entry ContactState::Enter(double displacement) const {
  RequireWithinReach("displacement [m]", displacement);
  const double direction = displacement > displacement_   ? 1.0
                           : displacement < displacement_ ? -1.0
                                                          : course_.direction;
  const bool reverses = direction * course_.direction < 0;
  const std::size_t open_before = suspended_.size() + 1;
  const auto open_from_here = [&] {
    return Open({.origin = displacement_, .direction = static_cast<std::int8_t>(direction)},
                force_over_slip_);
  };
  Entry entry;
  Course& course = entry.course;
  double end = direction == 0 ? 0.0 : kLargestPathDisplacement;
  if (model_->memory == Memory::kNone) {
    course.branch = reverses ? open_from_here() : course_.branch;
  } else {
    const auto origin_of = [&](std::size_t i) {
      return i + 1 < open_before ? suspended_[i].origin
             : i < open_before   ? course_.branch.origin
                                 : displacement_;
    };
    entry.open = StillOpen(open_before + (reverses ? 1 : 0), origin_of, direction, displacement);
    course.branch = entry.open > open_before    ? open_from_here()
                    : entry.open == open_before ? course_.branch
                                                : suspended_[entry.open - 1];
    if (entry.open >= 2) {
      end = std::min(end, direction * ClosingDisplacement(entry.open, origin_of));
    }
  }
  course.direction = direction;
  course.start = direction * course.branch.origin;
  course.end = end;
  course.rise = direction * course.branch.height;
  return entry;
}

void ContactState::Turn(double displacement) {
  const Entry entry = Enter(displacement);
  if (spring_travel_ > 0) shape_ = ShapeOn(entry.course.branch);
  if (entry.open > suspended_.size() + 1) {
    suspended_.push_back(course_.branch);
  } else {
    suspended_.resize(entry.open - 1);
  }
  course_ = entry.course;
}

double ContactState::PeekAcrossBranches(double displacement) const {
  const Course course = Enter(displacement).course;
  const Shape& shape = spring_travel_ > 0 ? ShapeOn(course.branch) : shape_;
  return Force(course.ForceOverSlip(shape, displacement));
}

double ContactState::TranscendentalShare(const Shape& shape, double y) {
  return std::visit([y](const auto& on) { return on.Force(y); }, shape);
}

double ContactState::TangentStiffness() const {
  const double y = course_.Reduced(displacement_);
  const double slope = std::visit([y](const auto& on) { return on.Slope(y); }, shape_);
  return law_.slip_force * (course_.branch.height * course_.branch.rate * slope);
}

}  // namespace mindahl::models
