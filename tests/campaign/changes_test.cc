#include "mindahl/campaign/evolution.h"
#include "support/histories.h"
#include "support/prelude.h"

namespace mindahl::campaign::changes_test {
namespace {

constexpr double kLevel = 60.0;
constexpr double kNoise = 0.5;

/// A truth with noise whose lag-one correlation is φ.
Course CourseOf(std::size_t cycles, std::uint64_t seed,
                const std::function<double(std::size_t)>& truth, double phi = 0.0,
                double noise = kNoise) {
  Generator generator(seed);
  Course course;
  double error = noise * Normal(generator);
  for (std::size_t cycle = 1; cycle <= cycles; ++cycle) {
    course.Add(cycle, truth(cycle) + error);
    error = phi * error + std::sqrt(1 - phi * phi) * noise * Normal(generator);
  }
  return course;
}

double Level(std::size_t /*cycle*/) { return kLevel; }

TEST(Course, HoldsMeansInBinsOfEqualSize) {
  Course course;
  constexpr std::size_t kCycles = 10'000;
  for (std::size_t cycle = 1; cycle <= kCycles; ++cycle) {
    course.Add(cycle, 2.0 * static_cast<double>(cycle));
  }
  EXPECT_LE(course.bins().size(), Course::kMostBins);
  EXPECT_GT(course.bins().size(), Course::kMostBins / 2);
  EXPECT_EQ(course.first(), 2.0);
  EXPECT_EQ(course.last(), 2.0 * kCycles);
  std::size_t count = 0;
  std::size_t next = 1;
  for (const Course::Bin& bin : course.bins()) {
    EXPECT_EQ(bin.first_cycle, next);
    EXPECT_NEAR(bin.value, 2 * bin.cycle, 1e-9 * bin.value);
    count += bin.count;
    next = bin.last_cycle + 1;
  }
  EXPECT_EQ(count, kCycles);
}

TEST(Course, WeightsTheBinsThatItMerges) {
  // More values than bins: pairs of 10 (weight 1) and 20 (weight 100) become one each.
  Course course;
  for (std::size_t cycle = 1; cycle <= Course::kMostBins + 1; ++cycle) {
    const bool is_heavy = cycle % 2 == 0;
    course.Add(cycle, is_heavy ? 20.0 : 10.0, is_heavy ? 100.0 : 1.0);
  }
  ASSERT_EQ(course.bins().size(), Course::kMostBins / 2 + 1);
  for (std::size_t k = 0; k + 1 < course.bins().size(); ++k) {
    EXPECT_NEAR(course.bins()[k].value, (10.0 + 100 * 20.0) / 101, 1e-12);
    EXPECT_EQ(course.bins()[k].least, 10.0);
    EXPECT_EQ(course.bins()[k].greatest, 20.0);
  }
}

TEST(Describe, StatesTheFirstAndTheLastValueAsTheTableHasThem) {
  EXPECT_FALSE(Describe(Course()));
  Course falling;  // as a run-in: far from any line
  for (std::size_t cycle = 1; cycle <= 30; ++cycle) {
    falling.Add(10 * cycle, 17.6 + 5.5 * std::exp(-static_cast<double>(cycle)));
  }
  const CourseDescription description = *Describe(falling);
  EXPECT_EQ(description.first, falling.bins().front().value);
  EXPECT_EQ(description.last, falling.bins().back().value);
  for (const Change& step : description.steps) {
    EXPECT_LE(std::max(step.from, step.to), description.first);
  }
  for (const Change& trend : description.trends) {
    EXPECT_LE(std::max(trend.from, trend.to), description.first);
  }
}

TEST(Describe, HardlyEverFindsAChangeInNoise) {
  constexpr int kCourses = 200;
  for (const double phi : {0.0, 0.6}) {
    int found = 0;
    for (int seed = 1; seed <= kCourses; ++seed) {
      found += Describe(CourseOf(200, static_cast<std::uint64_t>(seed), Level, phi))->changed();
    }
    EXPECT_LE(found, kCourses / 20) << phi;
  }
}

TEST(Describe, FindsAStepWhereItIs) {
  for (const std::size_t cycles : {100U, 400U, 3000U}) {
    const std::size_t at = 2 * cycles / 3;
    const CourseDescription description = *Describe(
        CourseOf(cycles, 7, [&](std::size_t cycle) { return cycle < at ? kLevel : 1.1 * kLevel; }));
    ASSERT_THAT(description.steps, SizeIs(1)) << cycles;
    const Change& step = description.steps[0];
    EXPECT_NEAR(static_cast<double>(step.first_cycle), static_cast<double>(at),
                2 + static_cast<double>(cycles) / Course::kMostBins);
    EXPECT_NEAR(step.to / step.from, 1.1, 0.01);
    EXPECT_LT(step.p_value, 1e-6);
    EXPECT_THAT(description.trends, IsEmpty());
  }
}

TEST(Describe, FindsATrend) {
  const CourseDescription description = *Describe(CourseOf(300, 3, [](std::size_t cycle) {
    return kLevel * (1 - 0.2 * static_cast<double>(cycle) / 300);
  }));
  EXPECT_THAT(description.steps, IsEmpty());
  ASSERT_THAT(description.trends, SizeIs(1));
  EXPECT_EQ(description.trends[0].first_cycle, 1U);
  EXPECT_EQ(description.trends[0].last_cycle, 300U);
  EXPECT_NEAR(description.trends[0].to / description.trends[0].from, 0.8, 0.02);
  EXPECT_FALSE(description.settled_at) << "it changes to the end";
}

TEST(Describe, SaysWhereARunInHasSettled) {
  // Within 5 % of its change after three time constants.
  const CourseDescription description = *Describe(CourseOf(
      1000, 5,
      [](std::size_t cycle) { return 0.6 - 0.25 * std::exp(-static_cast<double>(cycle) / 100); },
      0.0, 0.002));
  ASSERT_TRUE(description.settled_at);
  EXPECT_NEAR(static_cast<double>(*description.settled_at), 300.0, 60.0);
  EXPECT_FALSE(Describe(CourseOf(1000, 5, Level))->settled_at);
}

// A law of segments misses a curve by more than the scatter, the less of this the more.
TEST(Describe, FindsARunInAndABumpWhateverTheScatter) {
  for (const double noise : {0.0, 0.1, 1.0, 3.0}) {
    for (const std::size_t cycles : {100U, 300U, 3000U}) {
      const double count = static_cast<double>(cycles);
      const CourseDescription run_in = *Describe(CourseOf(
          cycles, 3,
          [&](std::size_t cycle) {
            return kLevel * (1.5 - 0.5 * std::exp(-10 * static_cast<double>(cycle) / count));
          },
          0.0, noise));
      ASSERT_THAT(run_in.trends, Not(IsEmpty())) << noise << ' ' << cycles;
      EXPECT_GT(run_in.trends.front().to, 1.3 * kLevel);
      EXPECT_TRUE(run_in.settled_at || noise > 1);
      const CourseDescription bump = *Describe(CourseOf(
          cycles, 3,
          [&](std::size_t cycle) {
            return kLevel *
                   (1 + 0.5 * std::sin(std::numbers::pi * static_cast<double>(cycle) / count));
          },
          0.0, noise));
      ASSERT_THAT(bump.trends, SizeIs(2)) << noise << ' ' << cycles;
      EXPECT_NEAR(bump.trends[0].to, 1.5 * kLevel, 0.1 * kLevel);
      EXPECT_NEAR(bump.trends[1].from, 1.5 * kLevel, 0.1 * kLevel);
      EXPECT_THAT(bump.steps, IsEmpty());
    }
  }
}

TEST(Describe, DoesNotMindOneCycleThatIsOff) {
  for (const std::size_t off : {2U, 50U, 98U}) {
    EXPECT_FALSE(Describe(CourseOf(100, 9,
                                   [&](std::size_t cycle) {
                                     return cycle == off ? kLevel + 20 * kNoise : kLevel;
                                   }))
                     ->changed())
        << off;
  }
}

TEST(Describe, DoesNotDependOnTheUnit) {
  const auto truth = [](std::size_t cycle) { return cycle <= 70 ? kLevel : 0.8 * kLevel; };
  const CourseDescription one = *Describe(CourseOf(150, 11, truth));
  for (const double factor : {1e-12, 1e9}) {
    const CourseDescription other = *Describe(CourseOf(
        150, 11, [&](std::size_t cycle) { return factor * truth(cycle); }, 0.0, factor * kNoise));
    ASSERT_EQ(other.steps.size(), one.steps.size());
    EXPECT_EQ(other.steps[0].first_cycle, one.steps[0].first_cycle);
    EXPECT_NEAR(other.steps[0].to / factor, one.steps[0].to, 1e-9 * kLevel);
  }
}

TEST(Describe, OfValuesWithoutNoiseIsThatOfTheValues) {
  Course course;
  for (std::size_t cycle = 1; cycle <= 100; ++cycle) course.Add(cycle, cycle <= 60 ? 5.0 : 4.0);
  const CourseDescription description = *Describe(course);
  ASSERT_THAT(description.steps, SizeIs(1));
  EXPECT_EQ(description.steps[0].first_cycle, 61U);
  EXPECT_NEAR(description.steps[0].from, 5.0, 1e-12);
  EXPECT_NEAR(description.steps[0].to, 4.0, 1e-12);
  EXPECT_THAT(description.trends, IsEmpty());
  Course still;
  for (std::size_t cycle = 1; cycle <= 100; ++cycle) still.Add(cycle, 5.0);
  EXPECT_FALSE(Describe(still)->changed());
}

}  // namespace
}  // namespace mindahl::campaign::changes_test
