#include "mindahl/models/variable_load.h"

#include <fmt/format.h>

#include <cmath>
#include <cstddef>
#include <string_view>

#include "mindahl/core/error.h"
#include "mindahl/models/loading_path.h"
#include "models/load_zones.h"
#include "models/requirements.h"

namespace mindahl::models {

BranchLaw ReferenceLaw(const LoadDependentLaw& law) {
  return {law.reference_stiffness, law.shape_exponent,
          law.friction_coefficient * law.reference_load};
}

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
                 "must be <= 1e100 m");
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
    : law_(law) {
  Validate(law);
  RequireWithinReach("unloaded displacement [m]", initial.unloaded_displacement);
  reference_slip_displacement_ = GrossSlipDisplacement(ReferenceLaw(law));
  StartUnloaded(RimUnder(initial.normal_load), initial.unloaded_displacement, contact_);
  normal_load_ = initial.normal_load;
}

double LoadedContactState::Move(double displacement, double normal_load) {
  RequireWithinReach("displacement [m]", displacement);
  const LoadRim<double> rim = RimUnder(normal_load);
  backbone::WithShape(law_.shape_exponent, [&](const auto& shape) {
    MoveTo(rim, displacement, ShareOfWidth{shape, law_.shape_exponent}, contact_);
  });
  normal_load_ = normal_load;
  return contact_.force;
}

/// Returns Tc = μN, δc = δc(N_ref)·(N/N_ref)^{1−α}.
LoadRim<double> LoadedContactState::RimUnder(double normal_load) const {
  constexpr std::string_view kQuantity = "normal load [N]";
  if (normal_load == normal_load_) return contact_.rim;
  RequireNonNegative(kQuantity, normal_load);
  const double load_ratio = normal_load / law_.reference_load;
  const double root = std::cbrt(load_ratio);
  const double growth =
      law_.shape_exponent == 1.0 / 3 ? root * root : std::pow(load_ratio, 1 - law_.shape_exponent);
  const LoadRim<double> rim{reference_slip_displacement_ * growth,
                            law_.friction_coefficient * normal_load};
  if (!(rim.slip_displacement <= kLargestPathDisplacement && std::isfinite(rim.slip_force))) {
    ThrowInvalid(kQuantity, normal_load,
                 "must keep the slip force finite and its displacement <= 1e100 m");
  }
  return rim;
}

}  // namespace mindahl::models
