

#include "recovery/recovered.h"
#include "support/measured.h"
#include "support/prelude.h"

// What the fit says of itself when the record is noisy or says little: intervals that hold the
// truth as often as they state, and verdicts that do not claim what the record does not show.
namespace mindahl::identification::noise_test {
namespace {

constexpr BranchLaw kMindlin{4e7, 1.0 / 3, 40.0};
constexpr double kGrossSlip = 1.5e-6;  // Tc/(σ(1 − α))

bool IsWarnedOf(const FitResult& fit, FindingCode code) { return fit.FindFinding(code) != nullptr; }

/// Nothing of a result may be NaN or infinite where it is stated.
void ExpectFinite(const FitResult& fit) {
  ASSERT_THAT(fit.parameters, Not(IsEmpty())) << fit.solver.message;
  for (const ParameterEstimate& estimate : fit.parameters) {
    EXPECT_TRUE(std::isfinite(estimate.value)) << estimate.name;
    for (const auto& stated : {estimate.standard_error, estimate.lower95, estimate.upper95}) {
      EXPECT_TRUE(!stated || std::isfinite(*stated)) << estimate.name;
    }
    EXPECT_LE(estimate.lower95.value_or(-HUGE_VAL), estimate.value) << estimate.name;
    EXPECT_GE(estimate.upper95.value_or(HUGE_VAL), estimate.value) << estimate.name;
  }
  EXPECT_TRUE(std::isfinite(fit.residuals.rms));
  EXPECT_TRUE(std::isfinite(fit.residuals.durbin_watson));
  EXPECT_GE(fit.residuals.effective_samples, 1.0);
  EXPECT_GE(fit.degrees_of_freedom, 1.0);
}

TEST(Noise, NinetyFivePercentIntervalsCoverAsOftenAsTheyState) {
  constexpr int kLoops = 300;
  // Of 300 intervals of 95 %, fewer than 264 cover the truth with a probability of 1e-6 (binomial:
  // the mean is 285, the standard deviation 3.8).
  constexpr int kFewest = 264;
  // A scatter over 300 loops is known to 1/√600 = 4 %; four times that, and the widening of
  // intervals to likelihood ranges, which may only lengthen them.
  constexpr double kShortest = 0.84;
  constexpr double kLongest = 1.3;
  struct Tally {
    int holding = 0;
    double squared_error = 0.0;
    double squared_standard_error = 0.0;
  };
  for (const double lambda : {0.9, 2.0}) {
    SCOPED_TRACE(lambda);
    Generator generator(20240607);
    std::map<std::string, Tally> tallies;
    const Record clean = LoopOf(kMindlin, Cycling(Wave::kSine, lambda * kGrossSlip, 2.0, 100));
    for (int loop = 0; loop < kLoops; ++loop) {
      const FitResult fit = FitOne(WithForceNoise(clean, 0.005 * kMindlin.slip_force, generator));
      ASSERT_TRUE(fit.converged);
      for (const auto& [name, truth] : testing::ParametersOf(kMindlin)) {
        const ParameterEstimate& estimate = *fit.Find(name);
        ASSERT_TRUE(estimate.standard_error) << name << " of loop " << loop;
        Tally& tally = tallies[name];
        tally.holding += Covers(estimate, truth) ? 1 : 0;
        tally.squared_error += (estimate.value - truth) * (estimate.value - truth);
        tally.squared_standard_error += *estimate.standard_error * *estimate.standard_error;
      }
    }
    for (const auto& [name, tally] : tallies) {
      EXPECT_GE(tally.holding, kFewest) << name;
      const double ratio = std::sqrt(tally.squared_standard_error / tally.squared_error);
      EXPECT_GT(ratio, kShortest) << name;
      EXPECT_LT(ratio, kLongest) << name;
    }
  }
}

TEST(Noise, ShapeExponentAtItsBoundHasAOneSidedIntervalAndNoStandardError) {
  constexpr int kLoops = 60;
  constexpr BranchLaw kJenkins{4e7, 0.0, 40.0};
  Generator generator(11);
  const Record clean = LoopOf(kJenkins, Cycling(Wave::kSine, 2e-6, 2.0, 100));
  int at_bound = 0;
  int holding = 0;
  for (int loop = 0; loop < kLoops; ++loop) {
    const FitResult fit = FitOne(WithForceNoise(clean, 0.01 * kJenkins.slip_force, generator));
    ExpectFinite(fit);
    const ParameterEstimate& alpha = *fit.Find("alpha");
    holding += Covers(alpha, 0.0) ? 1 : 0;
    if (alpha.status != ParameterStatus::kAtLowerBound) continue;
    ++at_bound;
    EXPECT_EQ(alpha.value, 0.0);
    EXPECT_FALSE(alpha.standard_error);
    ASSERT_TRUE(alpha.lower95 && alpha.upper95);
    EXPECT_EQ(*alpha.lower95, 0.0);
    EXPECT_GT(*alpha.upper95, 0.0);
    EXPECT_LT(*alpha.upper95, 1.0 / 3) << "the record tells Jenkins from Mindlin";
  }
  // At a bound the estimate sits there for half the loops: B(60, 1/2) is below 11 or above 49 with
  // a probability of 1e-6.
  EXPECT_GE(at_bound, 11);
  EXPECT_LE(at_bound, 49);
  // B(60, 0.95) is below 44 with a probability of 1e-7.
  EXPECT_GE(holding, 44);
}

TEST(Noise, LoopFarFromSlipNeverHasAnIdentifiableSlipForce) {
  constexpr int kSeeds = 60;
  int confident = 0;
  int stiff = 0;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    Generator generator(static_cast<std::uint64_t>(seed));
    const double lambda = std::array{0.05, 0.1, 0.15}[generator() % 3];
    const double cycles = 1.5 + static_cast<double>(generator() % 9);
    const Record clean = LoopOf(kMindlin, Cycling(Wave::kSine, lambda * kGrossSlip, cycles, 60));
    // From the second extreme on the loop is closed.
    const Record record = testing::From(clean, generator() % 2 == 0 ? 45 : 0);
    const double peak = *std::ranges::max_element(record.force);
    const FitResult fit = FitOne(WithForceNoise(record, 0.01 * peak, generator));
    const ParameterEstimate& slip_force = *fit.Find("slip_force");
    if (slip_force.is_known()) {
      ++confident;
      ADD_FAILURE() << "seed " << seed << ", lambda " << lambda << ": " << slip_force.value;
    }
    // What it does show is the stiffness: of contact and rig, where it cannot tell these.
    stiff += fit.Find("sigma")->is_known() || fit.FindFinding("shape_or_rig") != nullptr;
  }
  EXPECT_EQ(stiff, kSeeds);
  EXPECT_EQ(confident, 0);
}

TEST(Noise, CleanGrossSlipLoopHasAnIdentifiableSlipForce) {
  // The counterpart of the test before: the verdict is not simply always "no".
  Generator generator(5);
  const FitResult fit =
      FitOne(WithForceNoise(LoopOf(kMindlin, Cycling(Wave::kSine, 1.5 * kGrossSlip, 1.5, 100)),
                            0.01 * kMindlin.slip_force, generator));
  for (const char* name : {"sigma", "alpha", "slip_force"}) {
    EXPECT_EQ(fit.Find(name)->identifiability, Identifiability::kIdentifiable) << name;
  }
  EXPECT_THAT(fit.findings, IsEmpty());
}

TEST(Noise, GearboxThatNeverSlipsHasNoIdentifiableSlipForce) {
  const auto rows =
      testing::ReadMeasured("cycloidal/2024-07-12__16-46-43__torqueramp__conic_4pre1.csv", ',');
  if (!rows) GTEST_SKIP() << "no measured records at " << testing::MeasuredPath("cycloidal");
  Record record;
  constexpr std::size_t kTestNumber = 6;
  for (const std::vector<double>& row : *rows) {
    if (row.size() <= kTestNumber || row[kTestNumber] < 100) continue;  // the 40 Nm ramps
    record.displacement.push_back(row[1]);
    record.force.push_back(row[2]);
  }
  const FitResult fit = FitOne(record);
  ExpectFinite(fit);
  // A limit at most, and none where the law does not describe the record.
  EXPECT_GE(fit.Find("slip_force")->identifiability, Identifiability::kBoundedBelow);
  EXPECT_NE(fit.Find("alpha")->identifiability, Identifiability::kIdentifiable);
  EXPECT_TRUE(IsWarnedOf(fit, "bounded_below") || IsWarnedOf(fit, "model_inadequate"));
}

TEST(Noise, CoarseGrossSlipLeavesTheStiffnessOpenAbove) {
  // A square loop: between two samples the force goes from one plateau to the other.
  Generator generator(17);
  constexpr BranchLaw kStiff{4e9, 1.0 / 3, 40.0};
  const Record record = WithForceNoise(LoopOf(kStiff, Cycling(Wave::kTriangle, 1e-5, 3.0, 40)),
                                       0.02 * kStiff.slip_force, generator);
  const FitResult fit = FitOne(record);
  ExpectFinite(fit);
  const ParameterEstimate& sigma = *fit.Find("sigma");
  // A limit at most: between two samples σ and α may be what they like together.
  EXPECT_GE(sigma.identifiability, Identifiability::kBoundedBelow);
  EXPECT_FALSE(sigma.upper95);
  const ParameterEstimate& slip_force = *fit.Find("slip_force");
  EXPECT_EQ(slip_force.identifiability, Identifiability::kIdentifiable);
  // The mean of over 100 plateau samples of 2 % noise; 6 standard errors.
  constexpr double kPlateauError = 6 * 0.02 / 10;
  EXPECT_NEAR(slip_force.value, kStiff.slip_force, kPlateauError * kStiff.slip_force);
}

TEST(Noise, SingularJacobiansEndInVerdictsAndNotInFailures) {
  struct Degenerate {
    const char* what;
    Record record;
  };
  Generator generator(23);
  std::vector<Degenerate> cases;
  const History sine = Cycling(Wave::kSine, 1.0, 2.0, 50);
  cases.push_back({"a spring", MakeRecord(sine, sine)});
  History square;
  for (std::size_t i = 0; i < sine.size(); ++i) square.push_back(i % 50 < 13 || i % 50 > 37);
  cases.push_back({"plateaus only", MakeRecord(sine, square)});
  History noise;
  for (std::size_t i = 0; i < sine.size(); ++i) noise.push_back(testing::Normal(generator));
  cases.push_back({"nothing but noise", MakeRecord(sine, noise)});
  cases.push_back(
      {"two displacements", MakeRecord({0, 1, 0, 1, 0, 1, 0, 1}, {0, 1, 0, 1, 0, 1, 0, 1})});
  for (const Degenerate& c : cases) {
    for (const char* model : {"mindlin-dahl", "mindlin", "jenkins", "dahl"}) {
      for (const InitialState state : {InitialState::kVirgin, InitialState::kSteady}) {
        SCOPED_TRACE(std::string(c.what) + ", " + model);
        const FitResult fit = FitOne(
            c.record,
            {.model = &Model(model), .initial_state = state, .preparation = {.force_sense = 1}});
        ExpectFinite(fit);
        const bool all_known =
            std::ranges::all_of(fit.parameters, [](const ParameterEstimate& estimate) {
              return estimate.identifiability == Identifiability::kIdentifiable;
            });
        EXPECT_FALSE(all_known);
      }
    }
  }
}

TEST(Noise, JointFitOfRecordsWithDifferentOffsetsSharesTheContact) {
  const Record wide = testing::Shifted(
      LoopOf(kMindlin, Cycling(Wave::kSine, 1.4 * kGrossSlip, 2.0, 120)), 3e-6, -12.0);
  const Record narrow = testing::Shifted(
      LoopOf(kMindlin, Cycling(Wave::kTriangle, -0.6 * kGrossSlip, 1.5, 80)), -1e-6, 5.0);
  const FitResult joint = Fit(std::vector<Record>{wide, narrow}, {});
  EXPECT_TRUE(testing::Recovers(joint, kMindlin, testing::kNoiseFree));
  for (const auto& [name, truth] : {std::pair{"force_offset_1", -12.0},
                                    {"force_offset_2", 5.0},
                                    {"displacement_offset_1", 3e-6},
                                    {"displacement_offset_2", -1e-6}}) {
    EXPECT_NEAR(joint.Find(name)->value / truth, 1.0, testing::kNoiseFree) << name;
  }
}

}  // namespace
}  // namespace mindahl::identification::noise_test
