#include "mindahl/models/variable_load.h"

#include <fmt/format.h>

#include <cmath>
#include <cstddef>
#include <string>

#include "mindahl/core/error.h"
#include "mindahl/models/loading_path.h"
#include "models/load_zones.h"
#include "models/requirements.h"

namespace mindahl::models {

void Validate(const LoadDependentLaw& law) {
  RequirePositive("friction coefficient [-]", law.friction_coefficient);
  RequirePositive("reference load [N]", law.reference_load);
  RequirePositive("reference stiffness [N/m]", law.reference_stiffness);
  RequireNonNegative("shape exponent [-]", law.shape_exponent);
  if (law.shape_exponent >= 1) {
    ThrowInvalid("shape exponent [-]", law.shape_exponent,
                 "must be < 1 under a varying load: slip is complete at a finite displacement");
  }
  const BranchLaw reference = ReferenceLaw(law);
  Validate(reference);
  const double slip_displacement = GrossSlipDisplacement(reference);
  if (!(slip_displacement <= kLargestPathDisplacement)) {
    ThrowInvalid("gross-slip displacement [m] at the reference load", slip_displacement,
                 "must be <= 1e307 m");
  }
}

void EvaluateForceUnderLoad(const LoadDependentLaw& law, std::span<const double> displacement,
                            std::span<const double> normal_load, std::span<double> force) {
  Validate(law);
  RequireSameSize("displacement", displacement.size(), "normal load", normal_load.size());
  RequireSameSize("displacement", displacement.size(), "force", force.size());
  if (displacement.empty()) return;
  std::size_t i = 0;
  try {
    LoadedContactState contact(law, {.normal_load = normal_load.front()});
    for (; i < displacement.size(); ++i) force[i] = contact.Move(displacement[i], normal_load[i]);
  } catch (const InvalidArgument& refusal) {
    throw InvalidArgument(fmt::format("sample {}: {}", i, refusal.what()));
  }
}

LoadedContactState::LoadedContactState(const LoadDependentLaw& law, const InitialLoading& initial)
    : law_(law), initial_(initial) {
  Validate(law);
  RequireWithinReach("unloaded displacement [m]", initial.unloaded_displacement);
  reference_slip_displacement_ = ReferenceSlipDisplacement(law);
  shape_ = backbone::WithShape(law.shape_exponent,
                               [](const auto& shape) -> decltype(shape_) { return shape; });
  Reset();
}

void LoadedContactState::Reset() {
  rim_ = RimUnder(initial_.normal_load);
  displacement_ = initial_.unloaded_displacement;
  force_ = 0.0;
  zones_.clear();
  if (rim_.at.slip_displacement > 0) zones_.push_back({.intercept = displacement_});
}

double LoadedContactState::Move(double displacement, double normal_load) {
  RequireWithinReach("displacement [m]", displacement);
  const Rim rim = RimUnder(normal_load);
  force_ = StepTo(zones_, rim, displacement);
  rim_ = rim;
  displacement_ = displacement;
  return force_;
}

double LoadedContactState::Peek(double displacement, double normal_load) const {
  RequireWithinReach("displacement [m]", displacement);
  std::vector<Zone> zones = zones_;
  return StepTo(zones, RimUnder(normal_load), displacement);
}

LoadedContactState::Rim LoadedContactState::RimUnder(double normal_load) const {
  if (normal_load == rim_.normal_load) return rim_;
  const SlipAtLoad slip = SlipUnder(law_, reference_slip_displacement_, normal_load);
  RequireLoad("normal load [N]", normal_load, slip);
  return {normal_load, {slip.displacement, slip.force}};
}

/// Steps straight in (δ, δc) from the present displacement and rim; the zones are those to be
/// changed. If adding a zone runs out of memory none has been dropped.
double LoadedContactState::StepTo(std::vector<Zone>& zones, const Rim& rim,
                                  double displacement) const {
  const auto share = [this](double width, double slip_displacement) {
    const double y = width / (slip_displacement * (1 - law_.shape_exponent));
    return std::visit([y](const auto& shape) { return shape.Force(y); }, shape_);
  };
  return TakeLoadStep(LoadStep<double>{.from = rim_.at,
                                       .to = rim.at,
                                       .from_displacement = displacement_,
                                       .displacement = displacement,
                                       .force = force_},
                      share, zones);
}

}  // namespace mindahl::models
