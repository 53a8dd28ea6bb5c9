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

namespace {

/// @throws InvalidArgument naming the first sample that is no step of a contact
void RequireSamples(const LoadDependentLaw& law, std::span<const double> displacement,
                    std::span<const double> normal_load) {
  const double reference = models::ReferenceSlipDisplacement(law);
  double largest_load = 0.0;
  for (std::size_t i = 0; i < displacement.size(); ++i) {
    if (!models::IsWithinReach(displacement[i])) {
      models::RequireWithinReach(fmt::format("displacement [m] of sample {}", i), displacement[i]);
    }
    // All reasons to refuse a load but its sign grow with it.
    if (normal_load[i] >= 0 && normal_load[i] <= largest_load) continue;
    const models::SlipAtLoad slip = models::SlipUnder(law, reference, normal_load[i]);
    if (!slip.IsInRange() || !(normal_load[i] >= 0)) {
      models::RequireLoad(fmt::format("normal load [N] of sample {}", i), normal_load[i], slip);
    }
    largest_load = normal_load[i];
  }
}

}  // namespace

void Validate(const LoadDependentLaw& law) {
  RequirePositive("friction coefficient [-]", law.friction_coefficient);
  RequirePositive("reference load [N]", law.reference_load);
  RequirePositive("reference stiffness [N/m]", law.reference_stiffness);
  RequireNonNegative("shape exponent [-]", law.shape_exponent);
  if (law.shape_exponent >= 1) {
    ThrowInvalid("shape exponent [-]", law.shape_exponent,
                 "must be < 1 under a varying load: slip is complete at a finite displacement");
  }
  const BranchLaw reference = models::ReferenceLaw(law);
  Validate(reference);
  const double slip_displacement = GrossSlipDisplacement(reference);
  if (!(slip_displacement <= kLargestPathDisplacement)) {
    ThrowInvalid("gross-slip displacement [m] at the reference load", slip_displacement,
                 "must be <= 1e307 m");
  }
}

BranchLaw BranchLawAtLoad(const LoadDependentLaw& law, double normal_load) {
  Validate(law);
  RequirePositive("normal load [N]", normal_load);
  const double load_ratio = normal_load / law.reference_load;
  const double growth = law.shape_exponent == 1.0 / 3 ? std::cbrt(load_ratio)
                                                      : std::pow(load_ratio, law.shape_exponent);
  const BranchLaw at_load{law.reference_stiffness * growth, law.shape_exponent,
                          law.friction_coefficient * normal_load};
  Validate(at_load);
  return at_load;
}

void EvaluateForceUnderLoad(const LoadDependentLaw& law, std::span<const double> displacement,
                            std::span<const double> normal_load, std::span<double> force) {
  Validate(law);
  RequireSameSize("displacement", displacement.size(), "normal load", normal_load.size());
  RequireSameSize("displacement", displacement.size(), "force", force.size());
  if (displacement.empty()) return;
  RequireSamples(law, displacement, normal_load);
  models::LoadedContactState contact(law, {.normal_load = normal_load.front()});
  for (std::size_t i = 0; i < displacement.size(); ++i) {
    force[i] = contact.Move(displacement[i], normal_load[i]);
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

/// The zones as a trial step sees them: it drops some, and what it adds is not asked for.
class LoadedContactState::TrialZones {
 public:
  explicit TrialZones(const std::vector<Zone>& zones) : zones_(zones), size_(zones.size()) {}

  [[nodiscard]] bool empty() const { return size_ == 0; }
  [[nodiscard]] const Zone& back() const { return zones_[size_ - 1]; }
  void pop_back() { --size_; }
  void clear() { size_ = 0; }
  void push_back(const Zone& /*zone*/) {}

 private:
  const std::vector<Zone>& zones_;
  std::size_t size_;
};

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
  TrialZones zones(zones_);
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
template <typename Zones>
double LoadedContactState::StepTo(Zones& zones, const Rim& rim, double displacement) const {
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
