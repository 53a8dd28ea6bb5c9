#include "convert/refit.h"

#include <cmath>
#include <cstddef>
#include <span>

#include "convert/bouc_wen_shape.h"
#include "core/least_of.h"
#include "mindahl/models/steady_loop.h"

namespace mindahl::convert {

ReferenceLoops::ReferenceLoops(const ModelLaw& contact, const std::vector<double>& amplitudes)
    : contact_(contact) {
  constexpr std::size_t kPlaces = 65;
  for (const double amplitude : amplitudes) {
    Loop& loop = loops_.emplace_back();
    loop.amplitude = amplitude;
    loop.distance.resize(kPlaces);
    loop.force.resize(kPlaces);
    for (std::size_t i = 0; i < kPlaces; ++i) {
      loop.distance[i] = 2 * amplitude * (static_cast<double>(i) / (kPlaces - 1));
    }
    EvaluateRisingBranch(contact, amplitude, loop.distance, loop.force);
    loop.weight = 1 / models::SteadyPeakForce(*contact.model, contact.law, amplitude);
    for (double& force : loop.force) force *= loop.weight;
  }
}

template <typename Response>
ReferenceLoops::Regression ReferenceLoops::Regress(const Response& t, double rate) const {
  double squares = 0.0;
  double product = 0.0;
  double total = 0.0;
  for (const Loop& loop : loops_) {
    std::vector<double> response(loop.distance.size());
    t(rate, loop, response);
    for (std::size_t i = 0; i < response.size(); ++i) {
      const double scaled = loop.weight * response[i];
      squares += scaled * scaled;
      product += scaled * loop.force[i];
      total += loop.force[i] * loop.force[i];
    }
  }
  return {product / squares, total - product * product / squares};
}

template <typename Response>
double ReferenceLoops::BestRate(const Response& t) const {
  // From where the contact itself bends: two decades to either side.
  const double centre = std::log(contact_.law.tangential_stiffness / contact_.law.slip_force);
  const double reach = std::log(100.0);
  constexpr int kPlaces = 40;
  return std::exp(LeastOf([&](double log_rate) { return Regress(t, std::exp(log_rate)).cost; },
                          centre - reach, centre + reach, kPlaces));
}

ModelLaw ReferenceLoops::Fit(const models::FrictionModel& model, double shape_exponent) const {
  const auto t = [&](double rate, const Loop& loop, std::span<double> response) {
    EvaluateRisingBranch(ModelLaw{&model, {rate, shape_exponent, 1.0}}, loop.amplitude,
                         loop.distance, response);
  };
  const double rate = BestRate(t);
  const double slip_force = Regress(t, rate).slip_force;
  return {&model, {rate * slip_force, shape_exponent, slip_force}};
}

BoucWenLaw ReferenceLoops::FitBoucWen(double beta) const {
  const auto response_of = [](const BoucWenShape& shape) {
    return [&shape](double rate, const Loop& loop, std::span<double> response) {
      const BoucWenShape::Loop steady = shape.LoopOf(rate * loop.amplitude);
      for (std::size_t i = 0; i < response.size(); ++i) {
        response[i] = shape.Rising(steady, rate * loop.distance[i]);
      }
    };
  };
  const auto cost_of = [&](double log_exponent) {
    const BoucWenShape shape(std::exp(log_exponent), beta);
    const auto t = response_of(shape);
    return Regress(t, BestRate(t)).cost;
  };
  constexpr int kPlaces = 8;
  const double exponent = std::exp(LeastOf(cost_of, 0.0, std::log(20.0), kPlaces));
  const BoucWenShape shape(exponent, beta);
  const auto t = response_of(shape);
  const double rate = BestRate(t);
  const double slip_force = Regress(t, rate).slip_force;
  return {
      .stiffness = rate * slip_force, .slip_force = slip_force, .exponent = exponent, .beta = beta};
}

}  // namespace mindahl::convert
