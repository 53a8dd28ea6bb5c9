#include "mindahl/contact/cattaneo_mindlin.h"

#include "printed_equations.h"
#include "support/prelude.h"

namespace mindahl::contact::cattaneo_mindlin_test {
namespace {

using printed::ErrorInUlps;
using printed::Real;

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

const MindlinContact kLaboratory{
    .contact_radius = 2.7e-3, .tangential_compliance = 4.42e-11, .slip_force = 30.0};
// The paper's contact, one of atomic force microscopy and one of a fault.
const std::array<MindlinContact, 3> kContacts = {
    {kLaboratory, {3.1e-9, 7.3e-11, 1.7e-12}, {2.3e3, 1.13e-10, 3.7e12}}};

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
  return fractions;
}

// The bounds below are those of the headers. They count half an ulp a rounding, up to 4 ulp for
// cbrt (the GNU C library's own bound), and what each does to the result.
constexpr double kVirginForceUlps = 6.0;      // eleven roundings
constexpr double kUnloadingForceUlps = 18.0;  // one force up to T*, twice one up to T*

TEST(MindlinAccuracy, VirginForceIsOddAndKeepsItsDigitsAtBothEnds) {
  std::vector<double> fractions = FractionsOfALimit();
  fractions.insert(fractions.end(), {1.0 + kEpsilon, 1.2, 1e12});
  for (const MindlinContact& contact : kContacts) {
    for (const double fraction : fractions) {
      const double displacement = fraction * GrossSlipDisplacement(contact);
      EXPECT_LE(ErrorInUlps(MindlinVirginForce(contact, displacement),
                            printed::Contact(contact).VirginForce(Real(displacement))),
                kVirginForceUlps)
          << fraction;
      EXPECT_EQ(MindlinVirginForce(contact, -displacement),
                -MindlinVirginForce(contact, displacement));
    }
  }
}

TEST(MindlinAccuracy, UnloadingAndReloadingForcesAreThoseOfTheLoop) {
  for (const MindlinContact& contact : kContacts) {
    const printed::Contact exact(contact);
    for (const double fraction : FractionsOfALimit()) {
      const double amplitude = fraction * GrossSlipDisplacement(contact);
      const Real peak = exact.VirginForce(Real(amplitude));
      for (const double share : {1.0, 0.999999, 0.7, 0.1, 1e-9, 0.0, -0.3, -0.97, -1.0}) {
        const double displacement = share * amplitude;
        EXPECT_LE(ErrorInUlps(MindlinUnloadingForce(contact, displacement, amplitude),
                              exact.UnloadingForce(Real(displacement), peak), peak),
                  kUnloadingForceUlps)
            << fraction << ' ' << share;
        EXPECT_LE(ErrorInUlps(MindlinReloadingForce(contact, displacement, amplitude),
                              exact.ReloadingForce(Real(displacement), peak, -1), peak),
                  kUnloadingForceUlps)
            << fraction << ' ' << share;
      }
    }
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

TEST(MindlinVirginCurve, HasAFiniteForceAtTheSmallestAndLargestDisplacement) {
  const MindlinContact& contact = kLaboratory;
  EXPECT_EQ(MindlinVirginForce(contact, 0.0), 0.0);
  EXPECT_GE(MindlinVirginForce(contact, std::numeric_limits<double>::denorm_min()), 0.0);
  EXPECT_EQ(MindlinVirginForce(contact, std::numeric_limits<double>::max()), contact.slip_force);
  EXPECT_EQ(MindlinUnloadingForce(contact, -std::numeric_limits<double>::max(),
                                  std::numeric_limits<double>::max()),
            -contact.slip_force);
}

TEST(MindlinInput, NamesTheMemberOfTheContactThatIsWrong) {
  const auto refusal = [](const MindlinContact& contact) {
    return MessageOf([&] { GrossSlipDisplacement(contact); });
  };
  EXPECT_EQ(refusal({0.0, 4e-11, 30.0}),
            "contact radius [m] = 0 is invalid: must be finite and > 0");
  EXPECT_EQ(refusal({1e-3, -1.0, 30.0}),
            "tangential compliance [1/Pa] = -1 is invalid: must be finite and > 0");
  EXPECT_EQ(refusal({1e-3, 4e-11, std::nan("")}),
            "slip force [N] = nan is invalid: must be finite and > 0");
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
