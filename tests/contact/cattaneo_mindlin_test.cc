#include "mindahl/contact/cattaneo_mindlin.h"

#include "mindahl/contact/mindlin_dahl_mapping.h"
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

// ---
// These tests concern the misprints of the paper (Peyret et al. 2017). Each shows that the printed
// form fails and that the form used here holds. See docs/theory.md §3.

// The parameters of the paper's §3.
constexpr double kContactRadius = 0.0027;           // [m]
constexpr double kTangentialCompliance = 4.42e-11;  // [1/Pa]
constexpr double kSlipForce = 0.3 * 100.0;          // μN [N]
constexpr double kPrintedStiffness = 4.839e8;       // [N/m]
const MindlinContact kPaper{.contact_radius = kContactRadius,
                            .tangential_compliance = kTangentialCompliance,
                            .slip_force = kSlipForce};

TEST(Errata, Equation15NeedsTheMinusSign) {
  const printed::Contact exact(kPaper);
  const double peak = 0.7 * kSlipForce;
  const auto amplitude = static_cast<double>(exact.VirginDisplacement(Real(peak)));
  constexpr double kRounding = 1e-12;  // far above the rounding of δ*, far below what is at stake
  for (const double share : {-1.0, -0.8, -0.1, 0.3, 0.9, 1.0}) {
    const double displacement =
        static_cast<double>(exact.ReloadingDisplacement(Real(share * peak), Real(peak)));
    // Eq. 9, which is printed right, is the inverse.
    EXPECT_NEAR(MindlinReloadingForce(kPaper, displacement, amplitude) / peak, share, kRounding);
    EXPECT_GT(std::abs(static_cast<double>(
                           exact.ReloadingForce(Real(displacement), Real(peak), +1) / peak) -
                       share),
              0.05);
  }
}

TEST(Errata, Equation19ExponentIsOneThird) {
  const double stiffness = MindlinTangentialStiffness(kContactRadius, kTangentialCompliance);
  const double onset = GrossSlipDisplacement(kPaper);
  // f''' = −σ/(4δc²)·(1 − δ/δc)^{−3/2}: with steps of 1e-5·δc the difference errs by less than
  // 4e-10·σ up to δ = 0.95·δc, and the rounding of the forces adds less than 1e-10·σ.
  const double step = 1e-5 * onset;
  constexpr double kCentralDifference = 1e-8;
  for (const double share : {0.05, 0.3, 0.6, 0.95}) {
    const double at = share * onset;
    const double slope =
        (MindlinVirginForce(kPaper, at + step) - MindlinVirginForce(kPaper, at - step)) /
        (2.0 * step);
    const double remaining = 1.0 - MindlinVirginForce(kPaper, at) / kSlipForce;
    EXPECT_NEAR(slope / stiffness, std::cbrt(remaining), kCentralDifference);
    EXPECT_GT(std::abs(slope / stiffness - std::sqrt(remaining)), 0.01);
  }
  EXPECT_EQ(MapMindlinToDahl(kPaper).shape_exponent, 1.0 / 3.0);
}

TEST(Errata, Equation23GrossSlipAt16aNot12a) {
  const double with_16a = 3.0 * kSlipForce * kTangentialCompliance / (16.0 * kContactRadius);
  EXPECT_NEAR(GrossSlipDisplacement(kPaper) / with_16a, 1.0, 4.0 * kEpsilon);
  // Eq. 6 reaches Tc at 16a.
  EXPECT_NEAR(
      static_cast<double>(printed::Contact(kPaper).VirginDisplacement(Real(kSlipForce))) / with_16a,
      1.0, 4.0 * kEpsilon);
  // The paper's micro-slip case, λ = 0.8, would slip grossly with 12a: 0.8·16/12 > 1.
  EXPECT_EQ(MindlinVirginForce(kPaper, 0.8 * 16.0 / 12.0 * with_16a), kSlipForce);
  EXPECT_LT(MindlinVirginForce(kPaper, 0.999 * with_16a), kSlipForce);
}

TEST(Errata, PrintedContactRadiusIsRoundedByOnePercentOfStiffness) {
  const double of_printed_radius =
      MindlinTangentialStiffness(kContactRadius, kTangentialCompliance);
  // 8·0.0027/4.42e-11 = 4.8869e8 where the paper has 4.839e8.
  EXPECT_NEAR(of_printed_radius, 4.8869e8, 0.00005e8);  // half a unit of the last digit
  EXPECT_GT(of_printed_radius / kPrintedStiffness - 1.0, 0.009);
  EXPECT_LT(of_printed_radius / kPrintedStiffness - 1.0, 0.010);

  const double radius =
      *IdentifyContact(ContactQuantity::kContactRadius, kPrintedStiffness, kSlipForce,
                       {.tangential_compliance = kTangentialCompliance});
  EXPECT_NEAR(radius, 2.6735e-3, 0.00005e-3);                 // half a unit of the last digit
  EXPECT_EQ(std::round(radius * 1e4) / 1e4, kContactRadius);  // two digits, as printed
}

}  // namespace
}  // namespace mindahl::contact::cattaneo_mindlin_test
