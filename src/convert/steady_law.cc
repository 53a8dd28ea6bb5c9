#include "mindahl/convert/steady_law.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>
#include <ranges>

#include "convert/bouc_wen_shape.h"
#include "mindahl/core/error.h"
#include "mindahl/models/steady_loop.h"

namespace mindahl::convert {

using methods::IwanElements;
using models::BranchLaw;

namespace {

void RequireBoucWen(const BoucWenLaw& law) {
  constexpr double kLargestExponent = 20.0;
  RequirePositive("Bouc-Wen stiffness [N/m]", law.stiffness);
  RequirePositive("Bouc-Wen slip force [N]", law.slip_force);
  if (!(law.exponent >= 1 && law.exponent <= kLargestExponent)) {
    ThrowInvalid("Bouc-Wen exponent [-]", law.exponent, "must be in 1 … 20");
  }
  if (!(law.beta > 0 && law.beta <= 1)) {
    ThrowInvalid("Bouc-Wen beta [-]", law.beta, "must be in (0, 1]");
  }
}

/// The virgin curve of elements: a polygon that bends where one slips.
class VirginPolygon {
 public:
  explicit VirginPolygon(const IwanElements& elements) {
    for (std::size_t j = 0; j < elements.size(); ++j) {
      if (elements.slip_force[j] == 0) continue;
      corners_.push_back({.at = elements.slip_force[j] / elements.stiffness[j],
                          .stiffness = elements.stiffness[j],
                          .slip_force = elements.slip_force[j]});
    }
    std::ranges::sort(corners_, {}, &Corner::at);
    double slipped = 0.0;
    for (Corner& corner : corners_) corner.slip_force = slipped += corner.slip_force;
    double stiffness = 0.0;
    for (Corner& corner : std::views::reverse(corners_)) {
      corner.stiffness = stiffness += corner.stiffness;
    }
  }

  double operator()(double x) const {
    const auto next = std::ranges::upper_bound(corners_, x, {}, &Corner::at);
    return (next == corners_.begin() ? 0.0 : std::prev(next)->slip_force) +
           (next == corners_.end() ? 0.0 : next->stiffness * x);
  }

 private:
  struct Corner {
    double at;          // [m]
    double stiffness;   // of all that slip here or later
    double slip_force;  // of all that slip here or before
  };
  std::vector<Corner> corners_;
};

/// A model's rising branch, T = f(d) − T*.
struct ModelBranch {
  double peak;     // T*
  BranchLaw from;  // f: the law of a virgin curve

  ModelBranch(const ModelLaw& of, double amplitude)
      : peak(models::SteadyPeakForce(*of.model, of.law, amplitude)) {
    const double share = peak / of.law.slip_force;
    const models::BranchScale scale = of.model->scale(-share, share, /*virgin=*/false);
    // t(x) = t₀ + span·v·φ(k·x): the branch law of the stiffness σ·v^α with the limit span·v·Tc.
    from = {.tangential_stiffness =
                of.law.tangential_stiffness * std::pow(scale.remaining, of.law.shape_exponent),
            .shape_exponent = of.law.shape_exponent,
            .slip_force = of.law.slip_force * scale.span * scale.remaining};
  }
};

struct Rising {
  double amplitude;
  std::span<const double> distance;
  std::span<double> force;

  void operator()(const ModelLaw& of) const {
    const ModelBranch branch(of, amplitude);
    for (std::size_t i = 0; i < distance.size(); ++i) {
      force[i] = models::BackboneForce(branch.from, distance[i]) - branch.peak;
    }
  }

  void operator()(const BoucWenLaw& law) const {
    RequireBoucWen(law);
    const BoucWenShape shape(law.exponent, law.beta);
    const double rate = law.stiffness / law.slip_force;
    const BoucWenShape::Loop loop = shape.LoopOf(rate * amplitude);
    for (std::size_t i = 0; i < distance.size(); ++i) {
      force[i] = law.slip_force * shape.Rising(loop, rate * distance[i]);
    }
  }

  void operator()(const IwanElements& elements) const {
    const VirginPolygon virgin(elements);
    const double peak = virgin(amplitude);
    for (std::size_t i = 0; i < distance.size(); ++i) {
      force[i] = 2 * virgin(distance[i] / 2) - peak;
    }
  }
};

/// Distances at which a rising branch bends.
struct Corners {
  double amplitude;
  std::vector<double>& distance;

  void operator()(const ModelLaw& of) const {
    distance.push_back(models::GrossSlipDisplacement(ModelBranch(of, amplitude).from));
  }
  void operator()(const BoucWenLaw& /*law*/) const {}
  void operator()(const IwanElements& elements) const {
    for (std::size_t j = 0; j < elements.size(); ++j) {
      distance.push_back(2 * elements.slip_force[j] / elements.stiffness[j]);
    }
  }
};

/// Returns the distances at which two branches are compared: densest after the reversal, at every
/// corner, and in the middle between any two of these.
std::vector<double> PlacesToCompare(const SteadyLaw& law, const SteadyLaw& reference,
                                    double amplitude) {
  constexpr int kIntervals = 64;
  constexpr double kGrowth = 8.0;  // of the spacing, as an exponent
  std::vector<double> corners;
  for (int i = 0; i <= kIntervals; ++i) {
    const double share = static_cast<double>(i) / kIntervals;
    corners.push_back(2 * amplitude * (std::expm1(kGrowth * share) / std::expm1(kGrowth)));
  }
  std::visit(Corners{amplitude, corners}, law);
  std::visit(Corners{amplitude, corners}, reference);
  std::erase_if(corners, [&](double distance) { return !(distance <= 2 * amplitude); });
  std::ranges::sort(corners);
  std::vector<double> places = {corners.front()};
  for (std::size_t i = 1; i < corners.size(); ++i) {
    places.push_back(std::midpoint(corners[i - 1], corners[i]));
    places.push_back(corners[i]);
  }
  return places;
}

std::vector<double> Differences(const SteadyLaw& law, const SteadyLaw& reference, double amplitude,
                                std::span<const double> distance) {
  std::vector<double> difference(distance.size());
  std::vector<double> expected(distance.size());
  EvaluateRisingBranch(law, amplitude, distance, difference);
  EvaluateRisingBranch(reference, amplitude, distance, expected);
  for (std::size_t i = 0; i < difference.size(); ++i) {
    difference[i] = std::abs(difference[i] - expected[i]);
  }
  return difference;
}

/// Returns the largest difference of force [N] at some places, or next to the largest of these.
double LargestDifference(const SteadyLaw& law, const SteadyLaw& reference, double amplitude) {
  const std::vector<double> places = PlacesToCompare(law, reference, amplitude);
  const std::vector<double> difference = Differences(law, reference, amplitude, places);
  const auto largest = static_cast<std::size_t>(
      std::distance(difference.begin(), std::ranges::max_element(difference)));
  constexpr std::size_t kFiner = 128;
  const double from = places[largest == 0 ? 0 : largest - 1];
  const double to = places[std::min(largest + 1, places.size() - 1)];
  std::vector<double> beside(kFiner + 1);
  for (std::size_t i = 0; i <= kFiner; ++i) {
    beside[i] = std::lerp(from, to, static_cast<double>(i) / kFiner);
  }
  return std::max(difference[largest],
                  std::ranges::max(Differences(law, reference, amplitude, beside)));
}

struct Energy {
  double amplitude;

  double operator()(const ModelLaw& of) const {
    return models::SteadyLoopEnergy(*of.model, of.law, amplitude);
  }
  double operator()(const BoucWenLaw& law) const {
    RequireBoucWen(law);
    const BoucWenShape shape(law.exponent, law.beta);
    return law.slip_force * law.slip_force / law.stiffness *
           shape.Energy(law.stiffness / law.slip_force * amplitude);
  }
  double operator()(const IwanElements& elements) const {
    double energy = 0.0;
    for (std::size_t j = 0; j < elements.size(); ++j) {
      const double stick = elements.slip_force[j] / elements.stiffness[j];
      energy += 4 * elements.slip_force[j] * std::max(amplitude - stick, 0.0);
    }
    return energy;
  }
};

}  // namespace

void EvaluateRisingBranch(const SteadyLaw& law, double amplitude, std::span<const double> distance,
                          std::span<double> force) {
  RequirePositive("amplitude [m]", amplitude);
  RequireSameSize("distance", distance.size(), "force", force.size());
  std::visit(Rising{amplitude, distance, force}, law);
}

double LoopEnergy(const SteadyLaw& law, double amplitude) {
  RequirePositive("amplitude [m]", amplitude);
  return std::visit(Energy{amplitude}, law);
}

LoopError CompareLoops(const SteadyLaw& law, const SteadyLaw& reference, double amplitude) {
  RequirePositive("amplitude [m]", amplitude);
  double peak = 0.0;
  EvaluateRisingBranch(reference, amplitude, std::array{2 * amplitude}, std::span(&peak, 1));
  LoopError error;
  error.force = LargestDifference(law, reference, amplitude) / peak;
  const double energy = LoopEnergy(law, amplitude);
  const double lost = LoopEnergy(reference, amplitude);
  error.energy = lost > 0      ? energy / lost - 1
                 : energy == 0 ? 0.0
                               : std::numeric_limits<double>::infinity();
  return error;
}

}  // namespace mindahl::convert
