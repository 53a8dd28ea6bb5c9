#include "mindahl/contact/cattaneo_mindlin.h"

#include "printed_equations.h"
#include "support/prelude.h"

namespace mindahl::contact::cattaneo_mindlin_test {
namespace {

using printed::ErrorInUlps;
using printed::Real;

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

// The paper's contact, one of atomic force microscopy and one of a fault.
const MindlinContact kLaboratory{
    .contact_radius = 2.7e-3, .tangential_compliance = 4.42e-11, .slip_force = 30.0};
const MindlinContact kAtomic{
    .contact_radius = 3.1e-9, .tangential_compliance = 7.3e-11, .slip_force = 1.7e-12};
const MindlinContact kTectonic{
    .contact_radius = 2.3e3, .tangential_compliance = 1.13e-10, .slip_force = 3.7e12};

class MindlinAccuracy : public ::testing::TestWithParam<MindlinContact> {};

std::string ContactName(const ::testing::TestParamInfo<MindlinContact>& contact) {
  return contact.index == 0 ? "Laboratory" : contact.index == 1 ? "Atomic" : "Tectonic";
}

INSTANTIATE_TEST_SUITE_P(Contacts, MindlinAccuracy,
                         ::testing::Values(kLaboratory, kAtomic, kTectonic), ContactName);

/// Fractions of a limit: every decade from both ends, with odd mantissas, and the last ulps.
std::vector<double> FractionsOfALimit() {
  std::vector<double> fractions = {1.0, 1.0 - kEpsilon / 2, 1.0 - kEpsilon, 0.5, 1.0 / 3.0, 0.646};
  for (int exponent = -15; exponent <= -1; ++exponent) {
    for (const double mantissa : {1.0, 1.7, 2.9, 4.3, 6.1, 9.7}) {
      const double fraction = mantissa * std::pow(10.0, exponent);
      fractions.push_back(fraction);
      fractions.push_back(1.0 - fraction);
    }
  }
  fractions.push_back(1e-100);
  fractions.push_back(1e-200);
  return fractions;
}

// The bounds below are those of the headers. They count half an ulp a rounding, up to 4 ulp for
// cbrt (the GNU C library's own bound), and what each does to the result.
constexpr double kGrossSlipDisplacementUlps = 2.0;  // three products and quotients
constexpr double kVirginForceUlps = 6.0;            // eleven roundings
constexpr double kUnloadingForceUlps = 18.0;        // one force up to T*, twice one up to T*

TEST_P(MindlinAccuracy, GrossSlipDisplacementIsThreeSixteenthsOfTheForceTimesComplianceOverRadius) {
  EXPECT_LE(ErrorInUlps(GrossSlipDisplacement(GetParam()),
                        printed::Contact(GetParam()).GrossSlipDisplacement()),
            kGrossSlipDisplacementUlps);
}

TEST_P(MindlinAccuracy, VirginForceKeepsItsDigitsAtBothEnds) {
  const printed::Contact exact(GetParam());
  std::vector<double> fractions = FractionsOfALimit();
  fractions.insert(fractions.end(), {1.0 + kEpsilon, 1.2, 1e12});
  for (const double fraction : fractions) {
    if (fraction < 1e-90) continue;
    const double displacement = fraction * GrossSlipDisplacement(GetParam());
    EXPECT_LE(ErrorInUlps(MindlinVirginForce(GetParam(), displacement),
                          exact.VirginForce(Real(displacement))),
              kVirginForceUlps)
        << fraction;
  }
}

TEST_P(MindlinAccuracy, UnloadingAndReloadingForcesAreThoseOfTheLoop) {
  const printed::Contact exact(GetParam());
  for (const double fraction : FractionsOfALimit()) {
    if (fraction < 1e-90) continue;
    const double amplitude = fraction * GrossSlipDisplacement(GetParam());
    const Real peak = exact.VirginForce(Real(amplitude));
    for (const double share : {1.0, 0.999999, 0.7, 0.1, 1e-9, 0.0, -0.3, -0.97, -1.0}) {
      const double displacement = share * amplitude;
      EXPECT_LE(ErrorInUlps(MindlinUnloadingForce(GetParam(), displacement, amplitude),
                            exact.UnloadingForce(Real(displacement), peak), peak),
                kUnloadingForceUlps)
          << fraction << ' ' << share;
      EXPECT_LE(ErrorInUlps(MindlinReloadingForce(GetParam(), displacement, amplitude),
                            exact.ReloadingForce(Real(displacement), peak, -1), peak),
                kUnloadingForceUlps)
          << fraction << ' ' << share;
    }
  }
}

TEST(MindlinLoop, ClosesAtBothTips) {
  const MindlinContact& contact = kLaboratory;
  for (const double amplitude_ratio : {1e-9, 0.3, 0.8, 1.0, 1.2}) {
    const double amplitude = amplitude_ratio * GrossSlipDisplacement(contact);
    const double peak = MindlinVirginForce(contact, amplitude);
    EXPECT_EQ(MindlinUnloadingForce(contact, amplitude, amplitude), peak);
    EXPECT_EQ(MindlinReloadingForce(contact, amplitude, amplitude), peak);
    EXPECT_EQ(MindlinUnloadingForce(contact, -amplitude, amplitude), -peak);
    EXPECT_EQ(MindlinReloadingForce(contact, -amplitude, amplitude), -peak);
  }
}

TEST(MindlinLoop, RetracesTheVirginCurveTwiceAsLargeAfterReversal) {
  const MindlinContact& contact = kLaboratory;
  const double amplitude = 0.8 * GrossSlipDisplacement(contact);
  const double peak = MindlinVirginForce(contact, amplitude);
  for (const double retreat_ratio : {0.01, 0.4, 1.1, 1.9}) {
    const double retreat = retreat_ratio * amplitude;
    EXPECT_NEAR(peak - MindlinUnloadingForce(contact, amplitude - retreat, amplitude),
                2.0 * MindlinVirginForce(contact, retreat / 2.0),
                2.0 * kUnloadingForceUlps * kEpsilon * peak);
  }
}

TEST(MindlinLoop, HoldsTheSlipForceOnThePlateauOfGrossSlip) {
  const MindlinContact& contact = kLaboratory;
  const double onset = GrossSlipDisplacement(contact);
  const double amplitude = 3.0 * onset;
  // Unloading from 3δc slips again after a retreat of 2δc, at δc.
  EXPECT_EQ(MindlinUnloadingForce(contact, 0.99 * onset, amplitude), -contact.slip_force);
  EXPECT_GT(MindlinUnloadingForce(contact, 1.01 * onset, amplitude), -contact.slip_force);
}

TEST(MindlinVirginCurve, IsOddInTheDisplacement) {
  const MindlinContact& contact = kLaboratory;
  for (const double ratio : {0.0, 1e-12, 0.3, 0.9, 1.0}) {
    const double displacement = 1.3 * ratio * GrossSlipDisplacement(contact);
    EXPECT_EQ(MindlinVirginForce(contact, -displacement),
              -MindlinVirginForce(contact, displacement));
  }
}

TEST(MindlinVirginCurve, StartsWithTheStiffnessOfEightRadiiOverTheCompliance) {
  const MindlinContact& contact = kLaboratory;
  const double displacement = 1e-17 * GrossSlipDisplacement(contact);
  // f = σδ·(1 − δ/(4δc)·…): the relative departure, below 1e-17, is less than an ulp.
  EXPECT_NEAR(MindlinVirginForce(contact, displacement) / displacement /
                  MindlinTangentialStiffness(contact.contact_radius, contact.tangential_compliance),
              1.0, 2.0 * kVirginForceUlps * kEpsilon);
  EXPECT_DOUBLE_EQ(MindlinTangentialStiffness(2.0, 4.0), 4.0);
}

TEST(MindlinVirginCurve, HasAFiniteForceAtTheSmallestAndLargestDisplacement) {
  const MindlinContact& contact = kLaboratory;
  EXPECT_GE(MindlinVirginForce(contact, std::numeric_limits<double>::denorm_min()), 0.0);
  EXPECT_EQ(MindlinVirginForce(contact, std::numeric_limits<double>::max()), contact.slip_force);
  EXPECT_EQ(MindlinUnloadingForce(contact, -std::numeric_limits<double>::max(),
                                  std::numeric_limits<double>::max()),
            -contact.slip_force);
}

TEST(TangentialCompliance, IsAComplianceAddedOverTheBodies) {
  const Body steel{.youngs_modulus = 210e9, .poisson_ratio = 0.3};
  const Body rubber{.youngs_modulus = 3e6, .poisson_ratio = 0.5};
  // (2 − 0.3)·2·1.3/210e9 and (2 − 0.5)·2·1.5/3e6, by hand.
  constexpr double kSteel = 4.42 / 210e9;
  constexpr double kRubber = 1.5e-6;
  EXPECT_DOUBLE_EQ(TangentialCompliance(steel, steel), 2.0 * kSteel);
  EXPECT_DOUBLE_EQ(TangentialCompliance(steel, rubber), kSteel + kRubber);
  EXPECT_DOUBLE_EQ(TangentialCompliance(rubber, steel), kSteel + kRubber);
}

TEST(MindlinInput, NamesTheMemberOfTheContactThatIsWrong) {
  EXPECT_EQ(MessageOf([] {
              Validate({0.0, 4e-11, 30.0});
            }),
            "contact radius [m] = 0 is invalid: must be finite and > 0");
  EXPECT_EQ(MessageOf([] {
              Validate({1e-3, -1.0, 30.0});
            }),
            "tangential compliance [1/Pa] = -1 is invalid: must be finite and > 0");
  EXPECT_EQ(MessageOf([] {
              Validate({1e-3, 4e-11, std::nan("")});
            }),
            "slip force [N] = nan is invalid: must be finite and > 0");
  EXPECT_EQ(MessageOf([] { Validate(kLaboratory); }), "");
}

TEST(MindlinInput, IsValidatedByEveryFunctionOfAContact) {
  const MindlinContact broken{0.0, 4e-11, 30.0};
  const std::string message = "contact radius [m] = 0 is invalid: must be finite and > 0";
  EXPECT_EQ(MessageOf([&] { GrossSlipDisplacement(broken); }), message);
  EXPECT_EQ(MessageOf([&] { MindlinVirginForce(broken, 0.0); }), message);
  EXPECT_EQ(MessageOf([&] { MindlinUnloadingForce(broken, 0.0, 0.0); }), message);
  EXPECT_EQ(MessageOf([&] { MindlinReloadingForce(broken, 0.0, 0.0); }), message);
}

TEST(MindlinInput, RefusesADisplacementOffTheLoop) {
  EXPECT_EQ(
      MessageOf([] { MindlinUnloadingForce(kLaboratory, 2e-7, 1e-7); }),
      "displacement [m] = 2e-07 is invalid: must not exceed the displacement amplitude 1e-07 m");
  EXPECT_EQ(MessageOf([] { MindlinReloadingForce(kLaboratory, 0.0, -1e-7); }),
            "displacement amplitude [m] = -1e-07 is invalid: must be finite and >= 0");
  EXPECT_EQ(
      MessageOf([] { MindlinVirginForce(kLaboratory, std::numeric_limits<double>::infinity()); }),
      "displacement [m] = inf is invalid: must be finite");
}

TEST(MindlinInput, RefusesFrictionlessAndUnloadedContacts) {
  EXPECT_DOUBLE_EQ(GrossSlipForce(0.3, 100.0), 30.0);
  EXPECT_EQ(MessageOf([] { GrossSlipForce(0.0, 100.0); }),
            "friction coefficient = 0 is invalid: must be finite and > 0");
  EXPECT_EQ(MessageOf([] { GrossSlipForce(0.3, 0.0); }),
            "normal load [N] = 0 is invalid: must be finite and > 0");
  EXPECT_EQ(MessageOf([] { MindlinTangentialStiffness(-1.0, 4e-11); }),
            "contact radius [m] = -1 is invalid: must be finite and > 0");
  EXPECT_EQ(MessageOf([] { MindlinTangentialStiffness(1.0, 0.0); }),
            "tangential compliance [1/Pa] = 0 is invalid: must be finite and > 0");
}

}  // namespace
}  // namespace mindahl::contact::cattaneo_mindlin_test
