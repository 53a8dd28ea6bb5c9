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

TEST(VaryingLoad, KeepsAlphaBelowOneWithNote) {
  // A loop of Dahl's exponential: the law of a varying load comes no nearer than its bound.
  const testing::History displacement = testing::Cycling(testing::Wave::kSine, 3e-6, 3.0, kSamples);
  Record record = testing::LoopOf({kStiffness, 1.6, 20.0}, displacement);
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
    EXPECT_THAT(RefusalOf({record}, options), HasSubstr("where the normal load varies"));
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
