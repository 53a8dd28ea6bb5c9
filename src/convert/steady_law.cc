#include "mindahl/convert/steady_law.h"

#include <algorithm>
#include <array>
#include <boost/math/tools/minima.hpp>
#include <boost/math/tools/toms748_solve.hpp>
#include <boost/numeric/odeint/stepper/controlled_runge_kutta.hpp>
#include <boost/numeric/odeint/stepper/generation.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_dopri5.hpp>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <utility>

#include "mindahl/core/error.h"
#include "mindahl/models/steady_loop.h"

namespace mindahl::convert {

using methods::IwanElements;
using models::BranchLaw;

namespace {

constexpr double kLargestExponent = 20.0;

/// Returns where a function changes its sign between two places.
template <typename Function>
double Solve(const Function& function, double low, double high) {
  constexpr int kBits = 48;
  std::uintmax_t iterations = 200;
  const auto [from, to] = boost::math::tools::toms748_solve(
      function, low, high, boost::math::tools::eps_tolerance<double>(kBits), iterations);
  return std::midpoint(from, to);
}

/// A rising branch of Bouc's and Wen's law over y = kx/Tc, t = T/Tc, which has no closed form.
struct BoucWenBranch {
  static constexpr double kTolerance = 1e-12;

  double exponent;
  double force;       // t
  double work = 0.0;  // ∫t dy since the branch's start
  double y = 0.0;

  /// Follows it up to a y.
  void RiseTo(double end) {
    namespace odeint = boost::numeric::odeint;
    using Values = std::array<double, 2>;
    auto stepper =
        odeint::make_controlled<odeint::runge_kutta_dopri5<Values>>(kTolerance, kTolerance);
    Values values = {force, work};
    const auto rate = [&](const Values& at, Values& derivative, double /*y*/) {
      derivative = {1 - std::pow(std::clamp(at[0], 0.0, 1.0), exponent), at[0]};
    };
    double h = end - y;
    while (y < end && values[0] < 1 - kTolerance) {
      h = std::min(h, end - y);
      if (y + h <= y) break;
      stepper.try_step(rate, values, y, h);
    }
    // From there on it slides.
    force = values[0];
    work = values[1] + values[0] * std::max(end - y, 0.0);
    y = end;
  }
};

/// Returns the peak of the steady loop between ±y: a branch from −t* ends at t*.
double PeakOf(double exponent, double y) {
  const auto excess = [&](double peak) {
    BoucWenBranch branch{exponent, -peak};
    branch.RiseTo(2 * y);
    return branch.force - peak;
  };
  return excess(1.0) > -2 * BoucWenBranch::kTolerance ? 1.0 : Solve(excess, 0.0, 1.0);
}

SteadyLoop LoopOf(const ModelLaw& of, double amplitude) {
  const double peak = models::SteadyPeakForce(*of.model, of.law, amplitude);
  const double share = peak / of.law.slip_force;
  const models::BranchScale scale = of.model->scale(-share, /*virgin=*/false);
  // t(x) = t₀ + span·v·φ(k·x): the branch law of the stiffness σ·v^α with the limit span·v·Tc.
  const BranchLaw branch = {
      .tangential_stiffness =
          of.law.tangential_stiffness * std::pow(scale.remaining, of.law.shape_exponent),
      .shape_exponent = of.law.shape_exponent,
      .slip_force = of.law.slip_force * scale.span * scale.remaining};
  return {peak,
          models::SteadyLoopEnergy(*of.model, of.law, amplitude),
          {models::GrossSlipDisplacement(branch)},
          [=](double distance) { return models::BackboneForce(branch, distance) - peak; }};
}

SteadyLoop LoopOf(const BoucWenLaw& law, double amplitude) {
  const double per_travel = law.stiffness / law.slip_force;
  const BoucWenBranch start{law.exponent, -PeakOf(law.exponent, per_travel * amplitude)};
  BoucWenBranch end = start;
  end.RiseTo(2 * per_travel * amplitude);
  return {-law.slip_force * start.force,
          law.slip_force / per_travel * 2 * end.work,
          {},
          [=, at = start](double distance) mutable {
            at.RiseTo(per_travel * distance);
            return law.slip_force * at.force;
          }};
}

/// Returns the force of Jenkins elements on their virgin curve, a polygon.
double VirginForce(const IwanElements& elements, double displacement) {
  double force = 0.0;
  for (std::size_t j = 0; j < elements.size(); ++j) {
    force += std::min(elements.stiffness[j] * displacement, elements.slip_force[j]);
  }
  return force;
}

SteadyLoop LoopOf(const IwanElements& elements, double amplitude) {
  SteadyLoop loop{
      .peak = VirginForce(elements, amplitude), .energy = 0.0, .corners = {}, .force = {}};
  for (std::size_t j = 0; j < elements.size(); ++j) {
    const double corner = elements.slip_force[j] / elements.stiffness[j];
    loop.energy += 4 * elements.slip_force[j] * std::max(amplitude - corner, 0.0);
    loop.corners.push_back(2 * corner);
  }
  loop.force = [elements, peak = loop.peak](double distance) {
    return 2 * VirginForce(elements, distance / 2) - peak;
  };
  return loop;
}

/// Returns the stiffness and the slip force with which a law has a contact's peak force and energy
/// at an amplitude.
/// @param unit  the law with a stiffness and a slip force of 1
std::pair<double, double> ScalesOf(const ModelLaw& contact, double amplitude,
                                   const SteadyLaw& unit) {
  const SteadyLoop wanted = LoopOf(contact, amplitude);
  const double wanted_peak = wanted.force(2 * amplitude);
  const double fullness = wanted.energy / (4 * amplitude * wanted_peak);
  // W/(4·y·t*) grows from 0 for a loop that sticks to 1 for one that slides.
  const auto excess = [&](double log_y) {
    const double y = std::exp(log_y);
    const SteadyLoop loop = LoopOf(unit, y);
    return loop.energy / (4 * y * loop.peak) - fullness;
  };
  double log_y = std::log(1e-3);
  const double high = std::log(1e12);
  if (excess(log_y) < 0) log_y = excess(high) > 0 ? Solve(excess, log_y, high) : high;
  const double y = std::exp(log_y);
  const double slip_force = wanted_peak / LoopOf(unit, y).peak;
  return {y * slip_force / amplitude, slip_force};
}

}  // namespace

SteadyLoop LoopOf(const SteadyLaw& law, double amplitude) {
  RequirePositive("amplitude [m]", amplitude);
  return std::visit([&](const auto& of) { return LoopOf(of, amplitude); }, law);
}

LoopError CompareLoops(const SteadyLaw& law, const SteadyLaw& reference, double amplitude) {
  constexpr int kPlaces = 512;
  const SteadyLoop loop = LoopOf(law, amplitude);
  const SteadyLoop expected = LoopOf(reference, amplitude);
  std::vector<double> distance = loop.corners;
  distance.insert(distance.end(), expected.corners.begin(), expected.corners.end());
  std::erase_if(distance, [&](double at) { return !(at < 2 * amplitude); });
  for (int i = 0; i <= kPlaces; ++i) {
    distance.push_back(2 * amplitude * std::pow(static_cast<double>(i) / kPlaces, 3));
  }
  std::ranges::sort(distance);
  double largest = 0.0;
  double peak = 0.0;
  for (const double at : distance) {
    peak = expected.force(at);
    largest = std::max(largest, std::abs(loop.force(at) - peak));
  }
  return {.force = largest / peak,
          .energy = expected.energy > 0 ? loop.energy / expected.energy - 1
                    : loop.energy == 0  ? 0.0
                                        : std::numeric_limits<double>::infinity()};
}

BranchLaw SamePeakAndEnergy(const ModelLaw& contact, double amplitude,
                            const models::FrictionModel& model, double shape_exponent) {
  const auto [stiffness, slip_force] =
      ScalesOf(contact, amplitude, ModelLaw{&model, {1.0, shape_exponent, 1.0}});
  return {stiffness, shape_exponent, slip_force};
}

BoucWenLaw BoucWenOf(const ModelLaw& contact, double amplitude) {
  const auto law_of = [&](double exponent) {
    const auto [stiffness, slip_force] =
        ScalesOf(contact, amplitude, BoucWenLaw{1.0, 1.0, exponent});
    return BoucWenLaw{stiffness, slip_force, exponent};
  };
  constexpr int kBits = 20;
  const auto difference = [&](double log_exponent) {
    return CompareLoops(law_of(std::exp(log_exponent)), contact, amplitude).force;
  };
  const double log_exponent =
      boost::math::tools::brent_find_minima(difference, 0.0, std::log(kLargestExponent), kBits)
          .first;
  // The search ends next to n = 1 if the least is there.
  const double exponent = std::clamp(std::exp(log_exponent), 1.0, kLargestExponent);
  return law_of(difference(0.0) <= difference(log_exponent) ? 1.0 : exponent);
}

}  // namespace mindahl::convert
