#pragma once

#include <cmath>
#include <limits>
#include <utility>
#include <vector>

/// The box over which the accuracy of the models is stated (docs/accuracy.md).
namespace reference {

inline constexpr double kBoxShapeExponents[] = {0.0,       1e-300,   1e-16,    1e-8,      0.1,
                                                1.0 / 3.0, 0.5,      1 - 1e-8, 1 - 1e-15, 1.0,
                                                1 + 1e-15, 1 + 1e-8, 2.0,      10.0,      100.0};

struct Scale {
  double stiffness;   // σ [N/m]
  double slip_force;  // Tc [N]
};

/// The corners, the middle, and numbers of odd mantissas that round in every product.
inline constexpr Scale kBoxScales[] = {{1.0, 1.0},    {4.839e8, 30.0}, {1e-9, 1e-15},  {1e-9, 1e12},
                                       {1e15, 1e-15}, {1e15, 1e12},    {7.3e-3, 1.9e7}};

/// λ = x/δc, from far below to far beyond gross slip, dense where formulas change and near slip.
inline std::vector<double> BoxAmplitudes() {
  std::vector<double> lambdas;
  for (int decade = -18; decade <= 12; ++decade) {
    lambdas.push_back(std::pow(10.0, decade));
    lambdas.push_back(3.7 * std::pow(10.0, decade - (decade == 12)));
  }
  for (const double lambda :
       {0.03, 0.2, 0.2499, 0.25, 0.2501, 0.3,      0.33,     0.45,     0.4999, 0.5, 0.5001, 0.55,
        0.7,  0.8, 0.9,    0.97, 0.999,  1 - 1e-6, 1 - 1e-9, 1 + 1e-9, 1.001,  1.2, 2.0,    5.0}) {
    lambdas.push_back(lambda);
  }
  return lambdas;
}

/// Displacements [m] of the box for a law: in units of δc for α < 1, and for every α in units of
/// the elastic limit Tc/σ, each with the doubles next to the unit itself.
inline std::vector<double> BoxDisplacements(const Scale& scale, double shape_exponent) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const double limit = scale.slip_force / scale.stiffness;
  std::vector<double> units = {limit};
  if (shape_exponent > 0 && shape_exponent < 1 && limit / (1 - shape_exponent) != limit) {
    units.push_back(limit / (1 - shape_exponent));
  }
  std::vector<double> displacements;
  for (const double unit : units) {
    for (const double lambda : BoxAmplitudes()) displacements.push_back(unit * lambda);
    const double below = std::nextafter(unit, 0.0);
    const double above = std::nextafter(unit, kInfinity);
    displacements.insert(displacements.end(), {std::nextafter(below, 0.0), below, unit, above,
                                               std::nextafter(above, kInfinity)});
  }
  return displacements;
}

}  // namespace reference
