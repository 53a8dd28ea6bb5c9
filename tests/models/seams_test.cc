// Dense sweeps across every switch between formulas: no jump, no step back, no force beyond Tc.

#include "../support/histories.h"
#include "mindahl/models/backbone.h"
#include "mindahl/models/branch_law.h"
#include "mindahl/models/response.h"
#include "mindahl/models/steady_loop.h"
#include "support/prelude.h"

namespace mindahl::models::seams_test {
namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

/// Twice the bounds of branch_law.h and response.h: what two neighbours may be wrong by.
constexpr double kScalarStep = 2 * 1.0 * kEpsilon;
constexpr double kKernelStep = 2 * 6.0 * kEpsilon;

/// So many doubles to either side of a switch.
constexpr int kDoubles = 400;

/// Doubles around `centre`, ascending: neighbours first, then ever further.
std::vector<double> Around(double centre) {
  std::vector<double> points = {centre};
  double below = centre;
  double above = centre;
  for (int i = 0; i < kDoubles; ++i) {
    points.push_back(below = std::nextafter(below, 0.0));
    points.push_back(above = std::nextafter(above, std::numeric_limits<double>::infinity()));
  }
  for (double relative = 1e-13; relative < 0.05; relative *= 1.25) {
    points.push_back(centre * (1 - relative));
    points.push_back(centre * (1 + relative));
  }
  std::ranges::sort(points);
  return points;
}

/// y at the switches of a shape exponent: |w| = 1/4 and w = 1/2 of backbone.h, y = 2 where z is
/// formed otherwise, y = |w| = 1/2 of src/models/steady_loop.cc, log u = −11/16, and slip.
std::vector<double> Switches(double alpha) {
  const double beta = 1 - alpha;
  std::vector<double> switches = {0.5, 1.0, 2.0};
  if (beta != 0) {
    for (const double w : {0.25, 0.5}) switches.push_back(w / std::abs(beta));
    if (beta > 0) switches.push_back(1 / beta);
    const double base = std::exp(-0.6875 * beta);
    switches.push_back((1 - base) / beta);
  } else {
    switches.push_back(0.6875);
  }
  return switches;
}

constexpr double kShapeExponents[] = {0.0,       1e-300, 1e-16, 1e-8,     1.0 / 128, 0.1, 1.0 / 3.0,
                                      0.4999999, 0.5,    0.7,   1 - 1e-8, 1 - 1e-15, 1.0, 1 + 1e-15,
                                      1 + 1e-8,  1.7,    2.0,   10.0,     100.0};

struct Curve {
  std::vector<double> x, force, slope, energy, kernel;
};

Curve Sample(const BranchLaw& law, const std::vector<double>& x) {
  Curve curve{.x = x, .force = {}, .slope = {}, .energy = {}, .kernel = {}};
  for (const double at : x) {
    curve.force.push_back(BackboneForce(law, at));
    curve.slope.push_back(
        static_cast<double>(backbone::GeneralShape<long double>{law.shape_exponent}.Slope(at)));
    curve.energy.push_back(SteadyLoopEnergy(Model("mindlin-dahl"), law, at));
  }
  curve.kernel = testing::Respond(Model("mindlin-dahl"), law, x);
  return curve;
}

/// Rising, and by no more than `steepest`·Δx, each to `rounding` of the value.
void ExpectNoSeam(const std::vector<double>& x, const std::vector<double>& value,
                  const std::vector<double>& steepest, double rounding, const char* name,
                  double alpha) {
  for (std::size_t i = 1; i < x.size(); ++i) {
    const double rise = value[i] - value[i - 1];
    const double slack = rounding * value[i];
    EXPECT_GE(rise, -slack) << name << " falls, alpha = " << alpha << ", y = " << x[i];
    EXPECT_LE(rise, steepest[i] * (x[i] - x[i - 1]) * (1 + 1e-9) + slack)
        << name << " jumps, alpha = " << alpha << ", y = " << x[i];
  }
}

TEST(Seams, AreNotSeenAlongADisplacement) {
  for (const double alpha : kShapeExponents) {
    const BranchLaw law{1.0, alpha, 1.0};
    for (const double centre : Switches(alpha)) {
      const Curve curve = Sample(law, Around(centre));
      // Concave: the slope at the nearer end is the steepest. A loop's energy rises by at
      // most 8f − 4f at the farther end.
      std::vector<double> slope = {0.0};
      std::vector<double> energy_slope = {0.0};
      for (std::size_t i = 1; i < curve.x.size(); ++i) {
        slope.push_back(curve.slope[i - 1]);
        energy_slope.push_back(4 * curve.force[i]);
      }
      ExpectNoSeam(curve.x, curve.force, slope, kScalarStep, "force", alpha);
      ExpectNoSeam(curve.x, curve.kernel, slope, kKernelStep, "kernel", alpha);
      ExpectNoSeam(curve.x, curve.energy, energy_slope, kScalarStep, "energy", alpha);
      for (std::size_t i = 0; i < curve.x.size(); ++i) {
        EXPECT_LE(curve.force[i], 1.0);
        EXPECT_LE(curve.kernel[i], 1.0);
        EXPECT_GE(curve.slope[i], 0.0);
        EXPECT_LE(curve.slope[i], 1.0);
        if (i > 0) {
          EXPECT_LE(curve.slope[i], curve.slope[i - 1] * (1 + kScalarStep)) << alpha;
        }
      }
    }
  }
}

}  // namespace
}  // namespace mindahl::models::seams_test
