#include "identification/stages.h"
#include "mindahl/identification/term_selection.h"
#include "support/prelude.h"

// A gap before the contact that is crossed at zero force. The records are made from the contact's
// own motion: δ = x + (g/2)·sgn F(x), so that the fit's rule for finding x is not used.
namespace mindahl::identification::backlash_test {
namespace {

constexpr BranchLaw kLaw{5e7, 0.4, 60.0};
constexpr double kReach = 4e-6;  // 2 of gross slip
constexpr double kGap = 1.3e-6;
constexpr int kSamplesPerCycle = 400;
/// The sums of squares are zero to rounding, and the condition of a fit is 1e4.
constexpr double kRecovered = 1e-8;

/// The record of a contact that moves along `contact` behind a gap. Where its force changes sign
/// three readings are put into the gap.
Record BehindGap(const History& contact, const std::string& model = "mindlin-dahl",
                 const BranchLaw& law = kLaw) {
  const std::vector<double> force = Respond(Model(model), law, contact);
  History displacement;
  std::vector<double> read;
  for (std::size_t i = 0; i < contact.size(); ++i) {
    const double side = force[i] == 0 ? 0.0 : std::copysign(0.5, force[i]);
    if (i > 0 && force[i - 1] * force[i] < 0) {
      const double fraction = force[i - 1] / (force[i - 1] - force[i]);
      const double crossing = std::lerp(contact[i - 1], contact[i], fraction);
      for (const double part : {-0.7, 0.1, 0.6}) {
        displacement.push_back(crossing + part * side * kGap);
        read.push_back(0.0);
      }
    }
    displacement.push_back(contact[i] + side * kGap);
    read.push_back(force[i]);
  }
  return MakeRecord(displacement, read);
}

void ExpectRecovered(const FitResult& fit, const BranchLaw& law, double tolerance) {
  ASSERT_TRUE(Recovers(fit, law, tolerance));
  EXPECT_NEAR(fit.Find("backlash")->value / kGap, 1.0, tolerance);
}

TEST(Backlash, IsRecoveredFromAVirginLoop) {
  const Record record = BehindGap(Cycling(Wave::kSine, kReach, 2.3, kSamplesPerCycle));
  ExpectRecovered(FitOne(record, {.terms = {"backlash"}}), kLaw, kRecovered);
}

TEST(Backlash, IsRecoveredFromASteadyLoopOfDahlsOwnLaw) {
  constexpr BranchLaw kDahl{5e7, 1.0, 60.0};
  const Record record =
      BehindGap(Cycling(Wave::kSine, kReach, 8.25, kSamplesPerCycle), "dahl", kDahl);
  // From a turning point on, when the first loading is forgotten.
  const auto cut = static_cast<std::size_t>(static_cast<double>(record.size()) / 8.25 * 6);
  const FitOptions options{
      .model = &Model("dahl"), .initial_state = InitialState::kSteady, .terms = {"backlash"}};
  // The loop of exp(−2σX/Tc) = 1e-3 a stroke has settled to 1e-18 of its slip force; its centre is
  // that of the sampled extremes, which lie half a sample's sine of 1e-4 off.
  constexpr double kSampled = 1e-3;
  ExpectRecovered(FitOne(From(record, cut), options), kDahl, kSampled);
}

TEST(Backlash, LeavesInnerLoopsThatDoNotUnloadTheContactOnOneSideOfTheGap) {
  // Up, back by an eighth of the reach, twice, and round.
  History contact;
  const auto go = [&](double to) {
    const double from = contact.empty() ? 0.0 : contact.back();
    for (int i = contact.empty() ? 0 : 1; i <= 100; ++i) {
      contact.push_back(std::lerp(from, to, i / 100.0));
    }
  };
  for (const double to : {1.0, 0.9, 0.97, 0.88, 1.0, -1.0, -0.85, -1.0, 1.0}) go(to * kReach);
  const Record record = BehindGap(contact);
  ExpectRecovered(FitOne(record, {.terms = {"backlash"}}), kLaw, kRecovered);
}

TEST(Backlash, OfNoneIsFoundAtItsBoundAndLeavesTheLaw) {
  const History displacement = Cycling(Wave::kSine, kReach, 2.3, kSamplesPerCycle);
  const FitResult fit = FitOne(testing::LoopOf(kLaw, displacement), {.terms = {"backlash"}});
  ASSERT_TRUE(fit.converged);
  EXPECT_NEAR(fit.law.slip_force / kLaw.slip_force, 1.0, kRecovered);
  EXPECT_LT(fit.Find("backlash")->value, 1e-6 * kReach);
}

TEST(Backlash, OfZeroWidthIsTheLawAloneToTheLastBit) {
  const Record record = BehindGap(Cycling(Wave::kSine, kReach, 2.3, kSamplesPerCycle));
  const Stages with(record, {.fixed = {{"backlash", 0.0}}});
  const Stages without(record);
  std::vector<double> theta;
  for (const Parameter& parameter : with.problem.parameters) theta.push_back(parameter.theta);
  theta[kStiffness] = 1.5;
  theta[kShape] = 0.3;
  EXPECT_EQ(Response(with.problem).LinearizeAt(theta, {}).residual,
            Response(without.problem).LinearizeAt(theta, {}).residual);
}

TEST(Backlash, IsAmongTheTermsThatAreAdded) {
  testing::Generator generator(4);
  const Record record =
      testing::WithForceNoise(BehindGap(Cycling(Wave::kSine, kReach, 3.1, kSamplesPerCycle)),
                              0.01 * kLaw.slip_force, generator);
  const TermSelection selection =
      SelectTerms(std::vector<RecordView>{record}, {}, FitOne(record, {}));
  EXPECT_THAT(selection.added, ::testing::Contains("backlash"));
  EXPECT_EQ(selection.fit.adequacy.verdict, AdequacyVerdict::kAdequate);
  const ParameterEstimate& gap = *selection.fit.Find("backlash");
  ASSERT_TRUE(gap.standard_error);
  EXPECT_NEAR(gap.value, kGap, 4 * *gap.standard_error);
}

TEST(Backlash, IsRefusedWhereItCannotBe) {
  const Record record = BehindGap(Cycling(Wave::kSine, kReach, 1.3, kSamplesPerCycle));
  const std::pair<FitOptions, const char*> refused[] = {
      {{.terms = {"backlash"}, .fixed = {{"lag", 0.5}}}, "lag and backlash cannot be in one fit"},
      {{.fixed = {{"backlash", -1e-6}}}, "backlash [m] = -1e-06 is invalid: must be finite and"},
      {{.preparation = {.excitation = Channel::kForce}, .terms = {"backlash"}},
       "backlash has no place in a fit of the displacement"}};
  for (const auto& [options, message] : refused) {
    EXPECT_THAT(RefusalOf({record}, options), HasSubstr(message));
  }
}

}  // namespace
}  // namespace mindahl::identification::backlash_test
