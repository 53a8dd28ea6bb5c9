#include "mindahl/models/loaded_contact_state.h"

#include "mindahl/core/error.h"
#include "models/load_zones.h"
#include "models/requirements.h"

namespace mindahl::models {

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
