#include "mindahl/models/loaded_contact_state.h"

#include <algorithm>
#include <cmath>

#include "mindahl/core/error.h"
#include "models/slip_at_load.h"
#include "models/within_reach.h"

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
  if (rim_.slip_displacement > 0) zones_.push_back({.intercept = displacement_});
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
  return {normal_load, slip.displacement, slip.force};
}

/// Straight in (δ, δc) from the present displacement and rim; the zones are those to be changed. If
/// adding a zone runs out of memory none has been dropped.
template <typename Zones>
double LoadedContactState::StepTo(Zones& zones, const Rim& rim, double displacement) const {
  if (rim.slip_displacement == 0) {
    zones.clear();
    return 0.0;
  }
  const double travel = displacement - displacement_;
  const double widening = rim.slip_displacement - rim_.slip_displacement;
  double force = force_;
  if (widening < 0) {
    // What a falling load lifts off is forgotten.
    while (zones.back().inner >= rim.slip_displacement) zones.pop_back();
    force =
        Slip(zones, rim, displacement, displacement - zones.back().RestAt(rim.slip_displacement));
  } else if (widening < std::abs(travel)) {
    force = Slip(zones, rim, displacement, travel);
  } else if (widening > 0) {
    force = Widen(zones, rim, travel / widening);
  }
  return std::clamp(force, -rim.slip_force, rim.slip_force);
}

/// The load rises faster than anything can slip: elements come into contact at the rim, each
/// resting where δ is when it does. On the line of those before it makes no zone of its own.
template <typename Zones>
double LoadedContactState::Widen(Zones& zones, const Rim& rim, double slope) const {
  const double intercept = displacement_ - slope * rim_.slip_displacement;
  const bool goes_on =
      !zones.empty() && zones.back().slope == slope && zones.back().intercept == intercept;
  if (!goes_on) {
    zones.push_back({rim_.slip_displacement, slope, intercept, force_, rim_.slip_force});
  }
  return force_ + slope * (rim.slip_force - rim_.slip_force);
}

/// An annulus slips to the rest positions δ − s·(δc − h), s the sign of `stretch`, which is δ − r
/// at the rim. As |r'| <= 1, what slips is outside of what sticks.
template <typename Zones>
double LoadedContactState::Slip(Zones& zones, const Rim& rim, double displacement,
                                double stretch) const {
  const double s = std::copysign(1.0, stretch);
  const double intercept = displacement - s * rim.slip_displacement;
  while (!zones.empty()) {
    const Zone& stuck = zones.back();
    // What the rim exceeds its slip limit by, and how fast that falls inward.
    const double excess = std::max(s * (displacement - stuck.RestAt(rim.slip_displacement)), 0.0);
    const double rate = 1 - s * stuck.slope;
    if (excess < rate * (rim.slip_displacement - stuck.inner)) {
      const double width = excess / rate;
      const double share = Share(width / (rim.slip_displacement * (1 - law_.shape_exponent)));
      const double stuck_slip_force = rim.slip_force * (1 - share);
      const double stuck_force = stuck.force + stuck.slope * (stuck_slip_force - stuck.slip_force);
      zones.push_back({rim.slip_displacement - width, s, intercept, stuck_force, stuck_slip_force});
      return stuck_force + s * rim.slip_force * share;
    }
    zones.pop_back();
  }
  zones.push_back({.slope = s, .intercept = intercept});
  return s * rim.slip_force;
}

/// φ(y)
double LoadedContactState::Share(double y) const {
  return std::visit([y](const auto& shape) { return shape.Force(y); }, shape_);
}

}  // namespace mindahl::models
