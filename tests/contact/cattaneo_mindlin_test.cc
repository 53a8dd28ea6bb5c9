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
constexpr double kGrossSlipDisplacementUlps = 2.0;   // three products and quotients
constexpr double kStickRatioUlps = 5.0;              // cbrt, and a third of two roundings
constexpr double kSlipAreaUlps = 8.0;                // half of cbrt's error, eight roundings
constexpr double kVirginDisplacementUlps = 10.0;     // the above, times δc
constexpr double kUnloadingDisplacementUlps = 24.0;  // one share up to δ*, twice one up to δ*
constexpr double kVirginForceUlps = 6.0;             // eleven roundings
constexpr double kUnloadingForceUlps = 18.0;         // one force up to T*, twice one up to T*
constexpr double kEnergyUlps = 20.0;                 // twice cbrt's error, twenty-two roundings
constexpr double kEnergyAtAmplitudeUlps = 16.0;      // the same with sqrt, half an ulp

TEST_P(MindlinAccuracy, GrossSlipDisplacementIsThreeSixteenthsOfTheForceTimesComplianceOverRadius) {
  EXPECT_LE(ErrorInUlps(GrossSlipDisplacement(GetParam()),
                        printed::Contact(GetParam()).GrossSlipDisplacement()),
            kGrossSlipDisplacementUlps);
}

TEST_P(MindlinAccuracy, StickRadiusRatioKeepsItsDigitsUpToGrossSlip) {
  const double slip_force = GetParam().slip_force;
  for (const double fraction : FractionsOfALimit()) {
    const double force = fraction * slip_force;
    const Real remaining = 1 - Real(force) / Real(slip_force);
    if (remaining == 0) {
      EXPECT_EQ(StickRadiusRatio(force, slip_force), 0.0);
      continue;
    }
    EXPECT_LE(ErrorInUlps(StickRadiusRatio(force, slip_force), pow(remaining, Real(1) / 3)),
              kStickRatioUlps)
        << fraction;
  }
}

TEST_P(MindlinAccuracy, SlipAreaFractionKeepsItsDigitsAtBothEnds) {
  const double slip_force = GetParam().slip_force;
  for (const double fraction : FractionsOfALimit()) {
    if (fraction < 1e-90) continue;  // the reference itself has cancelled
    const double force = fraction * slip_force;
    const Real exact = 1 - printed::TwoThirdsPower(1 - Real(force) / Real(slip_force));
    EXPECT_LE(ErrorInUlps(SlipAreaFraction(force, slip_force), exact), kSlipAreaUlps) << fraction;
  }
}

TEST_P(MindlinAccuracy, VirginDisplacementKeepsItsDigitsAtBothEnds) {
  const printed::Contact exact(GetParam());
  for (const double fraction : FractionsOfALimit()) {
    if (fraction < 1e-90) continue;
    const double force = fraction * GetParam().slip_force;
    EXPECT_LE(ErrorInUlps(MindlinVirginDisplacement(GetParam(), force),
                          exact.VirginDisplacement(Real(force))),
              kVirginDisplacementUlps)
        << fraction;
  }
}

TEST_P(MindlinAccuracy, UnloadingAndReloadingDisplacementsAreThoseOfTheLoop) {
  const printed::Contact exact(GetParam());
  for (const double peak_fraction : FractionsOfALimit()) {
    if (peak_fraction < 1e-90) continue;
    const double peak = peak_fraction * GetParam().slip_force;
    const Real scale = exact.VirginDisplacement(Real(peak));
    for (const double share : {1.0, 0.999999, 0.7, 0.1, 1e-9, 0.0, -0.3, -0.97, -1.0}) {
      const double force = share * peak;
      EXPECT_LE(ErrorInUlps(MindlinUnloadingDisplacement(GetParam(), force, peak),
                            exact.UnloadingDisplacement(Real(force), Real(peak)), scale),
                kUnloadingDisplacementUlps)
          << peak_fraction << ' ' << share;
      EXPECT_LE(ErrorInUlps(MindlinReloadingDisplacement(GetParam(), force, peak),
                            exact.ReloadingDisplacement(Real(force), Real(peak)), scale),
                kUnloadingDisplacementUlps)
          << peak_fraction << ' ' << share;
    }
  }
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

TEST_P(MindlinAccuracy, EnergyPerCycleKeepsItsDigitsFromTinyAmplitudesToGrossSlip) {
  const printed::Contact exact(GetParam());
  constexpr int kSamples = 4000;  // evenly in log T*/Tc over 1e-12 to 1: a seam would show
  for (int sample = 0; sample <= kSamples; ++sample) {
    const double ratio = std::pow(10.0, -12.0 * sample / kSamples);
    const double peak = ratio * GetParam().slip_force;
    ASSERT_LE(
        ErrorInUlps(MindlinEnergyPerCycle(GetParam(), peak), exact.EnergyPerCycle(Real(peak))),
        kEnergyUlps)
        << ratio;
  }
}

TEST_P(MindlinAccuracy, EnergyPerCycleAtAmplitudeKeepsItsDigitsThroughGrossSlip) {
  const printed::Contact exact(GetParam());
  const double onset = GrossSlipDisplacement(GetParam());
  constexpr int kSamples = 4000;  // evenly in log δ*/δc over 1e-12 to 1e3
  for (int sample = 0; sample <= kSamples; ++sample) {
    const double amplitude = onset * std::pow(10.0, 3.0 - 15.0 * sample / kSamples);
    const Real beyond = Real(amplitude) - exact.GrossSlipDisplacement();
    Real energy = exact.EnergyPerCycle(exact.VirginForce(Real(amplitude)));
    if (beyond > 0) energy += 4 * exact.slip_force * beyond;
    ASSERT_LE(ErrorInUlps(MindlinEnergyPerCycleAtAmplitude(GetParam(), amplitude), energy),
              kEnergyAtAmplitudeUlps)
        << amplitude / onset;
  }
}

TEST(MindlinEnergy, TendsToTheCubeOfThePeakForceAtTinyAmplitudes) {
  const MindlinContact& contact = kLaboratory;
  const double peak = 1e-60 * contact.slip_force;
  const double leading = contact.tangential_compliance * peak * peak * peak /
                         (36.0 * contact.contact_radius * contact.slip_force);
  // The next term of the series is smaller by T*/Tc = 1e-60.
  EXPECT_NEAR(MindlinEnergyPerCycle(contact, peak) / leading, 1.0, kEnergyUlps * kEpsilon);
  EXPECT_EQ(MindlinEnergyPerCycle(contact, 0.0), 0.0);
  EXPECT_EQ(MindlinEnergyPerCycleAtAmplitude(contact, 0.0), 0.0);
}

TEST(MindlinEnergy, IsAFifthOfTheBoxAroundTheLoopAtTheOnsetOfGrossSlip) {
  const MindlinContact& contact = kLaboratory;
  const double box = 4.0 * contact.slip_force * GrossSlipDisplacement(contact);
  EXPECT_NEAR(MindlinEnergyPerCycle(contact, contact.slip_force) / box, 0.2,
              kEnergyUlps * kEpsilon);
}

TEST(MindlinEnergy, IsTheAreaBetweenReloadingAndUnloading) {
  const MindlinContact& contact = kLaboratory;
  constexpr int kIntervals = 20000;
  // The branches have a bounded second derivative except within δ* of gross slip, where it grows as
  // the inverse root: the midpoint rule errs as h^{3/2} there, (1/20000)^{1.5} = 3.5e-7 of the
  // height.
  constexpr double kMidpointRule = 1e-6;
  for (const double amplitude_ratio : {0.01, 0.3, 0.8, 1.0, 1.2, 3.0}) {
    const double amplitude = amplitude_ratio * GrossSlipDisplacement(contact);
    const double step = 2.0 * amplitude / kIntervals;
    double area = 0.0;
    for (int interval = 0; interval < kIntervals; ++interval) {
      const double displacement = -amplitude + (interval + 0.5) * step;
      area += (MindlinReloadingForce(contact, displacement, amplitude) -
               MindlinUnloadingForce(contact, displacement, amplitude)) *
              step;
    }
    // Reloading is the upper branch: the loop runs clockwise and takes energy.
    EXPECT_NEAR(MindlinEnergyPerCycleAtAmplitude(contact, amplitude) / area, 1.0, kMidpointRule)
        << amplitude_ratio;
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
  for (const double force_ratio : {1e-9, 0.3, 0.8, 1.0}) {
    const double peak = force_ratio * contact.slip_force;
    const double amplitude = MindlinVirginDisplacement(contact, peak);
    EXPECT_EQ(MindlinUnloadingDisplacement(contact, peak, peak), amplitude);
    EXPECT_EQ(MindlinUnloadingDisplacement(contact, -peak, peak), -amplitude);
    EXPECT_EQ(MindlinReloadingDisplacement(contact, peak, peak), amplitude);
    EXPECT_EQ(MindlinReloadingDisplacement(contact, -peak, peak), -amplitude);
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

TEST(MindlinVirginCurve, IsOddInForceAndDisplacement) {
  const MindlinContact& contact = kLaboratory;
  for (const double ratio : {0.0, 1e-12, 0.3, 0.9, 1.0}) {
    const double force = ratio * contact.slip_force;
    const double displacement = 1.3 * ratio * GrossSlipDisplacement(contact);
    EXPECT_EQ(MindlinVirginDisplacement(contact, -force),
              -MindlinVirginDisplacement(contact, force));
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

TEST(SlipArea, IsTheDisplacementOverThatAtGrossSlip) {
  const MindlinContact& contact = kLaboratory;
  for (const double ratio : {0.05, 0.5, 0.95}) {
    const double displacement = ratio * GrossSlipDisplacement(contact);
    const double force = MindlinVirginForce(contact, displacement);
    // T loses the digits of 1 − δ/δc by at most the slope of the inverse, (2/3)(1 − t)^{-1/3} < 2.
    constexpr double kRoundTrip = 2.0 * (kVirginForceUlps + kSlipAreaUlps) * kEpsilon;
    EXPECT_NEAR(SlipAreaFraction(force, contact.slip_force), ratio, kRoundTrip);
  }
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
  EXPECT_EQ(MessageOf([&] { MindlinVirginDisplacement(broken, 0.0); }), message);
  EXPECT_EQ(MessageOf([&] { MindlinUnloadingDisplacement(broken, 0.0, 0.0); }), message);
  EXPECT_EQ(MessageOf([&] { MindlinReloadingDisplacement(broken, 0.0, 0.0); }), message);
  EXPECT_EQ(MessageOf([&] { MindlinVirginForce(broken, 0.0); }), message);
  EXPECT_EQ(MessageOf([&] { MindlinUnloadingForce(broken, 0.0, 0.0); }), message);
  EXPECT_EQ(MessageOf([&] { MindlinReloadingForce(broken, 0.0, 0.0); }), message);
  EXPECT_EQ(MessageOf([&] { MindlinEnergyPerCycle(broken, 0.0); }), message);
  EXPECT_EQ(MessageOf([&] { MindlinEnergyPerCycleAtAmplitude(broken, 0.0); }), message);

  const std::string no_force = "slip force [N] = 0 is invalid: must be finite and > 0";
  EXPECT_EQ(MessageOf([] { StickRadiusRatio(0.0, 0.0); }), no_force);
  EXPECT_EQ(MessageOf([] { SlipAreaFraction(0.0, 0.0); }), no_force);
}

TEST(MindlinInput, RefusesAForceThatTheContactCannotCarry) {
  EXPECT_EQ(MessageOf([] { MindlinVirginDisplacement(kLaboratory, 31.0); }),
            "tangential force [N] = 31 is invalid: must not exceed the slip force 30 N");
  EXPECT_EQ(MessageOf([] { StickRadiusRatio(-31.0, 30.0); }),
            "tangential force [N] = -31 is invalid: must not exceed the slip force 30 N");
  EXPECT_EQ(MessageOf([] { MindlinEnergyPerCycle(kLaboratory, 31.0); }),
            "peak force [N] = 31 is invalid: must be >= 0 and must not exceed the slip force 30 N");
  EXPECT_EQ(MessageOf([] { MindlinEnergyPerCycle(kLaboratory, -1.0); }),
            "peak force [N] = -1 is invalid: must be >= 0 and must not exceed the slip force 30 N");
  EXPECT_EQ(MessageOf([] { MindlinUnloadingDisplacement(kLaboratory, -21.0, 20.0); }),
            "tangential force [N] = -21 is invalid: must not exceed the peak force 20 N");
  EXPECT_EQ(MessageOf([] { MindlinVirginDisplacement(kLaboratory, std::nan("")); }),
            "tangential force [N] = nan is invalid: must not exceed the slip force 30 N");
}

TEST(MindlinInput, RefusesADisplacementOffTheLoop) {
  EXPECT_EQ(
      MessageOf([] { MindlinUnloadingForce(kLaboratory, 2e-7, 1e-7); }),
      "displacement [m] = 2e-07 is invalid: must not exceed the displacement amplitude 1e-07 m");
  EXPECT_EQ(MessageOf([] { MindlinReloadingForce(kLaboratory, 0.0, -1e-7); }),
            "displacement amplitude [m] = -1e-07 is invalid: must be finite and >= 0");
  EXPECT_EQ(MessageOf([] { MindlinEnergyPerCycleAtAmplitude(kLaboratory, std::nan("")); }),
            "displacement amplitude [m] = nan is invalid: must be finite and >= 0");
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
