// Records of one contact under several loads: Tc = μN, σ ∝ N^p, α shared.

#include "identification/stages.h"
#include "mindahl/identification/fit.h"
#include "mindahl/models/steady_loop.h"
#include "recovery/recovered.h"
#include "support/prelude.h"
#include "support/variable_load.h"

namespace mindahl::identification::load_series_test {
namespace {

constexpr std::array kLoads = {25.0, 50.0, 105.0};  // [N], of mean 60
constexpr double kMeanLoad = 60.0;
constexpr BranchLaw kAtMean{4e7, 1.0 / 3, 24.0};  // μ = 0.4
constexpr double kReach = 1.3e-6;                 // [m]: from 1.9 to 1.1 times gross slip, p = 1/3

BranchLaw LawUnder(double load, double exponent, double shape_exponent = 1.0 / 3) {
  const double ratio = load / kMeanLoad;
  return {kAtMean.tangential_stiffness * std::pow(ratio, exponent), shape_exponent,
          kAtMean.slip_force * ratio};
}

/// One loop a load, offsets of their own.
std::vector<Record> Series(double exponent, double shape_exponent = 1.0 / 3) {
  std::vector<Record> records;
  double offset = 1.0;
  for (const double load : kLoads) {
    const auto displacement = testing::Cycling(testing::Wave::kSine, kReach, 2.0, 150);
    const BranchLaw law = LawUnder(load, exponent, shape_exponent);
    records.push_back(testing::Shifted(testing::LoopOf(law, displacement), 1e-7 * offset, offset));
    offset += 1.0;
  }
  return records;
}

/// Behind a spring, driven to the same force.
std::vector<Record> SeriesInRig(double exponent, double stiffness) {
  std::vector<Record> records = Series(exponent);
  for (std::size_t r = 0; r < records.size(); ++r) {
    const double offset = 1.0 + static_cast<double>(r);
    for (std::size_t i = 0; i < records[r].size(); ++i) {
      records[r].displacement[i] += (records[r].force[i] - offset) / stiffness;
    }
  }
  return records;
}

FitOptions UnderLoads() { return {.normal_loads = {kLoads.begin(), kLoads.end()}}; }

TEST(LoadSeriesFit, RecoversContactAndExponent) {
  for (const double exponent :
       {0.0, 1.0 / 3, 0.5, 1.0}) {  // flat punch, Hertz, cone, rough contact
    SCOPED_TRACE(exponent);
    const FitResult fit = Fit(Series(exponent), UnderLoads());
    EXPECT_TRUE(testing::Recovers(fit, kAtMean, testing::kNoiseFree));
    ASSERT_NE(fit.Find("load_exponent"), nullptr);
    EXPECT_NEAR(fit.load_exponent, exponent, testing::kNoiseFree);
    EXPECT_EQ(fit.Find("load_exponent")->identifiability, Identifiability::kIdentifiable);
    EXPECT_DOUBLE_EQ(*fit.normal_load, kMeanLoad);
  }
}

TEST(LoadSeriesFit, SeparatesRigFromContact) {
  // 1/σ_seen = 1/k + 1/σ(N): with α and p free too. The condition is some hundred times that of a
  // fit without a rig.
  constexpr double kTolerance = 100 * testing::kNoiseFree;
  constexpr double kRigStiffness = 6e7;
  FitOptions options = UnderLoads();
  options.terms = {"rig_stiffness"};
  const FitResult fit = Fit(SeriesInRig(1.0 / 3, kRigStiffness), options);
  EXPECT_TRUE(testing::Recovers(fit, kAtMean, kTolerance));
  EXPECT_NEAR(fit.load_exponent, 1.0 / 3, kTolerance);
  EXPECT_NEAR(fit.rig.stiffness / kRigStiffness, 1, kTolerance);
}

TEST(LoadSeriesFit, IncludesTheExponentThatItHasInARig) {
  const FitResult fit = Fit(SeriesInRig(1.0 / 3, 6e7), UnderLoads());
  ASSERT_NE(fit.FindFinding("shape_or_rig"), nullptr);
  EXPECT_TRUE(testing::Covers(*fit.Find("load_exponent"), 1.0 / 3));
  EXPECT_LT(*fit.Find("load_exponent")->upper95, 0.36);
}

TEST(LoadSeriesFit, TakesLoadsOfColumnsForTheSame) {
  std::vector<Record> records = Series(1.0 / 3);
  for (std::size_t r = 0; r < records.size(); ++r) {
    records[r].normal_load.assign(records[r].size(), kLoads[r]);
  }
  const FitResult fit = Fit(records);
  EXPECT_TRUE(testing::Recovers(fit, kAtMean, testing::kNoiseFree));
  EXPECT_NEAR(fit.load_exponent, 1.0 / 3, testing::kNoiseFree);
}

TEST(LoadSeriesFit, HoldsAnExponentThatIsGiven) {
  FitOptions options = UnderLoads();
  options.fixed["load_exponent"] = 0.5;
  const FitResult fit = Fit(Series(0.5), options);
  EXPECT_TRUE(testing::Recovers(fit, kAtMean, testing::kNoiseFree));
  EXPECT_EQ(fit.Find("load_exponent")->status, ParameterStatus::kFixed);
}

TEST(LoadSeriesFit, IsNoneOfRecordsUnderOneLoad) {
  const std::vector<Record> records = Series(1.0 / 3);
  const std::vector<Record> same = {records[1], records[1]};
  const FitResult unknown = Fit(same);
  EXPECT_EQ(unknown.Find("load_exponent"), nullptr);
  EXPECT_FALSE(unknown.normal_load);
  const FitResult one = Fit(same, {.normal_loads = {50.0}});
  EXPECT_EQ(one.Find("load_exponent"), nullptr);
  EXPECT_EQ(one.normal_load, 50.0);
  EXPECT_EQ(one.law.slip_force, unknown.law.slip_force);
  EXPECT_EQ(Fit(same, {.normal_loads = {50.0, 50.4}}).Find("load_exponent"), nullptr)
      << "within the threshold of a hundredth";
}

TEST(LoadSeriesFit, RefusesWhatHasNoMeaning) {
  const std::vector<Record> records = Series(1.0 / 3);
  EXPECT_THAT(RefusalOf(records, {.normal_loads = {25.0, 50.0}}),
              HasSubstr("2 normal loads for 3 records"));
  EXPECT_THAT(RefusalOf(records, {.normal_loads = {25.0, 50.0, -1.0}}),
              HasSubstr("normal load [N] = -1"));
}

// ---
// Loads that vary within a record: the fit's law is that of elements in parallel.

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

/// With the force that the contact has under the record's own load.
Record UnderItsLoad(Record record, double shape_exponent) {
  record.force.resize(record.displacement.size());
  EvaluateForceUnderLoad({.friction_coefficient = kFriction,
                          .reference_load = kLoad,
                          .reference_stiffness = kStiffness,
                          .shape_exponent = shape_exponent},
                         record.displacement, record.normal_load, record.force);
  return record;
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
  return UnderItsLoad(record, motion.shape_exponent);
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
        ASSERT_NE(fit.FindFinding("load_varies", "followed"), nullptr);
        EXPECT_NEAR(*fit.FindFinding("load_varies", "followed")->Number("variation"), swing, 1e-9);
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
  for (const char* model : {"mindlin", "dahl"}) {
    const FitResult sprung =
        testing::FitOne(record, {.model = &Model(model), .terms = {"rig_stiffness"}});
    EXPECT_NE(sprung.FindFinding("load_varies", "not_followed"), nullptr) << model;
    EXPECT_EQ(sprung.FindFinding("load_varies", "followed"), nullptr) << model;
  }
}

TEST(VaryingLoad, KeepsAlphaBelowOne) {
  // A loop of Dahl's exponential: the law of a varying load comes no nearer than its bound.
  const testing::History displacement = testing::Cycling(testing::Wave::kSine, 3e-6, 3.0, kSamples);
  Record record = testing::LoopOf({kStiffness, 1.6, 20.0}, displacement);
  for (std::size_t i = 0; i < record.size(); ++i) {
    record.normal_load.push_back(kLoad * (1 + 0.03 * std::sin(0.1 * static_cast<double>(i))));
  }
  const FitResult fit = testing::FitOne(record);
  EXPECT_EQ(fit.Find("alpha")->status, ParameterStatus::kAtUpperBound);
  EXPECT_NE(fit.Find("alpha")->identifiability, Identifiability::kIdentifiable);
  // The law's own bound leaves nothing of the second.
  for (const FitOptions& options :
       {FitOptions{.fixed = {{"alpha", 1.6}}}, {.bounds = {{"alpha", {0.99, 1.2}}}}}) {
    EXPECT_THAT(RefusalOf({record}, options), HasSubstr("where the normal load varies"));
  }
}

TEST(VaryingLoad, AndOneThatDiffersBetweenRecordsAreOneContact) {
  std::vector<Record> records;
  for (const double load : {0.5, 1.5}) {
    Record record = RecordOf({.swing = 0.1, .cycles = 3.0});
    for (double& value : record.normal_load) value *= load;
    records.push_back(UnderItsLoad(record, 1.0 / 3));
  }
  const FitResult fit = Fit(records);
  EXPECT_TRUE(testing::Recovers(fit, LawOf({}), testing::kNoiseFree));
  EXPECT_NEAR(fit.load_exponent, 1.0 / 3, testing::kNoiseFree);
}

}  // namespace
}  // namespace mindahl::identification::load_series_test
