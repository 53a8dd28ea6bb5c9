
#include <boost/math/distributions/chi_squared.hpp>

#include "identification/inference/noise.h"
#include "identification/sample_loop.h"
#include "identification/stages.h"
#include "mindahl/identification/fit.h"
#include "support/prelude.h"

// Records of one contact whose noise differs, and records that another past precedes.
namespace mindahl::identification::record_noise_test {
namespace {

using models::InitialState;

constexpr double kQuiet = 0.2;  // [N]
constexpr double kLoud = 2.0;

std::vector<loop::Record> Noisy(double one, double other, std::uint64_t seed = 7) {
  Generator generator(seed);
  return {WithForceNoise(Loop(), one, generator), WithForceNoise(Loop(), other, generator)};
}

loop::Record WithoutFirstCycle(loop::Record record) {
  constexpr std::ptrdiff_t kCycle = 120;
  for (auto* column : {&record.displacement, &record.force}) {
    column->erase(column->begin(), column->begin() + kCycle);
  }
  if (!record.time.empty()) record.time.resize(record.displacement.size());
  return record;
}

TEST(ChanceOfOneNoise, IsOneOfOneRecordAndOfRoundingErrors) {
  Stages one(Loop(), Virgin());
  const std::vector<double> residual(one.problem.size(), 0.01);
  EXPECT_EQ(ChanceOfOneNoise(one.problem, residual), 1.0);
  Stages two(std::vector<loop::Record>{Loop(), Loop()}, Virgin());
  std::vector<double> rounding(two.problem.size(), 1e-16);
  std::fill(rounding.begin(), rounding.begin() + 241, 1e-14);
  EXPECT_EQ(ChanceOfOneNoise(two.problem, rounding), 1.0);
}

TEST(JointFit, GivesEachRecordItsOwnNoise) {
  const FitResult fit = Fit(Noisy(kQuiet, kLoud), Virgin());
  ASSERT_TRUE(fit.converged);
  // A standard deviation of 241 samples is known to 1/√(2·241) = 4.6 %; four of these.
  constexpr double kError = 4 * 0.046;
  EXPECT_NEAR(fit.records[0].response_noise / kQuiet, 1.0, kError);
  EXPECT_NEAR(fit.records[1].response_noise / kLoud, 1.0, kError);
  // Of all samples the mean variance.
  const double mean = std::sqrt((kQuiet * kQuiet + kLoud * kLoud) / 2);
  EXPECT_NEAR(fit.force_noise / mean, 1.0, kError);
  EXPECT_NEAR(fit.rms / mean, 1.0, kError) << "the rms is of the residuals as they are";
}

TEST(JointFit, NoisyRecordTakesNothingFromAQuietOne) {
  const std::vector<loop::Record> records = Noisy(kQuiet, kLoud);
  const FitResult joint = Fit(records, Virgin());
  const FitResult alone = Fit({records.data(), 1}, Virgin());
  for (const char* name : {"sigma", "alpha", "slip_force"}) {
    const double of_both = *joint.Find(name)->standard_error;
    const double of_one = *alone.Find(name)->standard_error;
    // The other one, of a hundredth of the information, adds 0.5 %; both know their noise to 5 %.
    constexpr double kNoiseIsKnown = 0.15;
    EXPECT_NEAR(of_both / of_one, 1.0, kNoiseIsKnown) << name;
  }
}

TEST(JointFit, RecordsOfOneNoiseArePooled) {
  const FitResult fit = Fit(Noisy(kLoud, kLoud), Virgin());
  EXPECT_EQ(fit.records[0].response_noise, fit.force_noise);
  EXPECT_EQ(fit.records[1].response_noise, fit.force_noise);
}

TEST(JointFit, KnownNoiseIsThatOfAllRecords) {
  FitOptions options = Virgin();
  options.force_noise = kLoud;
  const FitResult fit = Fit(Noisy(kQuiet, kLoud), options);
  EXPECT_DOUBLE_EQ(fit.records[0].response_noise, kLoud);
}

TEST(JointFit, FindsThatTheFirstRecordIsVirginAndTheOthersAreSteady) {
  Generator generator(11);
  const std::vector<loop::Record> records = {
      WithForceNoise(Loop(), kQuiet, generator),
      WithForceNoise(WithoutFirstCycle(Loop(3.0)), kQuiet, generator),
      WithForceNoise(WithoutFirstCycle(Loop(3.0)), kQuiet, generator)};
  const FitResult fit = Fit(records, {});
  ASSERT_TRUE(fit.converged);
  EXPECT_TRUE(fit.has_mixed_states());
  EXPECT_EQ(fit.records[0].initial_state, InitialState::kVirgin);
  EXPECT_EQ(fit.records[1].initial_state, InitialState::kSteady);
  EXPECT_EQ(fit.records[2].initial_state, InitialState::kSteady);
  EXPECT_EQ(fit.adequacy.verdict, AdequacyVerdict::kAdequate);
  for (const auto& [name, truth] :
       {std::pair("sigma", kLaw.tangential_stiffness), std::pair("alpha", kLaw.shape_exponent),
        std::pair("slip_force", kLaw.slip_force)}) {
    const ParameterEstimate& estimate = *fit.Find(name);
    EXPECT_NEAR(estimate.value, truth, 4 * *estimate.standard_error) << name;
  }
}

}  // namespace
}  // namespace mindahl::identification::record_noise_test
