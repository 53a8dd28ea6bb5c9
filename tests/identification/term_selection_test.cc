#include "mindahl/identification/term_selection.h"

#include "recovery/recovered.h"
#include "support/measured.h"
#include "support/prelude.h"

// Which terms SelectTerms adds to the law of records whose terms are known.
namespace mindahl::identification::term_selection_test {
namespace {

constexpr BranchLaw kLaw{5e7, 0.4, 60.0};
constexpr double kReach = 6e-6;  // 3 of gross slip
constexpr double kCycles = 8.3;
constexpr int kSamplesPerCycle = 120;
constexpr double kPeriod = 1.0;  // [s]
constexpr double kNoise = 0.2;   // [N], 1/300 of Tc
/// An estimate lies within this many of its standard errors: beyond it once in 10⁷.
constexpr double kStandardErrors = 5.3;

double SpeedAt(std::size_t i) {
  const double rate = 2 * std::numbers::pi / kPeriod;
  return kReach * rate * std::cos(rate * kPeriod * static_cast<double>(i) / kSamplesPerCycle);
}

Record Clean() {
  return Timed(LoopOf(kLaw, Cycling(Wave::kSine, kReach, kCycles, kSamplesPerCycle)),
               kPeriod / kSamplesPerCycle);
}

constexpr double kFastest = kReach * 2 * std::numbers::pi / kPeriod;  // [m/s]

/// A loop beside forces of the speed and of the position, over Tc at their largest.
Record With(double of_speed, double of_position) {
  Record record = Clean();
  for (std::size_t i = 0; i < record.size(); ++i) {
    record.force[i] += kLaw.slip_force * (of_speed * SpeedAt(i) / kFastest +
                                          of_position * record.displacement[i] / kReach);
  }
  return record;
}

Record Noisy(const Record& record, std::uint64_t seed) {
  Generator generator(seed);
  return WithForceNoise(record, kNoise, generator);
}

TermSelection Select(const Record& record, const FitOptions& options = {}) {
  const RecordView view(record);
  return SelectTerms({&view, 1}, options, FitOne(record, options));
}

const ConsideredTerm& TermOf(const TermSelection& selection, std::string_view name) {
  return *std::ranges::find(selection.considered, name, &ConsideredTerm::name);
}

TEST(TermSelection, AdequateLoopGetsNoTermAndKeepsEveryDigit) {
  const Record record = Noisy(Clean(), 1);
  const TermSelection selection = Select(record);
  ASSERT_EQ(selection.fit.adequacy.verdict, AdequacyVerdict::kAdequate);
  EXPECT_THAT(selection.added, IsEmpty());
  EXPECT_THAT(selection.considered, IsEmpty());
  const FitResult plain = Fit(std::vector{record}, {}, Depth::kFull);
  ASSERT_EQ(selection.fit.parameters.size(), plain.parameters.size());
  for (std::size_t i = 0; i < plain.parameters.size(); ++i) {
    EXPECT_EQ(selection.fit.parameters[i].value, plain.parameters[i].value);
    EXPECT_EQ(selection.fit.parameters[i].upper95, plain.parameters[i].upper95);
  }
}

TEST(TermSelection, TermsDoNotTakeThePlaceOfALawShortOfSlip) {
  // Friction of a guide beside a loop that reaches slip only: all common terms together, or a slip
  // force of the position, describe it with a spring in place of half of Tc and more.
  for (const double reach : {0.95, 1.05, 1.2}) {
    const double amplitude = reach * GrossSlipDisplacement(kLaw);
    Record record = Timed(LoopOf(kLaw, Cycling(Wave::kSine, amplitude, 3.5, 100)), 0.01);
    for (std::size_t i = 0; i < record.size(); ++i) {
      const double speed = std::cos(2 * std::numbers::pi * static_cast<double>(i) / 100);
      record.force[i] += 0.04 * kLaw.slip_force * std::tanh(speed / 0.01);
    }
    const TermSelection selection = Select(Noisy(record, 6));
    SCOPED_TRACE(reach);
    EXPECT_THAT(selection.added, Not(Contains("slip_position_quadratic")));
    const ParameterEstimate& slip_force = *selection.fit.Find("slip_force");
    EXPECT_LT(slip_force.lower95.value_or(0.0), kLaw.slip_force);
    EXPECT_GT(slip_force.upper95.value_or(1e9), kLaw.slip_force);
  }
}

TEST(TermSelection, ViscousForceIsAddedAloneAndRecovered) {
  const double viscous = 0.1 * kLaw.slip_force / kFastest;
  const TermSelection selection = Select(Noisy(With(0.1, 0.0), 2));
  EXPECT_THAT(selection.added, ElementsAre("viscous"));
  const ParameterEstimate& estimate = *selection.fit.Find("viscous");
  // Central differences of a sine take the rate for sin(ωΔt)/(ωΔt) of it.
  const double step = 2 * std::numbers::pi / kSamplesPerCycle;
  const double bias = viscous * (1 - std::sin(step) / step);
  EXPECT_NEAR(estimate.value, viscous, kStandardErrors * *estimate.standard_error + bias);

  const ConsideredTerm& term = TermOf(selection, "viscous");
  EXPECT_TRUE(term.added);
  // What is left is noise: of an rms of viscous force and noise before, Pythagoras.
  EXPECT_GT(term.gain, 0.5);
}

TEST(TermSelection, LargeViscousForceIsNotLeftToASlipForceOfTheSpeedAndADrag) {
  // It is two fifths of the half gap, which a slip force of the speed leaves to Tc; with a drag in
  // proportion to the speed that is the same curve with two parameters more.
  const TermSelection selection = Select(Noisy(With(0.6, 0.0), 12));
  EXPECT_THAT(selection.added, ElementsAre("viscous"));
  EXPECT_LT(selection.fit.rms, 1.2 * kNoise);
  const ParameterEstimate& slip_force = *selection.fit.Find("slip_force");
  EXPECT_NEAR(slip_force.value, kLaw.slip_force, kStandardErrors * *slip_force.standard_error);
  EXPECT_FALSE(TermOf(selection, "slip_speed").added);
}

TEST(TermSelection, ForceOfPositionThatClosesTheIntervalOfTheSlipForceIsAdded) {
  // A spring as stiff as Tc over the stroke makes the law's Tc an asymptote, open above.
  const Record noisy = Noisy(With(0.0, 1.0), 14);
  ASSERT_FALSE(Fit(std::vector{noisy}, {}).Find("slip_force")->upper95);
  const TermSelection selection = Select(noisy);
  EXPECT_THAT(selection.added, ElementsAre("plateau_slope"));
  const ParameterEstimate& slip_force = *selection.fit.Find("slip_force");
  EXPECT_NEAR(slip_force.value, kLaw.slip_force, kStandardErrors * *slip_force.standard_error);
}

TEST(TermSelection, TwoForcesAreAddedTheLargerFirst) {
  EXPECT_THAT(Select(Noisy(With(0.06, 0.2), 4)).added, ElementsAre("plateau_slope", "viscous"));
}

TEST(TermSelection, SlipForceOfTheSpeedIsAddedAndTcIsThatOfTheHalfGap) {
  Record record = Clean();
  for (std::size_t i = 0; i < record.size(); ++i) {
    record.force[i] *= 1 + 0.6 * (std::sqrt(std::abs(SpeedAt(i)) / kFastest) - 1);
  }
  const TermSelection selection = Select(Noisy(record, 8));
  ASSERT_THAT(selection.added, ::testing::Not(IsEmpty()));
  EXPECT_EQ(selection.added.front(), "slip_speed");
  // A third of the half gap is as much as a term may take from it or give to it.
  const double half_gap = *selection.fit.WidestRecord().facts.half_gap;
  EXPECT_GT(selection.fit.law.slip_force, half_gap / 1.5);
  EXPECT_LT(selection.fit.law.slip_force, half_gap * 1.5);
}

TEST(TermSelection, ForceOfSpeedThatWouldTakeTheSlipForceIsNotAdded) {
  // Most of the force is of speed: a slip force at rest is a quarter of the half gap. No one term
  // leaves but noise, for the waves.
  Record record = Clean();
  for (std::size_t i = 0; i < record.size(); ++i) {
    record.force[i] +=
        std::copysign(3 * kLaw.slip_force * std::sqrt(std::abs(SpeedAt(i)) / kFastest),
                      SpeedAt(i)) +
        0.05 * kLaw.slip_force * std::sin(9 * record.displacement[i] / kReach);
  }
  const TermSelection selection = Select(Noisy(record, 10));
  const double half_gap = *selection.fit.WidestRecord().facts.half_gap;
  EXPECT_GT(selection.fit.law.slip_force, half_gap / 1.25);
  EXPECT_LT(selection.fit.law.slip_force, half_gap * 1.25);
}

/// Matches the names of all common terms, in any order.
const auto kAllCommon = ::testing::UnorderedElementsAre(
    "slip_speed", "drag", "slip_trend", "slip_position_quadratic", "force_drift", "lag");

TEST(TermSelection, CommonTermsAreFittedTogetherWhereTwoLeaveMoreThanNoise) {
  Record record = With(0.0, 0.2);
  for (std::size_t i = 0; i < record.size(); ++i) {
    const double gone = static_cast<double>(i) / static_cast<double>(record.size());
    record.force[i] *= 1 + 0.2 * (std::sqrt(std::abs(SpeedAt(i)) / kFastest) - 1) + 0.1 * gone;
    record.force[i] += 0.1 * kLaw.slip_force * gone +
                       0.03 * kLaw.slip_force * std::sin(9 * record.displacement[i] / kReach);
  }
  const TermSelection selection = Select(Noisy(record, 15));
  EXPECT_THAT(selection.added, kAllCommon);
  EXPECT_TRUE(TermOf(selection, "drag").added);
  EXPECT_TRUE(TermOf(selection, "drag").obstacle.empty());
}

TEST(TermSelection, SealHasTheSameTermsAndSlipForceWithoutItsFirstRows) {
  auto rows = testing::ReadMeasured("seals/Stadium_1bar.csv", '\t');
  if (!rows) GTEST_SKIP() << "the measured records are not here";
  std::vector<double> slip_forces;
  for (const double left_out : {0.0, 0.07}) {
    const auto first = static_cast<std::ptrdiff_t>(left_out * static_cast<double>(rows->size()));
    const std::vector<std::vector<double>> some(rows->begin() + first, rows->end());
    Record record{.displacement = testing::Column(some, 4), .force = testing::Column(some, 6)};
    record.time = testing::Column(some, 0);
    for (double& place : record.displacement) place *= 1e-3;
    for (double& time : record.time) time *= 1e-3;
    const TermSelection selection = Select(record);
    EXPECT_THAT(selection.added, kAllCommon);
    EXPECT_EQ(selection.fit.adequacy.use, Use::kQuantitative);
    slip_forces.push_back(selection.fit.law.slip_force);
  }
  EXPECT_NEAR(slip_forces[1] / slip_forces[0], 1.0, 0.05);
}

TEST(TermSelection, NegativeDampingIsNotAdded) {
  EXPECT_FALSE(TermOf(Select(Noisy(With(-0.1, 0.0), 9)), "viscous").added);
}

TEST(TermSelection, LagIsAddedAloneAndRecovered) {
  Record record = Clean();
  constexpr std::size_t kLate = 2;  // samples
  const std::vector<double> force = record.force;
  for (std::size_t i = 0; i < record.size(); ++i)
    record.force[i] = force[i < kLate ? 0 : i - kLate];
  const TermSelection selection = Select(Noisy(record, 5));
  EXPECT_THAT(selection.added, ElementsAre("lag"));
  const ParameterEstimate& estimate = *selection.fit.Find("lag");
  EXPECT_NEAR(estimate.value, kLate * kPeriod / kSamplesPerCycle,
              kStandardErrors * *estimate.standard_error);
}

/// Wanders in no step with the motion.
std::vector<double> Wandering(std::size_t samples) {
  std::vector<double> values;
  for (std::size_t i = 0; i < samples; ++i) {
    const auto at = static_cast<double>(i);
    values.push_back(40 + std::sin(0.031 * at) * std::cos(0.012 * at + 1));
  }
  return values;
}

TEST(TermSelection, CovariateIsAddedOnceThoughTwoColumnsHaveIt) {
  Record record = Clean();
  constexpr double kPerBar = 6.0;
  record.covariates = {{.name = "bar", .unit = "bar", .values = Wandering(record.size())},
                       {.name = "volts", .unit = "V", .values = Wandering(record.size())}};
  for (double& volts : record.covariates[1].values) volts = 0.5 + 0.02 * volts;
  for (std::size_t i = 0; i < record.size(); ++i) {
    record.force[i] += kPerBar * record.covariates[0].values[i];
  }
  const TermSelection selection = Select(Noisy(record, 6));
  EXPECT_THAT(selection.added, ElementsAre("covariate_bar"));
  EXPECT_EQ(TermOf(selection, "covariate_volts").obstacle, "same_channel");
}

TEST(TermSelection, ColumnThatFollowsTheContactIsConfoundedAndACopyIsNotTried) {
  const std::vector<double> contact = Clean().force;
  Record record = Noisy(With(0.1, 0.0), 7);
  record.covariates = {{.name = "load cell", .unit = "V", .values = record.force},
                       {.name = "pressure", .unit = "bar", .values = Wandering(record.size())}};
  for (std::size_t i = 0; i < record.size(); ++i) {
    record.covariates[1].values[i] += contact[i] / kLaw.slip_force + 0.3 * SpeedAt(i) / kReach;
  }
  const TermSelection selection = Select(record);
  EXPECT_THAT(selection.added, ElementsAre("viscous"));
  EXPECT_EQ(TermOf(selection, "covariate_pressure").obstacle, "confounded");
  EXPECT_EQ(TermOf(selection, "covariate_load_cell").obstacle, "same_channel");
  EXPECT_EQ(TermOf(selection, "covariate_load_cell").gain, 0.0);
}

TEST(TermSelection, BoundOfTheUserIsKept) {
  const Record record = Noisy(With(0.1, 0.0), 2);
  const ParameterEstimate free = *Select(record).fit.Find("slip_force");
  const double lowest = free.value + 0.5 * *free.standard_error;  // which noise does not exclude
  const TermSelection selection =
      Select(record, {.bounds = {{"slip_force", {lowest, 10 * kLaw.slip_force}}}});
  EXPECT_THAT(selection.added, ElementsAre("viscous"));
  EXPECT_EQ(selection.fit.adequacy.verdict, AdequacyVerdict::kAdequate);
  EXPECT_GE(selection.fit.Find("slip_force")->value, lowest);
}

}  // namespace
}  // namespace mindahl::identification::term_selection_test
