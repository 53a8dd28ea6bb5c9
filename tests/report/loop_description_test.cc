#include "mindahl/report/loop_description.h"

#include "mindahl/models/steady_loop.h"
#include "report/made_report.h"
#include "support/prelude.h"

// The steady loop of a fitted law: its energy and whether it slips, with the rig's travel taken
// off.
namespace mindahl::report::loop_description_test {
namespace {

using namespace loop;
using namespace models;
using namespace identification;

using report::DescribeLoop;
using report::LoopDescription;
using report::SlipRegime;
using testing::kSlipForce;

// Bisection ends at 1e-15 of the amplitude; the energy varies up to three times as fast.
constexpr double kBisection = 1e-14;

const BranchLaw kMindlin = {kSigma, 1.0 / 3, kSlipForce};

LoopDescription Describe(const BranchLaw& law, double amplitude,
                         double rig = std::numeric_limits<double>::infinity()) {
  FitResult fit = MadeFit({MadeRecord(amplitude)}, amplitude, law);
  fit.rig.stiffness = rig;
  return DescribeLoop(fit);
}

TEST(LoopDescription, TakesTheTravelOfTheRigOffTheAmplitude) {
  const FrictionModel& model = *FindFrictionModel("mindlin-dahl");
  for (const double contact : {0.4e-6, 1.2e-6, 1.5e-6, 2.5e-6}) {
    SCOPED_TRACE(contact);
    const double rig = 3e7;
    // δ = x + T/k_r at the extreme of the loop.
    const double whole = contact + SteadyPeakForce(model, kMindlin, contact) / rig;
    const LoopDescription loop = Describe(kMindlin, whole, rig);
    EXPECT_NEAR(loop.contact_amplitude / contact, 1, kBisection);
    // A spring keeps no energy: the loop of contact and rig has that of the contact.
    EXPECT_NEAR(loop.model_energy / SteadyLoopEnergy(model, kMindlin, contact), 1, 4 * kBisection);
    EXPECT_LT(loop.model_energy, 0.9 * SteadyLoopEnergy(model, kMindlin, whole))
        << "or the rig's travel would not show";
  }
}

TEST(LoopDescription, LeavesOpenWhetherALoopSlipsThatFitsAnyLargerSlipForce) {
  for (const double amplitude : {1.4e-6, 1.6e-6}) {
    SCOPED_TRACE(amplitude);
    FitResult fit = MadeFit({MadeRecord(amplitude)}, amplitude, kMindlin);
    fit.parameters[2].identifiability = Identifiability::kBoundedBelow;
    const bool reaches_the_limit = amplitude > 1.5e-6;
    const LoopDescription loop = DescribeLoop(fit);
    EXPECT_EQ(loop.regime.has_value(), !reaches_the_limit);
    EXPECT_EQ(loop.stick_radius_ratio.has_value(), !reaches_the_limit);
  }
}

TEST(LoopDescription, ALoopThatIsSeenToSlideSlipsWhateverTheLawSays) {
  constexpr double kAmplitude = 1.0e-6;  // two thirds of the law's gross slip
  FitResult fit = MadeFit({MadeRecord(kAmplitude)}, kAmplitude, kMindlin);
  EXPECT_EQ(DescribeLoop(fit).regime, SlipRegime::kPartial);
  LoopFacts& facts = fit.records[0].facts;
  facts.closed = true;
  facts.amplitude = kAmplitude;
  facts.peak_force = 30.0;
  facts.energy_ratio = 0.9;
  facts.energy_per_cycle = 0.9 * 4 * kAmplitude * 30.0;
  facts.sliding_fraction = 0.97;
  const LoopDescription loop = DescribeLoop(fit);
  EXPECT_EQ(loop.regime, SlipRegime::kGross);
  EXPECT_EQ(loop.stick_radius_ratio, 0.0);
  EXPECT_EQ(loop.sliding_fraction, 0.97);
  EXPECT_FALSE(loop.gross_slip_displacement) << "at an amplitude that was not reached";
  fit.parameters[2].identifiability = Identifiability::kNotIdentifiable;
  EXPECT_EQ(DescribeLoop(fit).regime, SlipRegime::kGross);
}

TEST(LoopDescription, JudgesTheSlipByTheContactsOwnAmplitude) {
  // δc = 1.5 µm; a rig of 3e7 N/m gives way by Tc/k_r = 1.33 µm under Tc.
  EXPECT_EQ(Describe(kMindlin, 1.6e-6).regime, SlipRegime::kGross);
  EXPECT_EQ(Describe(kMindlin, 1.6e-6, 3e7).regime, SlipRegime::kPartial);
  EXPECT_EQ(Describe(kMindlin, 2.7e-6, 3e7).regime, SlipRegime::kPartial);
  EXPECT_EQ(Describe(kMindlin, 2.9e-6, 3e7).regime, SlipRegime::kGross);
}

TEST(LoopDescription, LimitsOfDahlsOwnLawAreItsOwn) {
  // Its steady loop slips from 2^−α·δc on, 1.19 µm.
  const auto regime = [](double amplitude) {
    FitResult fit = MadeFit({MadeRecord(amplitude)}, amplitude, kMindlin);
    fit.model = FindFrictionModel("dahl");
    return DescribeLoop(fit);
  };
  EXPECT_EQ(regime(1.17e-6).regime, SlipRegime::kPartial);
  EXPECT_EQ(regime(1.21e-6).regime, SlipRegime::kGross);
  EXPECT_NEAR(*regime(1.21e-6).gross_slip_displacement / 1.5e-6, std::exp2(-1.0 / 3), kBisection);
}

TEST(LoopDescription, EnergyRatioOfSlipHasTheTravelOfTheRigInIt) {
  constexpr double kRounding = 1e-13;
  EXPECT_NEAR(*Describe(kMindlin, 1.6e-6).gross_slip_energy_ratio, 0.2, kRounding);
  // 40 N on 3e7 N/m beside δc = 1.5 µm.
  EXPECT_NEAR(*Describe(kMindlin, 1.6e-6, 3e7).gross_slip_energy_ratio,
              0.2 * 1.5e-6 / (1.5e-6 + 40 / 3e7), kRounding);
}

TEST(LoopDescription, RigidRigTakesNothing) {
  EXPECT_EQ(Describe(kMindlin, 1.1e-6).contact_amplitude, 1.1e-6);
}

TEST(LoopDescription, StickRadiusIsThatOfMindlinsContact) {
  // c/a = (1 − T/Tc)^{1/3}, and T/Tc = 1 − (1 − X/δc)^{3/2}: c/a = √(1 − X/δc).
  const double epsilon = std::numeric_limits<double>::epsilon();
  EXPECT_NEAR(*Describe(kMindlin, 0.6e-6).stick_radius_ratio, std::sqrt(1 - 0.6 / 1.5),
              8 * epsilon);
  EXPECT_EQ(Describe(kMindlin, 1.6e-6).stick_radius_ratio, 0.0);
}

TEST(LoopDescription, ReportsSlipOnlyAsMeasured) {
  const auto describe = [](const char* open, Identifiability verdict) {
    FitResult fit = MadeFit({MadeRecord(1.6e-6)}, 1.6e-6, kMindlin);
    for (ParameterEstimate& estimate : fit.parameters) {
      if (estimate.name == open) estimate.identifiability = verdict;
    }
    return DescribeLoop(fit);
  };
  for (const char* open : {"sigma", "alpha", "slip_force"}) {
    const LoopDescription loop = describe(open, Identifiability::kNotIdentifiable);
    EXPECT_FALSE(loop.knows_slip) << open;
    EXPECT_FALSE(loop.gross_slip_displacement) << open;
    EXPECT_FALSE(loop.gross_slip_energy_ratio) << open;
    // A slip force that is known is reached or not, whatever the way there.
    EXPECT_EQ(loop.regime.has_value(), std::string(open) != "slip_force") << open;
    EXPECT_EQ(loop.stick_radius_ratio.has_value(), loop.regime.has_value()) << open;
  }
  const LoopDescription bounded = describe("slip_force", Identifiability::kBoundedBelow);
  EXPECT_FALSE(bounded.regime) << "any larger slip force fits as well";
  EXPECT_FALSE(bounded.gross_slip_displacement);
  EXPECT_TRUE(describe("slip_force", Identifiability::kExtrapolated).gross_slip_displacement);
}

// A law with α = 1 has T = Tc(1 − e^{−σX/Tc}), so that a share s is reached at X = −ln(1 − s)·Tc/σ.
double AmplitudeOfShare(double share) { return -std::log1p(-share) * kSlipForce / kSigma; }

TEST(LoopDescription, LawThatOnlyApproachesSlipSlipsFromNinetyNinePerCentOn) {
  const BranchLaw dahl = {kSigma, 1.0, kSlipForce};
  for (const double share : {0.5, 0.9, 0.95, 0.985, 0.9899}) {
    EXPECT_EQ(Describe(dahl, AmplitudeOfShare(share)).regime, SlipRegime::kPartial) << share;
  }
  for (const double share : {0.9901, 0.995, 0.9999}) {
    EXPECT_EQ(Describe(dahl, AmplitudeOfShare(share)).regime, SlipRegime::kGross) << share;
  }
  EXPECT_FALSE(Describe(dahl, AmplitudeOfShare(0.995)).gross_slip_displacement);
  constexpr double kRounding = 1e-14;
  EXPECT_NEAR(Describe(dahl, AmplitudeOfShare(0.95)).slip_force_share, 0.95, kRounding);
}

TEST(LoopDescription, EnergyRatioUsesTheMeasuredEnergyWhereThereIsOne) {
  FitResult fit = MadeFit({MadeRecord(1e-6)}, 1e-6);
  const LoopMeasures& measures = fit.records[0].measures;
  constexpr double kRounding = 1e-15;
  EXPECT_NEAR(*DescribeLoop(fit).energy_ratio,
              DescribeLoop(fit).model_energy / (4 * measures.amplitude * measures.peak_force),
              kRounding);
  fit.records[0].measures.energy_per_cycle = 8e-6;
  EXPECT_NEAR(*DescribeLoop(fit).energy_ratio, 8e-6 / (4 * 1e-6 * measures.peak_force), kRounding);
  fit.records[0].measures.peak_force = 0;
  EXPECT_FALSE(DescribeLoop(fit).energy_ratio);
}

TEST(LoopDescription, IsMeasuredOnTheWidestSteadyCyclesWhereOneIsClosed) {
  FitResult fit = MadeFit({MadeRecord(1e-6)}, 1e-6);
  fit.records[0].measures.energy_per_cycle = 8e-6;
  fit.records[0].facts.amplitude = 1.5e-6;
  fit.records[0].facts.peak_force = 20.0;
  fit.records[0].facts.energy_per_cycle = 6e-6;
  EXPECT_EQ(DescribeLoop(fit).measured.amplitude, 1e-6);
  fit.records[0].facts.closed = true;
  const LoopDescription loop = DescribeLoop(fit);
  EXPECT_EQ(loop.measured.amplitude, 1.5e-6);
  EXPECT_EQ(loop.contact_amplitude, 1.5e-6);
  EXPECT_EQ(loop.measured.peak_force, 20.0);
  EXPECT_EQ(loop.measured.energy, 6e-6);
  EXPECT_DOUBLE_EQ(*loop.energy_ratio, 6e-6 / (4 * 1.5e-6 * 20.0));
}

TEST(LoopDescription, EnergyOfTheLawIsThatOfTheWidestCyclesAlone) {
  FitResult fit = MadeFit({MadeRecord(1e-6)}, 1e-6);
  fit.records[0].facts.cycles.resize(3);
  fit.records[0].facts.cycles[0].steady = fit.records[0].facts.cycles[2].steady = true;
  fit.records[0].law_energy = {2e-6, 11e-6, 4e-6};
  EXPECT_DOUBLE_EQ(DescribeLoop(fit).model_energy, 3e-6);
}

}  // namespace
}  // namespace mindahl::report::loop_description_test
