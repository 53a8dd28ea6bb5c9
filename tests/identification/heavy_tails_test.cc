#include "identification/inference/heavy_tails.h"

#include "recovery/recovered.h"
#include "support/prelude.h"

// Readings that are far off: found where they are, with their number, and nowhere else.
namespace mindahl::identification::heavy_tails_test {
namespace {

using namespace loop;
using namespace models;

constexpr BranchLaw kLaw{4e7, 1.0 / 3, 40.0};
constexpr double kReach = 6e-6;  // [m], four times gross slip
constexpr double kNoise = 0.005 * kLaw.slip_force;
constexpr int kCycle = 400;  // samples

/// Three cycles with white noise, from rest.
Record Noisy(std::uint64_t seed, Wave wave = Wave::kTriangle) {
  const History displacement = Cycling(wave, kReach, 3.0, kCycle);
  Record record = MakeRecord(displacement, Respond(Model("mindlin-dahl"), kLaw, displacement));
  Generator generator(seed);
  for (double& force : record.force) force += kNoise * Normal(generator);
  return record;
}

/// So many readings, at random, off by so much to either side.
Record WithStrayReadings(std::size_t readings, double off, std::uint64_t seed) {
  Record record = Noisy(seed);
  Generator generator(seed + 1000);
  for (std::size_t k = 0; k < readings; ++k) {
    const double place = testing::Uniform(generator, 0, static_cast<double>(record.size()));
    record.force[static_cast<std::size_t>(place)] += k % 2 == 0 ? off : -off;
  }
  return record;
}

FitResult Fitted(const Record& record, const FitOptions& options = {}) {
  return Fit({&record, 1}, options, Depth::kIntervals);
}

const Cause* Find(const FitResult& fit, std::string_view code) {
  const auto found = std::ranges::find(fit.adequacy.causes, code, &Cause::code);
  return found == fit.adequacy.causes.end() ? nullptr : &*found;
}

TEST(HeavyTails, AreFoundWithTheirFractionAndTheRobustLoss) {
  constexpr std::size_t kReadings = 12;
  const Record record = WithStrayReadings(kReadings, 15 * kNoise, 3);
  const FitResult fit = Fitted(record);
  const Cause* cause = Find(fit, "heavy_tails");
  ASSERT_NE(cause, nullptr);
  EXPECT_EQ(fit.adequacy.verdict, AdequacyVerdict::kDoubtful);
  EXPECT_EQ(cause->term, "");
  // Those next to a turn, or next to each other, are not looked at: at most a few of them.
  const double share = kReadings / static_cast<double>(record.size());
  EXPECT_GT(cause->size, share * 0.6);
  EXPECT_LT(cause->size, share * 1.05);
  // 12·15² of 12·15² + 1201 is 0.69.
  EXPECT_GT(cause->explains, 0.4);
  EXPECT_LT(cause->explains, 0.75);
}

TEST(HeavyTails, AreNotLookedForUnderALossThatMindsThem) {
  FitOptions options;
  options.loss = Loss::kHuber;
  EXPECT_EQ(Find(Fitted(WithStrayReadings(12, 15 * kNoise, 3), options), "heavy_tails"), nullptr);
}

TEST(HeavyTails, AreNoneWhereTheNoiseIsLargerWhereTheForceIsSteep) {
  // Noise of the displacement, too small to be seen in it, makes forty times as much force where
  // the contact sticks as where it slides.
  Record record = Noisy(4, Wave::kSine);
  const History displacement = record.displacement;
  Generator generator(5);
  History seen = displacement;
  for (double& x : seen) x += 2e-10 * Normal(generator);
  record.force = Respond(Model("mindlin-dahl"), kLaw, displacement);
  record.displacement = seen;
  for (double& force : record.force) force += 1e-4 * kLaw.slip_force * Normal(generator);
  FitOptions options;
  options.preparation.displacement_noise = 0.0;
  options.preparation.reversal_gate = 1e-8;
  EXPECT_EQ(Find(Fitted(record, options), "heavy_tails"), nullptr);
}

TEST(HeavyTails, AreRareInWhiteNoise) {
  // At p < 0.001: of 100 loops one by chance is 10 % likely, three of them 0.02 %.
  std::size_t found = 0;
  for (std::uint64_t seed = 10; seed < 110; ++seed) {
    const FitResult fit = Fitted(Noisy(seed, Wave::kSine));
    if (Find(fit, "heavy_tails") != nullptr) ++found;
  }
  EXPECT_LE(found, 2U);
}

TEST(HeavyTails, IgnoreRoundingErrors) {
  const History displacement = Cycling(Wave::kSine, kReach, 2.0, kCycle);
  const Record record =
      MakeRecord(displacement, Respond(Model("mindlin-dahl"), kLaw, displacement));
  const FitResult fit = Fitted(record);
  EXPECT_EQ(Find(fit, "heavy_tails"), nullptr);
}

TEST(FindHeavyTails, OfOneStrayHaveTheChanceOfOneOrMore) {
  constexpr std::size_t kSamples = 206;
  constexpr double kChance = 1e-5;  // that a reading is so far off
  Generator generator(3);
  std::vector<FittedSample> samples;
  for (std::size_t i = 0; i < kSamples; ++i) {
    samples.push_back(
        {.response = 1e-3 * static_cast<double>(i), .residual = Normal(generator), .counts = true});
  }
  samples[100].residual = 40.0;
  const auto count = static_cast<double>(kSamples);
  const std::optional<HeavyTails> fit = FindHeavyTails(samples, Evidence(kSamples, count));
  ASSERT_TRUE(fit);
  EXPECT_DOUBLE_EQ(fit->fraction, 1 / count);
  // The three samples at either end, where the record turns, are not looked at.
  EXPECT_NEAR(fit->p_value / -std::expm1(-kChance * (count - 6)), 1.0, 1e-9);
}

}  // namespace
}  // namespace mindahl::identification::heavy_tails_test
