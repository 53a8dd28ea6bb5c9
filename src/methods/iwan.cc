#include "mindahl/methods/iwan.h"

#include <Eigen/Core>
#include <cmath>

#include "mindahl/core/error.h"

namespace mindahl::methods {
namespace {

/// A tangent of the virgin curve, in long double: differences between neighbours are what the
/// elements are made of.
struct Tangent {
  long double slope;      // φ' = u^α
  long double intercept;  // F = φ − yφ' = (1 − u^α − α(1 − u))/(1 − α)
};

Tangent TangentAt(long double u, long double shape_exponent) {
  if (u <= 0) return {0, 1};
  constexpr long double kLogarithmic = 1e-9L;  // where 1 - α is less, its first power is rounding
  const long double log_u = std::log(u);
  const long double beta = 1 - shape_exponent;
  const long double slope = std::exp(shape_exponent * log_u);
  if (std::abs(beta) < kLogarithmic) return {slope, 1 - u + u * log_u};
  return {slope, -(std::expm1(shape_exponent * log_u) + shape_exponent * (1 - u)) / beta};
}

}  // namespace

IwanElements MakeIwanElements(const models::BranchLaw& law, std::size_t elements) {
  Validate(law);
  if (elements == 0) ThrowInvalid("number of Iwan elements [-]", 0.0, "must be >= 1");
  if (law.shape_exponent == 0) return {{law.tangential_stiffness}, {law.slip_force}};
  IwanElements result;
  Tangent last = TangentAt(1, law.shape_exponent);
  for (std::size_t i = 1; i <= elements; ++i) {
    const long double root = 1 - static_cast<long double>(i) / static_cast<long double>(elements);
    const Tangent next = TangentAt(root * root, law.shape_exponent);
    result.stiffness.push_back(
        static_cast<double>(law.tangential_stiffness * (last.slope - next.slope)));
    result.slip_force.push_back(
        static_cast<double>(law.slip_force * (next.intercept - last.intercept)));
    last = next;
  }
  return result;
}

void EvaluateIwanForce(const IwanElements& elements, std::span<const double> displacement,
                       std::span<double> force) {
  RequireSameSize("displacement", displacement.size(), "force", force.size());
  RequireSameSize("stiffness", elements.stiffness.size(), "slip force", elements.slip_force.size());
  for (const double at : displacement) RequireFinite("displacement [m]", at);
  const auto count = static_cast<Eigen::Index>(elements.size());
  const Eigen::Map<const Eigen::ArrayXd> stiffness(elements.stiffness.data(), count);
  const Eigen::Map<const Eigen::ArrayXd> limit(elements.slip_force.data(), count);
  Eigen::ArrayXd of_element = Eigen::ArrayXd::Zero(count);
  double last = 0.0;
  for (std::size_t i = 0; i < displacement.size(); ++i) {
    of_element = (of_element + stiffness * (displacement[i] - last)).max(-limit).min(limit);
    force[i] = of_element.sum();
    last = displacement[i];
  }
}

}  // namespace mindahl::methods
