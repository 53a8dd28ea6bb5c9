#include "identification/stages.h"
#include "mindahl/identification/fit.h"
#include "mindahl/models/steady_loop.h"
#include "recovery/recovered.h"
#include "support/prelude.h"

// Records of one contact under several loads: Tc = μN, σ ∝ N^p, α shared.
namespace mindahl::identification::load_series_test {
namespace {

using loop::Record;
using models::BranchLaw;

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

FitOptions UnderLoads() {
  FitOptions options;
  options.normal_loads = {kLoads.begin(), kLoads.end()};
  return options;
}

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
  EXPECT_NEAR(*fit.Find("load_exponent")->upper95, 1.0 / 3, 0.01);
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
  FitOptions options;
  options.normal_loads = {50.0};
  const FitResult one = Fit(same, options);
  EXPECT_EQ(one.Find("load_exponent"), nullptr);
  EXPECT_EQ(one.normal_load, 50.0);
  EXPECT_EQ(one.law.slip_force, unknown.law.slip_force);
  options.normal_loads = {50.0, 50.4};  // within the threshold of a hundredth
  EXPECT_EQ(Fit(same, options).Find("load_exponent"), nullptr);
}

TEST(LoadSeriesFit, RefusesWhatHasNoMeaning) {
  const std::vector<Record> records = Series(1.0 / 3);
  FitOptions options;
  options.normal_loads = {25.0, 50.0};
  EXPECT_THAT(RefusalOf(records, options), HasSubstr("2 normal loads for 3 records"));
  options.normal_loads = {25.0, 50.0, -1.0};
  EXPECT_THAT(RefusalOf(records, options), HasSubstr("normal load [N] = -1"));
  options = {};
  options.fixed["load_exponent"] = 0.5;
  EXPECT_THAT(RefusalOf(records, options), HasSubstr("load_exponent has no effect"));
}

}  // namespace
}  // namespace mindahl::identification::load_series_test
