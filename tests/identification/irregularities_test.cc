#include "identification/inference/irregularities.h"

#include "recovery/recovered.h"
#include "support/prelude.h"

// What comes and goes in a record: that it is found where it is, with its size, and nowhere else.
namespace mindahl::identification::irregularities_test {
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

/// A tooth of so much, of so many samples, wherever the contact slides, at other places in each
/// stroke.
Record WithTeeth(double drop, std::size_t samples, std::uint64_t seed) {
  const Record quiet = Noisy(seed);
  Record record = quiet;
  std::size_t along = 0;
  Generator generator(seed + 2000);
  for (std::size_t i = 1; i < record.size(); ++i) {
    const double sense = record.displacement[i] > record.displacement[i - 1] ? 1.0 : -1.0;
    const bool slides = sense * quiet.force[i] > 0.95 * kLaw.slip_force;
    if (!slides) {
      along =
          static_cast<std::size_t>(testing::Uniform(generator, 0, static_cast<double>(samples)));
    }
    ++along;
    if (!slides) continue;
    const double share =
        static_cast<double>(along % samples) / static_cast<double>(samples - 1) - 0.5;
    record.force[i] += sense * drop * share;
  }
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

TEST(StickSlip, IsFoundWithItsDrop) {
  constexpr double kDrop = 0.1 * kLaw.slip_force;
  // A drop's step has the noise of two readings: the median of some 40 is known to √(π/2·2/40) of
  // the noise, which is an eighth of 5 % of the drop; and the tooth's own rise, 1/9 of it, is lost.
  constexpr double kError = 0.15;
  const FitResult fit = Fitted(WithTeeth(kDrop, 10, 1));
  const Cause* cause = Find(fit, "stick_slip");
  ASSERT_NE(cause, nullptr);
  EXPECT_EQ(fit.adequacy.verdict, AdequacyVerdict::kDoubtful);
  EXPECT_EQ(cause->unit, "N");
  EXPECT_NEAR(cause->size / kDrop, 1 + 1.0 / 9, kError);
  EXPECT_GT(cause->explains, 0.5);
  EXPECT_LT(cause->delta_aicc, 0);
  EXPECT_EQ(fit.adequacy.causes.front().code, "stick_slip") << "the best";
}

TEST(StickSlip, ExplainsTheMeanAndTheSlopeOfEachTooth) {
  // Teeth of eight samples about these residuals, along which the force grows, and readings off by
  // a hundredth in a pattern without mean or slope: that is what is left.
  constexpr std::array<double, 8> kMeans = {0.2, -0.1, 0.1, -0.2, 0.0, 0.2, -0.2, 0.0};
  constexpr std::array<double, 8> kPattern = {1, -1, -1, 1, 1, -1, -1, 1};
  constexpr double kSlope = -0.1;  // of model − measured, a sample
  constexpr double kReadings = 0.01;
  std::vector<FittedSample> samples;
  double before = 0.0;
  for (const double mean : kMeans) {
    for (std::size_t i = 0; i < 8; ++i) {
      const double along = static_cast<double>(i) - 3.5;
      samples.push_back({.displacement = static_cast<double>(samples.size()),
                         .response = 1.0,
                         .residual = mean + kSlope * along + kReadings * kPattern[i],
                         .counts = true});
      before += samples.back().residual * samples.back().residual;
    }
  }
  const auto fit = FindStickSlip(samples);
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->explains, 1 - 64 * kReadings * kReadings / before, 1e-12);
  // The size is the median of the changes of the means, −0.3, 0.2, −0.3, 0.2, 0.2, −0.4 and 0.2,
  // less eight slopes.
  EXPECT_NEAR(fit->size, 0.2 - 8 * kSlope, 1e-12);
}

TEST(StickSlip, IsNoneWhereTheForceRisesAsItDrops) {
  // Square teeth: of their edges as many rise as drop.
  Record record = Noisy(2);
  for (std::size_t i = 0; i < record.size(); ++i) {
    const bool slides = std::abs(record.force[i]) > 0.9 * kLaw.slip_force;
    if (slides && i / 8 % 2 == 0) record.force[i] += 0.1 * kLaw.slip_force;
  }
  EXPECT_EQ(Find(Fitted(record), "stick_slip"), nullptr);
}

TEST(Ripple, HasItsPeriodBetweenThoseThatAreTriedFirst) {
  // Strokes of 100 to and fro: frequencies are tried 0.005 apart, then a tenth of that.
  constexpr double kFrequency = 0.0422;
  std::vector<FittedSample> samples;
  for (int stroke = 0; stroke < 4; ++stroke) {
    for (int i = 0; i <= 100; ++i) {
      const double x = stroke % 2 == 0 ? i : 100 - i;
      samples.push_back({.displacement = x,
                         .response = stroke % 2 == 0 ? 1.0 : -1.0,
                         .residual = std::cos(2 * M_PI * kFrequency * x),
                         .counts = true});
    }
  }
  const auto fit = FindRipple(samples);
  ASSERT_TRUE(fit);
  EXPECT_NEAR(1 / fit->size, kFrequency, 0.0005);
}

TEST(HeavyTails, AreFoundWithTheirFractionAndTheRobustLoss) {
  constexpr std::size_t kReadings = 12;
  const Record record = WithStrayReadings(kReadings, 15 * kNoise, 3);
  const FitResult fit = Fitted(record);
  const Cause* cause = Find(fit, "heavy_tails");
  ASSERT_NE(cause, nullptr);
  EXPECT_EQ(fit.adequacy.verdict, AdequacyVerdict::kDoubtful);
  EXPECT_EQ(cause->option, "--loss huber");
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

TEST(Irregularities, AreRareInWhiteNoise) {
  // At p < 0.001 each: of 100 loops one by chance is 20 % likely, three of them 0.1 %.
  std::size_t found = 0;
  for (std::uint64_t seed = 10; seed < 110; ++seed) {
    const FitResult fit = Fitted(Noisy(seed, Wave::kSine));
    if (Find(fit, "heavy_tails") != nullptr || Find(fit, "stick_slip") != nullptr) ++found;
  }
  EXPECT_LE(found, 2U);
}

TEST(Irregularities, IgnoreRoundingErrors) {
  const History displacement = Cycling(Wave::kSine, kReach, 2.0, kCycle);
  const Record record =
      MakeRecord(displacement, Respond(Model("mindlin-dahl"), kLaw, displacement));
  const FitResult fit = Fitted(record);
  EXPECT_EQ(Find(fit, "heavy_tails"), nullptr);
  EXPECT_EQ(Find(fit, "stick_slip"), nullptr);
}

}  // namespace
}  // namespace mindahl::identification::irregularities_test
