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

/// dy/dx by central difference, of error (step·x)²·y'''/6.
template <typename Function>
double Slope(Function function, double x, double step) {
  return (function(x + step) - function(x - step)) / (2.0 * step);
}

TEST(Errata, Equation15NeedsTheMinusSign) {
  const printed::Contact exact(kPaper);
  const double peak = 0.7 * kSlipForce;
  const auto amplitude = static_cast<double>(exact.VirginDisplacement(Real(peak)));

  // Reloading runs from −T* at −δ* to T* at δ*. As printed it starts at T* and ends at −T*.
  constexpr double kRounding = 1e-12;  // far above the rounding of δ*, far below what is at stake
  const double printed_start =
      static_cast<double>(exact.ReloadingForce(Real(-amplitude), Real(peak), +1) / peak);
  const double printed_end =
      static_cast<double>(exact.ReloadingForce(Real(amplitude), Real(peak), +1) / peak);
  EXPECT_NEAR(printed_start, 1.0, kRounding);
  EXPECT_NEAR(printed_end, -1.0, kRounding);
  EXPECT_NEAR(MindlinReloadingForce(kPaper, -amplitude, amplitude) / peak, -1.0, kRounding);
  EXPECT_NEAR(MindlinReloadingForce(kPaper, amplitude, amplitude) / peak, 1.0, kRounding);

  for (const double share : {-0.8, -0.1, 0.3, 0.9}) {
    const double force = share * peak;
    const double displacement =
        static_cast<double>(exact.ReloadingDisplacement(Real(force), Real(peak)));
    // Eq. 9, which is printed right, is the inverse.
    EXPECT_NEAR(MindlinReloadingForce(kPaper, displacement, amplitude) / peak, share, kRounding);
    EXPECT_GT(std::abs(static_cast<double>(
                           exact.ReloadingForce(Real(displacement), Real(peak), +1) / peak) -
                       share),
              0.05);
    // The two branches are one another's image through the origin.
    EXPECT_EQ(MindlinReloadingForce(kPaper, displacement, amplitude),
              -MindlinUnloadingForce(kPaper, -displacement, amplitude));
    // The slope is positive, as in eq. 18; the derivative of eq. 15 as printed is negative.
    const double step = 1e-4 * amplitude;
    EXPECT_GT(Slope([&](double x) { return MindlinReloadingForce(kPaper, x, amplitude); },
                    displacement, step),
              0.0);
    EXPECT_LT(Slope(
                  [&](double x) {
                    return static_cast<double>(exact.ReloadingForce(Real(x), Real(peak), +1));
                  },
                  displacement, step),
              0.0);
  }
}

TEST(Errata, Equation19ExponentIsOneThird) {
  const double stiffness = MindlinTangentialStiffness(kContactRadius, kTangentialCompliance);
  const double onset = GrossSlipDisplacement(kPaper);
  // f''' = −σ/(4δc²)·(1 − δ/δc)^{−3/2}: with steps of 1e-5·δc the difference errs by less than
  // 4e-10·σ up to δ = 0.95·δc, and the rounding of the forces adds less than 1e-10·σ.
  constexpr double kStep = 1e-5;
  constexpr double kCentralDifference = 1e-8;
  for (const double share : {0.05, 0.3, 0.6, 0.95}) {
    const double displacement = share * onset;
    const double slope =
        Slope([](double x) { return MindlinVirginForce(kPaper, x); }, displacement, kStep * onset);
    const double remaining = 1.0 - MindlinVirginForce(kPaper, displacement) / kSlipForce;
    EXPECT_NEAR(slope / stiffness, std::cbrt(remaining), kCentralDifference);
    EXPECT_GT(std::abs(slope / stiffness - std::sqrt(remaining)), 0.01);
  }
  EXPECT_EQ(MapMindlinToDahl(kPaper).shape_exponent, 1.0 / 3.0);
}

TEST(Errata, Equation23GrossSlipAt16aNot12a) {
  const double with_12a = 3.0 * kSlipForce * kTangentialCompliance / (12.0 * kContactRadius);
  const double with_16a = 3.0 * kSlipForce * kTangentialCompliance / (16.0 * kContactRadius);
  EXPECT_NEAR(GrossSlipDisplacement(kPaper) / with_16a, 1.0, 4.0 * kEpsilon);

  // Eq. 6 reaches Tc at 16a.
  EXPECT_NEAR(
      static_cast<double>(printed::Contact(kPaper).VirginDisplacement(Real(kSlipForce))) / with_16a,
      1.0, 4.0 * kEpsilon);
  // dδ = dT/(σ(1 − T/Tc)^{1/3}) from 0 to Tc, by midpoints in s³ = 1 − T/Tc: ∫ 3s ds·Tc/σ.
  constexpr int kIntervals = 1000;
  double quadrature = 0.0;
  for (int interval = 0; interval < kIntervals; ++interval) {
    quadrature += 3.0 * ((interval + 0.5) / kIntervals) / kIntervals;
  }
  quadrature *= kSlipForce * kTangentialCompliance / (8.0 * kContactRadius);
  // The midpoint rule is exact for a straight line; a thousand additions round by at most 1000 ulp.
  EXPECT_NEAR(GrossSlipDisplacement(kPaper) / quadrature, 1.0, kIntervals * kEpsilon);

  // The paper's micro-slip case, λ = 0.8, would slip grossly with 12a: 0.8·16/12 > 1.
  EXPECT_EQ(MindlinVirginForce(kPaper, 0.8 * with_12a), kSlipForce);
  EXPECT_LT(MindlinVirginForce(kPaper, 0.8 * with_16a), kSlipForce);
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

TEST(Errata, Equation20IsEquation10OfOtherParameters) {
  // After eq. 20 the paper calls it equivalent to eq. 10 with σ = 8a/G* and α = 1/3. It is that
  // law, but of σ' = σ(1 − T*/2Tc)^α and Tc' = 2Tc − T*.
  const models::BranchLaw law = MapMindlinToDahl(kPaper);
  const double alpha = law.shape_exponent;
  // The smallest base, 0.05 at T = 0.9·T* = 0.9·Tc, loses 20 ε; a power of 1/3 leaves a third of
  // it.
  constexpr double kRounding = 64.0 * kEpsilon;
  for (const double peak_share : {0.1, 0.5, 0.9, 1.0}) {
    const double peak = peak_share * kSlipForce;
    const double stiffness =
        law.tangential_stiffness * std::pow(1.0 - peak / (2.0 * kSlipForce), alpha);
    const double slip_force = 2.0 * kSlipForce - peak;
    double printed_error = 0.0;
    for (const double share : {-0.9, -0.5, 0.0, 0.5, 0.9}) {
      const double along = share * peak;  // sT
      const double slope =
          law.tangential_stiffness * std::pow(1.0 - (peak + along) / (2.0 * kSlipForce), alpha);
      EXPECT_NEAR(stiffness * std::pow(1.0 - along / slip_force, alpha) / slope, 1.0, kRounding);
      const double as_printed =
          law.tangential_stiffness * std::pow(1.0 - along / kSlipForce, alpha);
      printed_error = std::max(printed_error, std::abs(as_printed / slope - 1.0));
    }
    EXPECT_GT(printed_error, 0.02);
  }
}

TEST(Errata, SlipAnnulusNeverExceedsTheContactItIsPartOf) {
  // §2.1 sets micro-slip apart from partial slip by A_s < A_c for both. With A_c the area of the
  // contact, as it is defined there, A_s > A_c cannot be meant either: A_s/A_c = 1 − (c/a)² with
  // c/a = (1 − T/Tc)^{1/3} is δ/δc. Against the stick area πc² there is a boundary: A_s exceeds it
  // once c/a < 1/√2, which is at T/Tc = 1 − 2^{−3/2} and δ = δc/2.
  constexpr double kRounding = 16.0 * kEpsilon;
  const double boundary = (1.0 - 0.25 * std::numbers::sqrt2) * kSlipForce;
  EXPECT_NEAR(MindlinVirginForce(kPaper, 0.5 * GrossSlipDisplacement(kPaper)) / boundary, 1.0,
              kRounding);
  const printed::Contact exact(kPaper);
  for (const double share : {1e-6, 0.3, 0.64, 0.65, 0.9, 1.0 - 1e-6}) {
    const Real slip_area =
        exact.VirginDisplacement(Real(share * kSlipForce)) / exact.GrossSlipDisplacement();
    EXPECT_LT(slip_area, 1);
    EXPECT_EQ(slip_area < 0.5, share * kSlipForce < boundary);
  }
}

// No erratum, but easily misread: §2.3 takes the loop for four times the energy that the first
// loading dissipates. That is right, and is not four times its work.
TEST(MindlinEnergy, IsFourTimesDissipationOfFirstLoading) {
  const double amplitude = 0.8 * GrossSlipDisplacement(kPaper);
  const double peak = MindlinVirginForce(kPaper, amplitude);
  // The midpoint rule errs by less than the step squared times the change of slope, (1/20000)²
  // = 2.5e-9 of T*·δ*, which is about twice the loop; four and eight times that enter below.
  constexpr int kIntervals = 20000;
  constexpr double kMidpointRule = 1e-7;
  double work = 0.0;
  double loop = 0.0;
  for (int interval = 0; interval < kIntervals; ++interval) {
    const double share = (interval + 0.5) / kIntervals;
    work += MindlinVirginForce(kPaper, share * amplitude) * amplitude / kIntervals;
    const double displacement = (2.0 * share - 1.0) * amplitude;
    loop += (MindlinReloadingForce(kPaper, displacement, amplitude) -
             MindlinUnloadingForce(kPaper, displacement, amplitude)) *
            2.0 * amplitude / kIntervals;
  }
  const auto energy = static_cast<double>(printed::Contact(kPaper).EnergyPerCycle(Real(peak)));
  EXPECT_NEAR(energy / loop, 1.0, kMidpointRule);

  // Four times the work of the first loading is several times the loop; of what that loading
  // dissipates, 2∫T dδ − T*δ*, it is the loop.
  EXPECT_GT(4.0 * work / energy, 3.0);
  EXPECT_NEAR(4.0 * (2.0 * work - peak * amplitude) / energy, 1.0, kMidpointRule);
}

}  // namespace
}  // namespace mindahl::contact::errata_test
