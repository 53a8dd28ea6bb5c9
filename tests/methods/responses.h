#pragma once

#include <algorithm>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cmath>
#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

#include "../../tools/reference/exact_history.h"
#include "mindahl/methods/method.h"
#include "mindahl/models/branch_law.h"
#include "mindahl/models/excitation.h"
#include "mindahl/models/friction_model.h"
#include "support/histories.h"

/// Responses by a method, and by the literal definition of the law.
namespace mindahl::testing {

inline std::vector<double> RespondBy(std::string_view method, std::string_view model,
                                     const models::BranchLaw& law, const methods::Drive& drive,
                                     const methods::Resolution& resolution = {}) {
  std::vector<double> force(drive.displacement.size());
  Prepare(*methods::FindMethod(method), *models::FindFrictionModel(model), law, resolution)(drive,
                                                                                            force);
  return force;
}

/// long double by a class, for which the definition's unqualified exp, log and abs are its own:
/// those of long double would be double's.
using Extended = boost::multiprecision::cpp_bin_float_double_extended;

/// Masing forces at every sample, each from the whole past: quadratic in the samples.
template <typename Real>
std::vector<double> DefinedForce(const models::BranchLaw& law,
                                 std::span<const double> displacement) {
  const reference::Law<Real> exact{Real(law.tangential_stiffness), Real(law.shape_exponent),
                                   Real(law.slip_force)};
  std::vector<Real> past;
  std::vector<double> force;
  for (const double at : displacement) {
    past.push_back(Real(at));
    force.push_back(static_cast<double>(reference::MasingForce(exact, past)));
  }
  return force;
}

inline double LargestDifference(std::span<const double> a, std::span<const double> b) {
  double largest = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double difference = std::abs(a[i] - b[i]);
    if (!(difference <= largest)) largest = difference;  // also where it is not a number
    if (std::isnan(largest)) return largest;
  }
  return largest;
}

inline std::vector<double> Displacements(const models::ExcitationOptions& options) {
  return models::MakeExcitation(options).displacement;
}

/// δc, and Tc/σ for α >= 1, which has none.
inline double ReferenceDisplacement(const models::BranchLaw& law) {
  return law.shape_exponent < 1 ? GrossSlipDisplacement(law)
                                : law.slip_force / law.tangential_stiffness;
}

}  // namespace mindahl::testing
