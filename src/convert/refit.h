#pragma once

#include <cstddef>
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

/// Jenkins elements whose steady loops at some amplitudes are nearest to those of a contact: the
/// mean square difference of force over the loops, each over its own T*, is least over all
/// stiffnesses and slip forces. Neither it nor the largest difference of force is ever more than
/// that of the tangents (MakeIwanElements), which are returned where nothing better is found.
///
/// The root mean square falls as n⁻², for a Masing law to what n straight lines can do at best,
///   2·(∫|f''|^{2/5}dx)^{5/2}/(√720·√X·T*·n²),  over the virgin curve up to X or to slip,
/// which is 0.098/n² of T* for Mindlin's contact at the onset of slip.
///
/// Their virgin curve is a polygon, and the loop at X follows 2p(d/2) − p(X). Up to 64 elements are
/// found by ceres::Solve, stiffnesses and displacements at slip together and inside their bounds,
/// from the polygon whose corners are where they are best for many elements and from one of even
/// differences; more are those polygons, which come within some hundredths of the least mean square
/// at one amplitude and are farther from it over many.
///
/// The last of two or more elements sticks at every amplitude where none slips grossly; its slip
/// force is then the contact's less that of the others.
/// @param masing      the Masing law of the contact, or of its loop at one of the amplitudes
/// @param amplitudes  [m], > 0
/// @param elements    >= 1; fewer are returned for α = 0, which is one
/// Cost: 4 ms an element at one amplitude and 30 ms at ten, at most; 64 elements take most.
methods::IwanElements RefitElements(const ModelLaw& contact, const models::BranchLaw& masing,
                                    const std::vector<double>& amplitudes, std::size_t elements);

}  // namespace mindahl::convert
