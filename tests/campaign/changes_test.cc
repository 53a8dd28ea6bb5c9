

#include <tuple>

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
  std::size_t count = 0;
  std::size_t next = 1;
  for (const Course::Bin& bin : course.bins()) {
    EXPECT_EQ(bin.first_cycle, next);
    EXPECT_NEAR(bin.value, 2 * bin.cycle, 1e-9 * bin.value);
    EXPECT_NEAR(bin.cycle,
                (static_cast<double>(bin.first_cycle) + static_cast<double>(bin.last_cycle)) / 2,
                1e-9 * bin.cycle);
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
  for (const Course::Bin& bin : course.bins().first(Course::kMostBins / 2)) {
    EXPECT_NEAR(bin.value, 2010.0 / 101.0, 1e-12);
    EXPECT_EQ(bin.weight, 101.0);
  }
}

bool IsFinite(const CourseDescription& description) {
  const auto is_finite = [](const Stretch& stretch) {
    return std::isfinite(stretch.at_start) && std::isfinite(stretch.at_end) &&
           std::isfinite(stretch.slope) && std::isfinite(stretch.slope_p_value);
  };
  const auto is_told = [](const Change& change) {
    return std::isfinite(change.before) && std::isfinite(change.after) &&
           std::isfinite(change.p_value);
  };
  return !description.stretches.empty() && std::ranges::all_of(description.stretches, is_finite) &&
         std::ranges::all_of(description.changes, is_told);
}

// A force of 1e300 among others: squares of what follows from it are no doubles.
TEST(Changes, OfValuesWhoseSquaresOverflowAreFinite) {
  constexpr double kLargest = 1.7e308;
  for (const double huge : {1e300, -1e300, kLargest, -kLargest}) {
    for (const std::size_t place : {1U, 50U, 99U, 100U}) {
      Course course;
      for (std::size_t cycle = 1; cycle <= 100; ++cycle) {
        course.Add(cycle, cycle == place ? huge : kLevel + 0.01 * static_cast<double>(cycle % 7));
      }
      EXPECT_TRUE(IsFinite(FindChanges(course))) << huge << " at " << place;
    }
    Course all;
    for (std::size_t cycle = 1; cycle <= 1000; ++cycle) {
      all.Add(cycle, cycle % 3 == 0 ? -huge : huge, cycle % 2 == 0 ? 1e290 : 1e-290);
    }
    EXPECT_TRUE(IsFinite(FindChanges(all))) << huge;
  }
}

TEST(Changes, AreNotMadeByOneCycle) {
  // A spike in the record makes one cycle's value far off; a change lasts.
  int found = 0;
  for (int k = 0; k < 100; ++k) {
    const std::size_t spike = 3 + 37 * static_cast<std::size_t>(k) % 95;
    const CourseDescription description =
        FindChanges(CourseOf(100, static_cast<std::uint64_t>(k), [spike](std::size_t cycle) {
          return cycle == spike ? kLevel + 20 * kNoise : kLevel;
        }));
    found += description.changes.empty() ? 0 : 1;
  }
  EXPECT_LE(found, 4);  // one is expected, five come once in three hundred tests
}

// Correlation that lasts for twenty cycles and has a fifth of the variance: 0.19 between
// neighbours, and means of many cycles vary nine times as much as of independent ones.
TEST(Changes, AreHardlyFoundInSlowNoiseBelowFastNoise) {
  int found = 0;
  for (int k = 0; k < 100; ++k) {
    Generator generator(static_cast<std::uint64_t>(k));
    Course course;
    constexpr double kPhi = 0.95;
    double slow = Normal(generator);
    for (std::size_t cycle = 1; cycle <= 500; ++cycle) {
      course.Add(cycle, kLevel + kNoise * (0.5 * slow + Normal(generator)));
      slow = kPhi * slow + std::sqrt(1 - kPhi * kPhi) * Normal(generator);
    }
    found += FindChanges(course).changes.empty() ? 0 : 1;
  }
  // By neighbours alone 67 of 100 have one. Three standard errors above 12 %, as measured over 200.
  EXPECT_LE(found, 22);
}

TEST(Changes, TheSlopeHasTheChanceOfItsLineThroughTwelveCycles) {
  // 100 + k/5 ± 1 in turn, k = 1 … 12: Σ(k − 6.5)² = 143, Σ(k − 6.5)(±1) = 6. Neighbours that turn
  // their sign inflate nothing, and a line takes two of twelve degrees of freedom.
  Course course;
  for (std::size_t k = 1; k <= 12; ++k) {
    course.Add(k, 100 + 0.2 * static_cast<double>(k) + (k % 2 == 0 ? 1.0 : -1.0));
  }
  const CourseDescription description = FindChanges(course);
  ASSERT_EQ(description.stretches.size(), 1U);
  const double slope = 0.2 + 6.0 / 143;
  const double variance = (12 - 6.0 * 6.0 / 143) / 10;
  EXPECT_NEAR(description.stretches[0].slope, slope, 1e-12);
  EXPECT_NEAR(description.stretches[0].slope_p_value,
              std::erfc(slope / std::sqrt(2 * variance / 143)), 1e-12);
}

TEST(Changes, SlopesOfCorrelatedCyclesAreJudgedByFewerOfThem) {
  // Neighbours correlated by 0.8: n cycles tell as much as n/9, and a slope by chance is beyond
  // 0.01 in two courses of five where they count for n.
  int found = 0;
  for (int k = 0; k < 100; ++k) {
    const CourseDescription description =
        FindChanges(CourseOf(200, static_cast<std::uint64_t>(k), Level, 0.8));
    found += description.stretches.front().slope_p_value < 0.01 ? 1 : 0;
  }
  EXPECT_LE(found, 6);  // one is expected, seven come once in a million tests
}

TEST(Changes, PValuesCountEveryPlaceTried) {
  // A step is accepted up to p = chance, places included: of many that are hardly visible the
  // largest is close below it, and without the factor of 100 places it would be below 1e-4.
  const double chance = ChangeThresholds().chance;
  double largest = 0.0;
  for (int k = 0; k < 200; ++k) {
    const CourseDescription description =
        FindChanges(CourseOf(100, static_cast<std::uint64_t>(k), [](std::size_t cycle) {
          return cycle < 51 ? kLevel : kLevel + 2 * kNoise;
        }));
    for (const Change& change : description.changes) {
      if (description.changes.size() == 1) largest = std::max(largest, change.p_value);
    }
  }
  EXPECT_GT(largest, 0.1 * chance);
}

TEST(Changes, AreNoneInNothing) {
  EXPECT_TRUE(FindChanges(Course()).stretches.empty());
  Course one;
  one.Add(1, kLevel);
  EXPECT_TRUE(FindChanges(one).stretches.empty());
}

TEST(Changes, DescribeAStraightLineToTheLastDigits) {
  Course course;
  for (std::size_t cycle = 1; cycle <= 100; ++cycle) {
    course.Add(cycle, 3.0 + 0.25 * static_cast<double>(cycle));
  }
  const CourseDescription description = FindChanges(course);
  ASSERT_EQ(description.stretches.size(), 1U);
  EXPECT_TRUE(description.changes.empty());
  const Stretch& stretch = description.stretches.front();
  EXPECT_EQ(stretch.first_cycle, 1U);
  EXPECT_EQ(stretch.last_cycle, 100U);
  EXPECT_NEAR(stretch.at_start, 3.25, 1e-12);
  EXPECT_NEAR(stretch.at_end, 28.0, 1e-12);
  EXPECT_NEAR(stretch.slope, 0.25, 1e-14);
  EXPECT_TRUE(stretch.trends);
}

// A chance of 0.01 is asked of each change; of 300 courses 3 are expected, 9 are beyond chance.
constexpr int kCourses = 300;
constexpr int kMostFalse = 9;

TEST(Changes, AreNotFoundInNoise) {
  for (const double phi : {0.0, 0.5}) {
    for (const std::size_t cycles : {20U, 100U, 2000U}) {
      int found = 0;
      for (int k = 0; k < kCourses / 3; ++k) {
        const CourseDescription description =
            FindChanges(CourseOf(cycles, static_cast<std::uint64_t>(k), Level, phi));
        found += description.changes.empty() ? 0 : 1;
      }
      EXPECT_LE(found, kMostFalse) << cycles << " cycles, phi " << phi;
    }
  }
}

TEST(Changes, TrendsAreNotFoundInNoise) {
  // Noise so large that a slope by chance is more than 1 % of the level.
  int found = 0;
  for (int k = 0; k < kCourses; ++k) {
    const CourseDescription description =
        FindChanges(CourseOf(100, static_cast<std::uint64_t>(k), Level, 0.0, 20 * kNoise));
    for (const Stretch& stretch : description.stretches) found += stretch.trends ? 1 : 0;
  }
  EXPECT_LE(found, kMostFalse);
}

TEST(Changes, FindAStepWhereItIs) {
  constexpr std::size_t kCycles = 1000;
  constexpr std::size_t kStep = 601;
  int covered = 0;
  int more = 0;
  for (int k = 0; k < 100; ++k) {
    const CourseDescription description =
        FindChanges(CourseOf(kCycles, static_cast<std::uint64_t>(k), [](std::size_t cycle) {
          return cycle < kStep ? kLevel : 0.97 * kLevel;
        }));
    ASSERT_FALSE(description.changes.empty()) << k;
    more += description.changes.size() > 1 ? 1 : 0;
    const Change& change = *std::ranges::min_element(description.changes, {}, &Change::p_value);
    EXPECT_EQ(change.kind, ChangeKind::kTransition);
    EXPECT_NEAR(change.before, kLevel, 0.3);
    EXPECT_NEAR(change.after, 0.97 * kLevel, 0.3);
    EXPECT_LT(change.p_value, 1e-10);
    covered += change.lower95 <= kStep && kStep <= change.upper95 ? 1 : 0;
  }
  EXPECT_GE(covered, 89);  // 95, less 2.5 of their scatter
  EXPECT_LE(more, 4);      // one in a hundred by chance
}

// Where cycles tell more and more, those that tell little say nothing of a change.
TEST(Changes, AreNotFoundInNoiseThatFalls) {
  int found = 0;
  for (int k = 0; k < 100; ++k) {
    Generator generator(static_cast<std::uint64_t>(k));
    Course course;
    for (std::size_t cycle = 1; cycle <= 200; ++cycle) {
      const double error = kNoise * 100 / static_cast<double>(cycle);
      course.Add(cycle, kLevel + error * Normal(generator), 1 / (error * error));
    }
    found += FindChanges(course).changes.empty() ? 0 : 1;
  }
  EXPECT_LE(found, 4);  // one in a hundred by chance
}

TEST(Changes, FindTheEndOfARunningIn) {
  // Up by 10 in 200 cycles, and level from there.
  const CourseDescription description = FindChanges(CourseOf(1000, 1, [](std::size_t cycle) {
    return kLevel + 10 * std::min(1.0, static_cast<double>(cycle) / 200);
  }));
  ASSERT_EQ(description.changes.size(), 1U);
  EXPECT_EQ(description.changes.front().kind, ChangeKind::kEndOfRunningIn);
  EXPECT_LE(description.changes.front().lower95, 201U);
  EXPECT_GE(description.changes.front().upper95 + 2, 201U);
  EXPECT_TRUE(description.stretches[0].trends);
  EXPECT_FALSE(description.stretches[1].trends);
}

TEST(Changes, FindTheOnsetOfWear) {
  const CourseDescription description = FindChanges(CourseOf(1000, 1, [](std::size_t cycle) {
    return kLevel - 10 * std::max(0.0, static_cast<double>(cycle) / 500 - 1);
  }));
  ASSERT_EQ(description.changes.size(), 1U);
  EXPECT_EQ(description.changes.front().kind, ChangeKind::kBend);
  EXPECT_LE(description.changes.front().lower95, 510U);
  EXPECT_GE(description.changes.front().upper95, 490U);
  EXPECT_FALSE(description.stretches[0].trends);
  EXPECT_TRUE(description.stretches[1].trends);
  EXPECT_NEAR(description.stretches[1].slope, -0.02, 1e-3);
}

// From 50 to 60 with a time constant of 60 cycles, then 3 % less.
constexpr double kTimeConstant = 60.0;
constexpr std::size_t kStepAt = 700;

double RunningInAndStep(std::size_t cycle) {
  return kLevel - 10 * std::exp(-static_cast<double>(cycle) / kTimeConstant) -
         (cycle < kStepAt ? 0.0 : 0.03 * kLevel);
}

class PreciseChanges : public ::testing::TestWithParam<double> {};  // noise over the level

TEST_P(PreciseChanges, FindAStepInAdditionToRunningIn) {
  int covered = 0;
  int plain = 0;
  constexpr int kCampaigns = 40;
  for (int k = 0; k < kCampaigns; ++k) {
    const double noise = GetParam() * kLevel;
    const CourseDescription description =
        FindChanges(CourseOf(1000, static_cast<std::uint64_t>(k), RunningInAndStep, 0.0, noise));
    ASSERT_GE(description.changes.size(), 2U) << k;
    const Change& settled = description.changes.front();
    const Change& step = description.changes.back();
    plain += description.changes.size() == 2 ? 1 : 0;
    EXPECT_EQ(settled.kind, ChangeKind::kEndOfRunningIn);
    EXPECT_EQ(step.kind, ChangeKind::kTransition);
    // The rate is a fifth of the first after ln 5 time constants.
    const double end = 1 + kTimeConstant * std::log(5.0);
    covered +=
        static_cast<double>(settled.lower95) <= end && end <= static_cast<double>(settled.upper95)
            ? 1
            : 0;
    EXPECT_LE(step.lower95, kStepAt);
    EXPECT_GE(step.upper95, kStepAt);
    // A line or a curve is known better than a cycle.
    EXPECT_NEAR(step.before, kLevel, noise);
    EXPECT_NEAR(step.after, 0.97 * kLevel, noise);
    EXPECT_NEAR(*description.stretches.front().time_constant, kTimeConstant, 0.1 * kTimeConstant);
  }
  EXPECT_GE(covered, 34);  // of 40 38, less three of their scatter
  EXPECT_GE(plain, 37);    // another change by chance in one of a hundred
}

TEST_P(PreciseChanges, FindWearAfterAStep) {
  constexpr std::size_t kWearFrom = 600;
  const auto truth = [](std::size_t cycle) {
    return kLevel - (cycle < 400 ? 0.0 : 3.0) -
           0.01 * (cycle > kWearFrom ? static_cast<double>(cycle - kWearFrom) : 0.0);
  };
  const double noise = GetParam() * kLevel;
  const CourseDescription description = FindChanges(CourseOf(1000, 7, truth, 0.0, noise));
  ASSERT_EQ(description.changes.size(), 2U);
  const Change& step = description.changes.front();
  EXPECT_EQ(step.kind, ChangeKind::kTransition);
  EXPECT_LE(step.lower95, 400U);
  EXPECT_GE(step.upper95, 400U);
  const Change& wear = description.changes.back();
  EXPECT_EQ(wear.kind, ChangeKind::kBend);
  EXPECT_LE(wear.lower95, kWearFrom);
  EXPECT_GE(wear.upper95 + 15, kWearFrom);  // the bend is not a step: it is as good before it
  EXPECT_NEAR(description.stretches.back().slope, -0.01, 1e-3);
}

INSTANTIATE_TEST_SUITE_P(Noise, PreciseChanges, ::testing::Values(8e-3, 8e-4, 8e-5));

TEST(Changes, SayNoValueThatNoCycleHad) {
  // Neither straight nor exponential: lines through it end beyond it.
  const auto truth = [](std::size_t cycle) {
    return kLevel + 10 / std::sqrt(static_cast<double>(cycle));
  };
  const CourseDescription description = FindChanges(CourseOf(1000, 8, truth, 0.0, 1e-3));
  ASSERT_FALSE(description.changes.empty());
  constexpr double kFiveDeviations = 5e-3;
  for (const Stretch& stretch : description.stretches) {
    for (const double value : {stretch.at_start, stretch.at_end}) {
      EXPECT_LE(value, truth(stretch.first_cycle) + kFiveDeviations);
      EXPECT_GE(value, truth(stretch.last_cycle) - kFiveDeviations);
    }
  }
  for (std::size_t k = 0; k < description.changes.size(); ++k) {
    const Stretch& before = description.stretches[k];
    const Stretch& after = description.stretches[k + 1];
    const Change& change = description.changes[k];
    EXPECT_GE(change.before, truth(after.last_cycle) - kFiveDeviations);
    EXPECT_LE(change.before, truth(before.first_cycle) + kFiveDeviations);
    EXPECT_GE(change.after, truth(after.last_cycle) - kFiveDeviations);
    EXPECT_LE(change.after, truth(before.first_cycle) + kFiveDeviations);
  }
}

TEST(Changes, TellTheCycleWithinABinOfSeveral) {
  // Bins of eight cycles, a step in the middle of one: the mean of that says where.
  for (const std::size_t step : {2043U, 2045U, 2047U}) {
    const CourseDescription description = FindChanges(CourseOf(
        4000, 3, [step](std::size_t cycle) { return cycle < step ? kLevel : 0.9 * kLevel; }, 0.0,
        1e-3 * kLevel));
    ASSERT_EQ(description.changes.size(), 1U) << step;
    EXPECT_EQ(description.changes.front().cycle, step);
  }
}

TEST(Stretches, SegmentsPassThroughTheirEnds) {
  Stretch stretch{.first_cycle = 11, .last_cycle = 31, .at_start = 5.0, .at_end = 3.0};
  EXPECT_DOUBLE_EQ(stretch.At(11), 5.0);
  EXPECT_DOUBLE_EQ(stretch.At(31), 3.0);
  EXPECT_DOUBLE_EQ(stretch.At(21), 4.0);
  stretch.time_constant = 10.0;
  EXPECT_DOUBLE_EQ(stretch.At(11), 5.0);
  EXPECT_DOUBLE_EQ(stretch.At(31), 3.0);
  // a + b·e^(−n/τ): b = 2/(1 − e⁻²), one time constant on.
  EXPECT_NEAR(stretch.At(21), 5 - 2 * (1 - std::exp(-1.0)) / (1 - std::exp(-2.0)), 1e-14);
}

TEST(Changes, DoNotDependOnTheUnit) {
  const auto in_unit = [](double unit) {
    return FindChanges(CourseOf(
        500, 3, [unit](std::size_t cycle) { return unit * (cycle < 300 ? kLevel : 0.9 * kLevel); },
        0.0, unit * kNoise));
  };
  for (const double unit : {1e-12, 1e9}) {
    const CourseDescription one = in_unit(1.0);
    const CourseDescription other = in_unit(unit);
    ASSERT_EQ(one.changes.size(), other.changes.size());
    EXPECT_EQ(one.changes.front().cycle, other.changes.front().cycle);
    EXPECT_NEAR(other.changes.front().p_value / one.changes.front().p_value, 1.0, 1e-3);
  }
}

// --- Thresholds: each decides about a course that lies within a factor of two of it
// ----------------

TEST(ChangeThresholds, StepIsTwoPercentOfTheLevel) {
  const auto kind_of = [](double step) {
    return FindChanges(CourseOf(
                           2000, 1,
                           [step](std::size_t cycle) {
                             return cycle < 1001 ? kLevel : (1 - step) * kLevel;
                           },
                           0.0, 0.2))
        .changes.front()
        .kind;
  };
  EXPECT_EQ(kind_of(0.012), ChangeKind::kBend);
  EXPECT_EQ(kind_of(0.03), ChangeKind::kTransition);
}

TEST(ChangeThresholds, TrendIsOnePercentOfTheLevel) {
  const auto trends = [](double share) {
    return FindChanges(CourseOf(
                           2000, 1,
                           [share](std::size_t cycle) {
                             return kLevel * (1 + share * static_cast<double>(cycle) / 2000);
                           },
                           0.0, 0.2))
        .stretches.front()
        .trends;
  };
  EXPECT_FALSE(trends(0.006));
  EXPECT_TRUE(trends(0.015));
}

TEST(ChangeThresholds, RunningInHasSettledAtAFifthOfItsSlope) {
  const auto kind_of = [](double share) {
    return FindChanges(CourseOf(
                           2000, 1,
                           [share](std::size_t cycle) {
                             const double x = static_cast<double>(cycle) / 1000;
                             return kLevel + 10 * (std::min(x, 1.0) + share * std::max(x - 1, 0.0));
                           },
                           0.0, 0.2))
        .changes.front()
        .kind;
  };
  EXPECT_EQ(kind_of(0.13), ChangeKind::kEndOfRunningIn);
  EXPECT_EQ(kind_of(0.3), ChangeKind::kBend);
}

TEST(ChangeThresholds, RunningInHasSettledAtAFifthOfItsFirstSlopeAfterOthers) {
  // Slopes of 10, 5 and a sixth or a third of 10, in thousands of cycles.
  const auto kinds_of = [](double share) {
    const CourseDescription description = FindChanges(CourseOf(
        3000, 1,
        [share](std::size_t cycle) {
          const double x = static_cast<double>(cycle) / 1000;
          return kLevel + 10 * (std::min(x, 1.0) + 0.5 * std::clamp(x - 1, 0.0, 1.0) +
                                share * std::max(x - 2, 0.0));
        },
        0.0, 0.1));
    std::vector<ChangeKind> kinds;
    for (const Change& change : description.changes) kinds.push_back(change.kind);
    return kinds;
  };
  EXPECT_THAT(kinds_of(0.15), ElementsAre(ChangeKind::kBend, ChangeKind::kEndOfRunningIn));
  EXPECT_THAT(kinds_of(0.3), ElementsAre(ChangeKind::kBend, ChangeKind::kBend));
}

TEST(Changes, DescribeWhatSettlesByItsWeights) {
  // a + b·e^(−n/τ), τ of those that are tried, 1.2^k, and every third value far off but of next to
  // no weight.
  const double tau = std::pow(1.2, 16);
  Course course;
  for (std::size_t cycle = 1; cycle <= 300; ++cycle) {
    const double value = kLevel - 20 * std::exp(-static_cast<double>(cycle) / tau);
    const bool is_off = cycle % 3 == 0;
    course.Add(cycle, is_off ? value + (cycle % 2 == 0 ? 5 : -5) : value, is_off ? 1e-9 : 1.0);
  }
  const CourseDescription description = FindChanges(course);
  ASSERT_FALSE(description.stretches.empty());
  const Stretch& first = description.stretches.front();
  ASSERT_TRUE(first.time_constant);
  // Other time constants are a fifth away.
  EXPECT_NEAR(*first.time_constant / tau, 1.0, 0.1);
  EXPECT_NEAR(first.at_start, kLevel - 20 * std::exp(-1 / tau), 0.05 * 20);
  EXPECT_NEAR(description.stretches.back().at_end, kLevel, 0.01 * 20);
}

TEST(ChangeThresholds, ChanceIsOneInAHundred) {
  // At ten times the chance, or ten times less, another share of courses has a change.
  const auto found = [](double chance) {
    ChangeThresholds thresholds;
    thresholds.chance = chance;
    int count = 0;
    for (int k = 0; k < 100; ++k) {
      const double step = 1.8;  // standard deviations, of 100 cycles
      count += FindChanges(CourseOf(100, static_cast<std::uint64_t>(k),
                                    [step](std::size_t cycle) {
                                      return cycle < 51 ? kLevel : kLevel + step * kNoise;
                                    }),
                           thresholds)
                       .changes.empty()
                   ? 0
                   : 1;
    }
    return count;
  };
  const int at_default = found(ChangeThresholds().chance);
  EXPECT_GT(found(0.1), at_default + 5);
  EXPECT_LT(found(0.001), at_default - 5);
}

TEST(ChangeKinds, HaveNames) {
  EXPECT_EQ(NameOf(ChangeKind::kEndOfRunningIn), "end_of_running_in");
  EXPECT_EQ(NameOf(ChangeKind::kTransition), "transition");
  EXPECT_EQ(NameOf(ChangeKind::kBend), "bend");
}

// --- descriptions by another way

/// A line of least squares through values at 1, 2, 3, … from `begin` to before `end`.
struct PlainLine {
  PlainLine(std::span<const double> values, std::size_t begin, std::size_t end) {
    const auto count = static_cast<double>(end - begin);
    double xx = 0.0;
    double xy = 0.0;
    for (std::size_t i = begin; i < end; ++i) {
      x_mean += static_cast<double>(i + 1) / count;
      y_mean += values[i] / count;
    }
    for (std::size_t i = begin; i < end; ++i) {
      const double x = static_cast<double>(i + 1) - x_mean;
      xx += x * x;
      xy += x * (values[i] - y_mean);
    }
    slope = xy / xx;
    for (std::size_t i = begin; i < end; ++i) {
      squares += std::pow(values[i] - At(static_cast<double>(i + 1)), 2);
    }
  }
  [[nodiscard]] double At(double x) const { return y_mean + slope * (x - x_mean); }

  double x_mean = 0.0;
  double y_mean = 0.0;
  double slope = 0.0;
  double squares = 0.0;
};

TEST(Changes, OfAStepAreThoseOfTheBestOfAllPlaces) {
  // 100 and from the 15th cycle on 103 with a slope, ± 1 in turn: neighbours turn their sign, which
  // inflates nothing, and no value is far from its neighbours.
  constexpr std::size_t kCycles = 40;
  std::vector<double> values;
  Course course;
  for (std::size_t k = 1; k <= kCycles; ++k) {
    const double level = k < 15 ? 100.0 : 106.0 + 0.125 * static_cast<double>(k);
    values.push_back(level + (k % 2 == 0 ? 1.0 : -1.0));
    course.Add(k, values.back());
  }
  const CourseDescription description = FindChanges(course);
  ASSERT_EQ(description.changes.size(), 1U);
  ASSERT_EQ(description.stretches.size(), 2U);
  // The best of all places with four cycles on either side, without a cycle left out.
  std::size_t best = 0;
  std::vector<double> squares(kCycles, HUGE_VAL);
  for (std::size_t at = 2; at + 2 <= kCycles; ++at) {
    squares[at] = PlainLine(values, 0, at).squares + PlainLine(values, at, kCycles).squares;
    if (at >= 4 && at + 4 <= kCycles && squares[at] < squares[best]) best = at;
  }
  const PlainLine before(values, 0, best);
  const PlainLine after(values, best, kCycles);
  const Change& change = description.changes[0];
  EXPECT_EQ(change.kind, ChangeKind::kTransition);
  EXPECT_EQ(change.cycle, best + 1);
  constexpr double kRounding = 1e-9;
  EXPECT_NEAR(change.before, before.At(static_cast<double>(best + 1)), kRounding);
  EXPECT_NEAR(change.after, after.At(static_cast<double>(best + 1)), kRounding);
  const double without = PlainLine(values, 0, kCycles).squares;
  EXPECT_NEAR(std::log(change.p_value),
              std::log(kCycles) - 0.5 * kCycles * std::log(without / squares[best]), 1e-6);
  // The interval is of the places whose likelihood ratio is not beyond χ² of one parameter.
  std::size_t lower = best;
  std::size_t upper = best;
  for (std::size_t at = 2; at + 2 <= kCycles; ++at) {
    if (kCycles * std::log(squares[at] / squares[best]) > 3.841458820694124) continue;
    lower = std::min(lower, at);
    upper = std::max(upper, at);
  }
  EXPECT_EQ(change.lower95, lower + 1);
  EXPECT_EQ(change.upper95, upper + 1);
  const Stretch& first = description.stretches[0];
  const Stretch& second = description.stretches[1];
  EXPECT_EQ(first.first_cycle, 1U);
  EXPECT_EQ(first.last_cycle, best);
  EXPECT_EQ(second.first_cycle, best + 1);
  EXPECT_EQ(second.last_cycle, kCycles);
  EXPECT_NEAR(first.at_start, before.At(1), kRounding);
  EXPECT_NEAR(first.at_end, before.At(static_cast<double>(best)), kRounding);
  EXPECT_NEAR(second.at_start, after.At(static_cast<double>(best + 1)), kRounding);
  EXPECT_NEAR(second.at_end, after.At(kCycles), kRounding);
  EXPECT_NEAR(second.slope, after.slope, kRounding);
  // Two lines take four of forty degrees of freedom.
  const double n = static_cast<double>(kCycles - best);
  const double spread = n * (n * n - 1) / 12;
  const double variance = squares[best] / (kCycles - 4);
  EXPECT_NEAR(second.slope_p_value, std::erfc(after.slope / std::sqrt(2 * variance / spread)),
              kRounding);
  EXPECT_FALSE(first.time_constant || second.time_constant);
}

/// The description of a course that runs in, steps and wears, its values and cycles changed.
CourseDescription ChangedCourse(double factor, std::size_t shift, double weight) {
  Generator generator(3);
  Course course;
  for (std::size_t k = 1; k <= 400; ++k) {
    const double x = static_cast<double>(k);
    const double value = kLevel - 8 * std::exp(-x / 25) - (k < 180 ? 0.0 : 4.0) -
                         0.03 * std::max(0.0, x - 260) + 0.2 * Normal(generator);
    course.Add(k + shift, factor * value, weight);
  }
  return FindChanges(course);
}

TEST(Changes, FollowTheSignTheUnitAndTheNumberOfTheCycles) {
  // Powers of two and the sign change no digit.
  const CourseDescription plain = ChangedCourse(1.0, 0, 1.0);
  ASSERT_GE(plain.changes.size(), 2U);
  for (const auto& [factor, shift, weight] :
       {std::tuple(-1.0, 0U, 1.0), {1024.0, 0U, 0.25}, {1.0, 1000U, 1.0}}) {
    const CourseDescription other = ChangedCourse(factor, shift, weight);
    ASSERT_EQ(other.changes.size(), plain.changes.size());
    ASSERT_EQ(other.stretches.size(), plain.stretches.size());
    constexpr double kDigits = 1e-6;  // of a time constant that is searched for
    const auto near = [&, f = factor](double value, double expected) {
      EXPECT_NEAR(value / f, expected, kDigits * std::abs(expected));
    };
    for (std::size_t k = 0; k < plain.changes.size(); ++k) {
      EXPECT_EQ(other.changes[k].kind, plain.changes[k].kind);
      EXPECT_EQ(other.changes[k].cycle, plain.changes[k].cycle + shift);
      EXPECT_EQ(other.changes[k].lower95, plain.changes[k].lower95 + shift);
      EXPECT_EQ(other.changes[k].upper95, plain.changes[k].upper95 + shift);
      near(other.changes[k].before, plain.changes[k].before);
      near(other.changes[k].after, plain.changes[k].after);
    }
    for (std::size_t k = 0; k < plain.stretches.size(); ++k) {
      EXPECT_EQ(other.stretches[k].first_cycle, plain.stretches[k].first_cycle + shift);
      EXPECT_EQ(other.stretches[k].last_cycle, plain.stretches[k].last_cycle + shift);
      EXPECT_EQ(other.stretches[k].trends, plain.stretches[k].trends);
      near(other.stretches[k].at_start, plain.stretches[k].at_start);
      near(other.stretches[k].at_end, plain.stretches[k].at_end);
      near(other.stretches[k].slope, plain.stretches[k].slope);
    }
  }
}

TEST(Changes, FindAllOfACourseThatRunsInStepsAndWears) {
  const CourseDescription description = ChangedCourse(1.0, 0, 1.0);
  ASSERT_EQ(description.changes.size(), 3U);
  EXPECT_EQ(description.changes[0].kind, ChangeKind::kEndOfRunningIn);
  // The rate is a fifth of the first after ln 5 time constants of 25 cycles; the fall of 8 from
  // its first value is then a fifth too.
  EXPECT_NEAR(static_cast<double>(description.changes[0].cycle), 1 + 25 * std::log(5.0), 5.0);
  EXPECT_NEAR(description.changes[0].before, kLevel - 8.0 / 5, 0.3);
  EXPECT_EQ(description.changes[0].before, description.changes[0].after);
  EXPECT_NEAR(*description.stretches[0].time_constant, 25.0, 4.0);
  EXPECT_EQ(*description.stretches[1].time_constant, *description.stretches[0].time_constant);
  EXPECT_EQ(description.stretches[1].first_cycle, description.stretches[0].last_cycle + 1);
  EXPECT_NEAR(description.stretches[0].at_start, kLevel - 8 * std::exp(-1.0 / 25), 0.3);
  EXPECT_EQ(description.changes[1].kind, ChangeKind::kTransition);
  EXPECT_EQ(description.changes[1].cycle, 180U);
  EXPECT_EQ(description.changes[2].kind, ChangeKind::kBend);
  EXPECT_LE(description.changes[2].lower95, 265U);
  EXPECT_GE(description.changes[2].upper95, 255U);
  EXPECT_NEAR(description.stretches[3].slope, -0.03, 0.002);
  EXPECT_NEAR(description.stretches[3].at_end, kLevel - 4 - 0.03 * 140, 0.3);
  for (const Change& change : description.changes) {
    EXPECT_LE(change.lower95, change.cycle);
    EXPECT_GE(change.upper95, change.cycle);
    EXPECT_LT(change.p_value, 1e-6);
  }
}

}  // namespace
}  // namespace mindahl::campaign::changes_test
