#pragma once

#include <vector>

#include "mindahl/convert/steady_law.h"

namespace mindahl::convert {

/// The loops to which another law is fitted: of each amplitude the rising branch at places evenly
/// spaced, over its T*.
class ReferenceLoops {
 public:
  ReferenceLoops(const ModelLaw& contact, const std::vector<double>& amplitudes);

  /// Fits Dahl's law of α = 1, or a spring with Coulomb's limit: σ and Tc.
  [[nodiscard]] ModelLaw Fit(const models::FrictionModel& model, double shape_exponent) const;
  /// Fits k, n and Tc at a given β.
  [[nodiscard]] BoucWenLaw FitBoucWen(double beta) const;

 private:
  struct Loop {
    double amplitude;
    double weight;  // 1/T*
    std::vector<double> distance;
    std::vector<double> force;  // over T*
  };
  struct Regression {
    double slip_force;
    double cost;
  };

  /// The force is linear in Tc: the best, and what is left, at a rate κ = σ/Tc.
  /// @param t  T/Tc on the rising branch: (rate, loop, written)
  template <typename Response>
  Regression Regress(const Response& t, double rate) const;
  /// Returns the rate with the least cost.
  template <typename Response>
  double BestRate(const Response& t) const;

  ModelLaw contact_;
  std::vector<Loop> loops_;
};

}  // namespace mindahl::convert
