// Where the paper (Peyret et al. 2017) prints something that cannot hold, each test shows first
// that the printed form fails and then that the one used here does not. See docs/theory.md §3.

#include "mindahl/contact/cattaneo_mindlin.h"
#include "mindahl/contact/mindlin_dahl_mapping.h"
#include "printed_equations.h"
#include "support/prelude.h"

namespace mindahl::contact::errata_test {
namespace {

using printed::Real;

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

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
}  // namespace mindahl::contact::errata_test
