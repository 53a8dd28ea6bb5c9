

#include "identification/stages.h"
#include "mindahl/identification/fit.h"
#include "mindahl/models/variable_load.h"
#include "recovery/recovered.h"
#include "support/prelude.h"

// Loads that vary within a record: the fit's law is that of elements in parallel.
namespace mindahl::identification::varying_load_test {
namespace {

using loop::Record;
using models::BranchLaw;

constexpr double kTwoPi = 2 * std::numbers::pi;
constexpr double kFriction = 0.4;
constexpr double kLoad = 50.0;  // [N], in the mean over whole cycles
constexpr double kStiffness = 4e7;
constexpr int kSamples = 200;  // a cycle

struct Motion {
  double lambda = 1.3;
  double swing = 0.05;
  double multiple = 2.0;  // of the load's frequency to the displacement's
  double cycles = 3.0;
  double shape_exponent = 1.0 / 3;
};

BranchLaw LawOf(const Motion& motion) {
  return {kStiffness, motion.shape_exponent, kFriction * kLoad};
}

Record RecordOf(const Motion& motion) {
  const double reach = motion.lambda * GrossSlipDisplacement(LawOf(motion));
  Record record;
  const int last = static_cast<int>(std::lround(motion.cycles * kSamples)) - 1;
  for (int i = 0; i <= last; ++i) {
    const double phase = kTwoPi * i / kSamples;
    record.displacement.push_back(reach * std::sin(phase));
    record.normal_load.push_back(kLoad * (1 + motion.swing * std::cos(motion.multiple * phase)));
  }
  record.force.resize(record.displacement.size());
  models::EvaluateForceUnderLoad({.friction_coefficient = kFriction,
                                  .reference_load = kLoad,
                                  .reference_stiffness = kStiffness,
                                  .shape_exponent = motion.shape_exponent},
                                 record.displacement, record.normal_load, record.force);
  return record;
}

TEST(VaryingLoad, IsFollowedToTheLastDigits) {
  // Steps between samples are the record's own: no error of sampling. The mean of the load's
  // readings is 50 N to rounding.
  for (const double swing : {0.05, 0.3}) {
    for (const double multiple : {1.0, 2.0, 0.5}) {
      for (const double lambda : {0.8, 1.3}) {
        const Motion motion{.lambda = lambda, .swing = swing, .multiple = multiple, .cycles = 4.0};
        const FitResult fit = testing::FitOne(testing::Shifted(RecordOf(motion), 1e-7, 2.0));
        EXPECT_TRUE(testing::Recovers(fit, LawOf(motion), testing::kNoiseFree))
            << "swing " << swing << ", multiple " << multiple << ", lambda " << lambda;
        EXPECT_EQ(fit.initial_state, models::InitialState::kVirgin);
        ASSERT_NE(fit.FindFinding("load_followed"), nullptr);
        EXPECT_NEAR(*fit.FindFinding("load_followed")->Number("variation"), swing, 1e-9);
      }
    }
  }
}

TEST(VaryingLoad, OfASettledContactIsFollowedFromTheRecordsFirstCycle) {
  for (const double swing : {0.05, 0.3}) {
    for (const double lambda : {0.8, 1.3}) {
      const Motion motion{.lambda = lambda, .swing = swing, .cycles = 8.0};
      const Record whole = RecordOf(motion);
      // From within the third cycle on, five whole cycles: the load's mean is that of the law.
      const Record seen = testing::From(whole, 3 * kSamples);
      Record moved = testing::From(whole, 2 * kSamples + 70);
      for (auto* column : {&moved.displacement, &moved.force, &moved.normal_load}) {
        column->resize(5 * kSamples);
      }
      for (const Record& record : {seen, moved}) {
        const FitResult fit = testing::FitOne(testing::Shifted(record, 0.0, 2.0));
        EXPECT_EQ(fit.initial_state, models::InitialState::kSteady);
        EXPECT_TRUE(testing::Recovers(fit, LawOf(motion), testing::kNoiseFree))
            << "swing " << swing << ", lambda " << lambda;
      }
    }
  }
}

TEST(VaryingLoad, KeepsMindlinsContactMindlins) {
  // ±5 % at twice the frequency: taken for constant, Tc comes out 3 % off, a hundred of its errors.
  constexpr double kErrors = 5.0;  // for normal errors once in 10⁶
  Generator generator(5);
  const Motion motion{};
  const Record record =
      testing::WithForceNoise(RecordOf(motion), 0.005 * kFriction * kLoad, generator);
  const FitResult fit = testing::FitOne(record);
  const ParameterEstimate& alpha = *fit.Find("alpha");
  ASSERT_TRUE(alpha.standard_error);
  EXPECT_LT(std::abs(alpha.value - 1.0 / 3), kErrors * *alpha.standard_error);
  EXPECT_LT(*alpha.standard_error, 0.02);
  const ParameterEstimate& slip_force = *fit.Find("slip_force");
  EXPECT_LT(std::abs(slip_force.value - kFriction * kLoad), kErrors * *slip_force.standard_error);
  ASSERT_TRUE(fit.mindlin_test);
  EXPECT_GT(fit.mindlin_test->p_value, 1e-3);
  EXPECT_EQ(fit.adequacy.verdict, AdequacyVerdict::kAdequate);
  // Without the column it is what it was.
  Record blind = record;
  blind.normal_load.clear();
  const FitResult fooled = testing::FitOne(blind);
  EXPECT_GT(std::abs(fooled.law.slip_force / (kFriction * kLoad) - 1), 0.015);
  EXPECT_NE(fooled.adequacy.verdict, AdequacyVerdict::kAdequate);
}

TEST(VaryingLoad, MayBeLiftedOffAtTheRecordsEnds) {
  // Ramps of the load from 0 and back to it: nothing is remembered from before.
  Motion motion{.swing = 0.0, .cycles = 5.0};
  Record record = RecordOf(motion);
  const std::size_t ramp = kSamples / 2;
  const std::size_t size = record.size();
  for (std::size_t i = 0; i < ramp; ++i) {
    const double share = static_cast<double>(i) / static_cast<double>(ramp);
    record.normal_load[i] = kLoad * share;
    record.normal_load[size - 1 - i] = kLoad * share;
  }
  models::EvaluateForceUnderLoad({.friction_coefficient = kFriction,
                                  .reference_load = kLoad,
                                  .reference_stiffness = kStiffness,
                                  .shape_exponent = 1.0 / 3},
                                 record.displacement, record.normal_load, record.force);
  const FitResult fit = testing::FitOne(record);
  // σ and Tc are those under the mean, the ramps' readings included.
  double mean = 0.0;
  for (const double load : record.normal_load) mean += load / static_cast<double>(size);
  EXPECT_NEAR(*fit.normal_load / mean, 1, 1e-12);
  const BranchLaw at_mean{kStiffness * std::cbrt(mean / kLoad), 1.0 / 3, kFriction * mean};
  EXPECT_TRUE(testing::Recovers(fit, at_mean, testing::kNoiseFree));
}

TEST(VaryingLoad, BelowAHundredthIsConstant) {
  const Motion motion{.swing = 0.009};
  const FitResult fit = testing::FitOne(RecordOf(motion));
  EXPECT_EQ(fit.FindFinding("load_followed"), nullptr);
  EXPECT_FALSE(fit.records.front().load_varies);
}

TEST(VaryingLoad, IsNoneOfNoisyReadings) {
  // 5 % of white noise about a constant load.
  Generator generator(11);
  Record record = RecordOf({.swing = 0.0});
  for (double& load : record.normal_load) load *= 1 + 0.05 * testing::Normal(generator);
  const FitResult fit = testing::FitOne(record);
  EXPECT_FALSE(fit.records.front().load_varies);
  EXPECT_TRUE(testing::Recovers(fit, LawOf({}), testing::kNoiseFree));
}

TEST(VaryingLoad, IsReportedIfTheLawDoesNotModelIt) {
  const Record record = RecordOf({.swing = 0.2});
  FitOptions options;
  options.terms = {"rig_stiffness"};
  for (const char* model : {"mindlin", "dahl"}) {
    options.model = models::FindFrictionModel(model);
    const FitResult sprung = testing::FitOne(record, options);
    EXPECT_NE(sprung.FindFinding("load_not_followed"), nullptr) << model;
    EXPECT_EQ(sprung.FindFinding("load_followed"), nullptr) << model;
  }
}

TEST(VaryingLoad, DoesNotTellASmallerAlphaFromARig) {
  Generator generator(7);
  const Motion motion{.swing = 0.1, .shape_exponent = 0.15};
  const FitResult fit = testing::FitOne(
      testing::WithForceNoise(RecordOf(motion), 0.005 * kFriction * kLoad, generator));
  ASSERT_NE(fit.FindFinding("rig_not_tried"), nullptr);
  EXPECT_EQ(fit.Find("alpha")->identifiability, Identifiability::kNotIdentifiable);
  EXPECT_EQ(fit.Find("slip_force")->identifiability, Identifiability::kIdentifiable);
}

TEST(VaryingLoad, KeepsAlphaBelowOneWithNote) {
  // A loop of Dahl's exponential: the law of a varying load comes no nearer than its bound.
  const testing::History displacement = testing::Cycling(testing::Wave::kSine, 3e-6, 3.0, kSamples);
  Record record = testing::MakeRecord(
      displacement,
      testing::Respond(testing::Model("mindlin-dahl"), {kStiffness, 1.6, 20.0}, displacement));
  for (std::size_t i = 0; i < record.size(); ++i) {
    record.normal_load.push_back(kLoad * (1 + 0.03 * std::sin(0.1 * static_cast<double>(i))));
  }
  const FitResult fit = testing::FitOne(record);
  EXPECT_EQ(fit.Find("alpha")->status, ParameterStatus::kAtUpperBound);
  if (fit.FindFinding("model_inadequate") == nullptr) {
    EXPECT_NE(fit.FindFinding("alpha_limited_by_load"), nullptr);
  }
  FitOptions fixed;
  fixed.fixed["alpha"] = 1.6;
  FitOptions bounded;
  bounded.bounds["alpha"] = {0.99, 1.2};  // the law's own bound leaves nothing of it
  for (const FitOptions& options : {fixed, bounded}) {
    try {
      testing::FitOne(record, options);
      ADD_FAILURE() << "took alpha of 0.99 or more";
    } catch (const InvalidArgument& error) {
      EXPECT_NE(std::string(error.what()).find("where the normal load varies"), std::string::npos);
    }
  }
}

TEST(VaryingLoad, HasTheDerivativesOfItsDifferences) {
  // (step)² = 1e-10 of third derivatives of order 10; rounding 1e-11. α = 0.6: smooth at slip.
  constexpr double kTolerance = 1e-6;
  const Motion motion{.swing = 0.3, .shape_exponent = 0.6};
  testing::Stages stages(RecordOf(motion));
  const FitResult fit = testing::FitOne(stages.records.front());
  std::vector<double> theta = stages.ThetaOf(fit);
  theta[identification::kStiffness] += 0.013;
  theta[kShape] += 0.017;
  // On a sample the virgin curve's curvature jumps.
  theta[stages.problem.parameters.PositionOf("displacement_offset", 0)] += 0.007;
  const auto& free = stages.problem.parameters.free();
  const std::vector<std::size_t> columns(free.begin(), free.end());
  Eigen::MatrixXd jacobian(static_cast<Eigen::Index>(stages.problem.size()),
                           static_cast<Eigen::Index>(columns.size()));
  std::vector<double> residual(stages.problem.size());
  Response response;
  response.Bind(stages.problem);
  Differentiate(stages.problem, theta, response, columns, residual,
                {jacobian.data(), static_cast<std::size_t>(jacobian.size())});
  const Eigen::MatrixXd expected = stages.DifferencesAt(theta);
  for (Eigen::Index c = 0; c < jacobian.cols(); ++c) {
    EXPECT_LT((jacobian.col(c) - expected.col(c)).norm(),
              kTolerance * std::max(expected.col(c).norm(), 1.0))
        << stages.problem.parameters.NameOf(columns[static_cast<std::size_t>(c)]);
  }
}

TEST(VaryingLoad, AndOneThatDiffersBetweenRecordsAreOneContact) {
  std::vector<Record> records;
  for (const double load : {0.5, 1.5}) {
    Record record = RecordOf({.swing = 0.1, .cycles = 3.0});
    for (double& value : record.normal_load) value *= load;
    models::EvaluateForceUnderLoad({.friction_coefficient = kFriction,
                                    .reference_load = kLoad,
                                    .reference_stiffness = kStiffness,
                                    .shape_exponent = 1.0 / 3},
                                   record.displacement, record.normal_load, record.force);
    records.push_back(std::move(record));
  }
  const FitResult fit = Fit(records);
  EXPECT_TRUE(testing::Recovers(fit, LawOf({}), testing::kNoiseFree));
  EXPECT_NEAR(fit.load_exponent, 1.0 / 3, testing::kNoiseFree);
}

}  // namespace
}  // namespace mindahl::identification::varying_load_test
