// Hertz and the scales of Cattaneo and Mindlin within the bounds of their docstrings, from atomic
// to tectonic, against the same closed forms at 50 digits; and refused where no double holds them.

#include <boost/math/constants/constants.hpp>
#include <boost/multiprecision/cpp_bin_float.hpp>

#include "mindahl/contact/cattaneo_mindlin.h"
#include "mindahl/contact/hertz.h"
#include "support/histories.h"
#include "support/prelude.h"

namespace mindahl::contact::accuracy_test {
namespace {

using Real = boost::multiprecision::cpp_bin_float_50;
constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

void ExpectWithin(double bound, double value, const Real& exact, const char* name) {
  const Real error = abs(Real(value) - exact) / (abs(exact) * kEpsilon);
  EXPECT_LE(static_cast<double>(error), bound) << name << " = " << value;
}

TEST(ContactAccuracy, HoldsItsBoundsFromAtomicToTectonic) {
  constexpr double kOnce = 1.0;       // [ε]: rounded once
  constexpr double kOfRounded = 2.0;  // from two rounded moduli, added
  Generator generator(20170652);
  const auto draw = [&](double low, double high) { return LogUniform(generator, low, high); };
  const auto draw_body = [&](double radius) {
    return Body{draw(1e3, 1e13), Uniform(generator, -0.999, 0.499), radius};
  };
  for (int i = 0; i < 5000; ++i) {
    const double load = draw(1e-15, 1e15);
    const double radius = draw(1e-10, 1e6);
    const double modulus = draw(1e3, 1e13);
    const double a = draw(1e-12, 1e5);
    const double compliance = draw(1e-14, 1e-2);
    const double slip_force = draw(1e-15, 1e12);
    const Body body_1 = draw_body(radius);
    const Body body_2 = draw_body(radius);
    const auto shear = [](const Body& body) {
      return Real(Real(body.youngs_modulus) / (2 * (1 + Real(body.poisson_ratio))));
    };
    const auto normal = [](const Body& body) {
      return Real((1 - Real(body.poisson_ratio) * Real(body.poisson_ratio)) /
                  Real(body.youngs_modulus));
    };
    const Real cube = Real(a) * Real(a) * Real(a);
    ExpectWithin(kOnce, ShearModulus(body_1), shear(body_1), "shear modulus");
    ExpectWithin(kOnce, EffectiveModulus(body_1, body_2),
                 Real(1 / (normal(body_1) + normal(body_2))), "effective modulus");
    ExpectWithin(kOnce, HertzContactRadius(load, radius, modulus),
                 Real(cbrt(Real(3) / 4 * Real(load) * Real(radius) / Real(modulus))), "radius");
    ExpectWithin(kOnce, HertzEquivalentRadius(load, a, modulus),
                 Real(4 * Real(modulus) * cube / (3 * Real(load))), "equivalent radius");
    ExpectWithin(
        kOnce, HertzMaximumPressure(load, a),
        Real(Real(3) / 2 * Real(load) / (boost::math::constants::pi<Real>() * Real(a) * Real(a))),
        "pressure");
    ExpectWithin(kOfRounded, TangentialCompliance(body_1, body_2),
                 Real((2 - Real(body_1.poisson_ratio)) / shear(body_1) +
                      (2 - Real(body_2.poisson_ratio)) / shear(body_2)),
                 "compliance");
    ExpectWithin(kOnce, GrossSlipForce(0.3, load), Real(Real(0.3) * Real(load)), "slip force");
    ExpectWithin(kOnce, MindlinTangentialStiffness(a, compliance),
                 Real(8 * Real(a) / Real(compliance)), "stiffness");
    ExpectWithin(kOnce, GrossSlipDisplacement(MindlinContact{a, compliance, slip_force}),
                 Real(3 * Real(slip_force) * Real(compliance) / (16 * Real(a))), "slip");
  }
}

TEST(ContactAccuracy, RefusesWhatNoDoubleHolds) {
  const auto expect_refusal = [](auto call) {
    EXPECT_THAT(MessageOf(call), HasSubstr("must be within the range of double"));
  };
  expect_refusal([] { HertzMaximumPressure(1e300, 1e-100); });
  expect_refusal([] { HertzMaximumPressure(1e-300, 1e100); });
  expect_refusal([] { GrossSlipForce(1e200, 1e200); });
  expect_refusal([] { MindlinTangentialStiffness(1e300, 1e-300); });
  expect_refusal([] { GrossSlipDisplacement({1e300, 1e-300, 1.0}); });
  // What overflows only on the way does not matter.
  EXPECT_DOUBLE_EQ(HertzEquivalentRadius(1e300, 1e120, 1e-60), 4.0 / 3.0);
}

}  // namespace
}  // namespace mindahl::contact::accuracy_test
