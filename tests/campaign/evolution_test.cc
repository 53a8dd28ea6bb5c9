#include "mindahl/campaign/evolution.h"

#include <fmt/format.h>

#include "support/histories.h"
#include "support/prelude.h"

namespace mindahl::campaign::evolution_test {
namespace {

/// A quantity by its name, described by hand.
Evolution Of(std::string_view name, std::string unit, CourseDescription description) {
  std::vector<Evolution> all = BeginEvolutions(false);
  Evolution& evolution = *std::ranges::find_if(
      all, [&](const Evolution& each) { return each.quantity->name == name; });
  evolution.unit = std::move(unit);
  evolution.description = std::move(description);
  for (std::size_t cycle = 1; cycle <= 200; ++cycle) {
    evolution.course.Add(cycle, cycle % 2 == 0 ? 5e7 : 4e7);
  }
  return evolution;
}

std::vector<Evolution> RunIn() {
  return {
      Of("friction_coefficient", "-",
         {.from = 0.352, .to = 0.6, .settled_at = 480, .changes = {{1, 480, 0.352, 0.6, 1e-20}}}),
      Of("slip_force", "N", {.from = 35.2, .to = 60, .changes = {{1, 480, 35.2, 60, 1e-20}}}),
      Of("sigma", "N/m", {.from = 5e7, .to = 8e7, .changes = {{61, 61, 5e7, 8e7, 0.003}}}),
      Of("contact_radius", "m",
         {.from = 250e-6, .to = 400e-6, .changes = {{61, 61, 250e-6, 400e-6, 0.003}}}),
      Of("alpha", "-", {.from = 0.33, .to = 0.34})};
}

TEST(Headline, SaysTheTestInOneLine) {
  EXPECT_EQ(Headline(RunIn()), "μ 0.352 → 0.600, settled at cycle 480; σ +60 %; a 250 → 400 µm");
  std::vector<Evolution> still = {Of("slip_force", "N", {.from = 15.0, .to = 15.1}),
                                  Of("half_gap", "N", {.from = 14.0, .to = 14.1}),
                                  Of("sigma", "N/m", {.from = 4.8e7, .to = 4.81e7})};
  EXPECT_EQ(Headline(still),
            "Tc 15.0 N throughout, but for scatter; σ 48.0 N/µm throughout, but for scatter");
  still.resize(1);
  still.front().course = {};
  still.front().course.Add(1, 15.0);
  still.front().course.Add(2, 15.1);
  EXPECT_EQ(Headline(still), "Tc 15.0 → 15.1 N, in too few rows to test");
  EXPECT_EQ(Headline({}), "");
}

TEST(Describe, StandsForAnUnchangedQuantityByItsMean) {
  Course course;
  for (std::size_t cycle = 1; cycle <= 60; ++cycle) course.Add(cycle, cycle % 2 == 0 ? 0.5 : 0.7);
  const CourseDescription description = Describe(course);
  EXPECT_FALSE(description.changed());
  EXPECT_NEAR(description.from, 0.6, 1e-12);
}

TEST(Headline, NeverFallsByMoreThanAHundredPercent) {
  const std::vector<Evolution> turned = {
      Of("sigma", "N/m", {.from = 2.0, .to = -3.0, .changes = {{9, 9, 2.0, -3.0, 1e-9}}})};
  EXPECT_EQ(Headline(turned), "σ 2.00 → -3.00 N/m");
  EXPECT_THAT(ChangeStatements(turned),
              ElementsAre("sigma: a step at cycle 9, 2.00 → -3.00 N/m, p = 1e-09"));
}

TEST(Headline, SaysWithinWhatAQuantityVaries) {
  const std::vector<Evolution> evolutions = {
      Of("slip_force", "N", {.from = 10.5, .to = 19.5, .varies = true})};
  EXPECT_EQ(Headline(evolutions), "Tc varies from 10.5 to 19.5 N");
  EXPECT_THAT(ChangeStatements(evolutions),
              ElementsAre("slip_force: varies from 10.5 to 19.5 N, with no lasting step or trend"));
}

TEST(ChangeStatements, NameEachStepAndTrend) {
  EXPECT_THAT(ChangeStatements(RunIn()),
              ElementsAre("friction_coefficient: cycles 1 to 480, 0.352 → 0.600 (+70 %), p < 1e-12",
                          "slip_force: cycles 1 to 480, 35.2 → 60.0 N (+70 %), p < 1e-12",
                          "sigma: a step at cycle 61, 50.0 → 80.0 N/µm (+60 %), p = 0.003",
                          "contact_radius: a step at cycle 61, 250 → 400 µm (+60 %), p = 0.003"));
}

TEST(ChangeStatements, OfManyAreTheLargest) {
  CourseDescription course{.from = 1, .to = 2};
  for (std::size_t k = 1; k <= 15; ++k) {
    course.changes.push_back({k, k, 1.0, 1.0 + 0.03 * static_cast<double>(k), 1e-3});
  }
  const std::vector<std::string> lines =
      ChangeStatements(std::vector<Evolution>{Of("energy", "J", course)});
  ASSERT_THAT(lines, SizeIs(10));
  EXPECT_THAT(lines[0], HasSubstr("at cycle 15,"));
  EXPECT_THAT(lines[8], HasSubstr("at cycle 7,"));
  EXPECT_EQ(lines[9], "and 6 smaller ones, which --json lists");
}

TEST(EvolutionPanels, DrawEachQuantityOverALogarithmicAxisOfCycles) {
  const std::vector<io::PlotPanel> panels = EvolutionPanels(RunIn());
  ASSERT_THAT(panels, SizeIs(5));
  EXPECT_EQ(panels[0].y_label, "friction_coefficient");
  EXPECT_TRUE(panels[0].log_x);
  ASSERT_THAT(panels[0].marks, SizeIs(1));
  EXPECT_EQ(panels[0].marks[0].label, "settled, 480");
  EXPECT_EQ(panels[2].y_label, "sigma [N/µm]");
  EXPECT_EQ(panels[2].marks[0].label, "step, 61");
  const io::PlotSeries& course = panels[2].series[1];
  ASSERT_THAT(course.x, SizeIs(200));
  EXPECT_NEAR(course.y[1], 50.0, 1e-9);
  Evolution one = RunIn()[2];
  one.course = Course();
  one.course.Add(1, 5e7);
  EXPECT_THAT(EvolutionPanels(std::vector<Evolution>{one}), IsEmpty());
}

TEST(FrettingLog, HasALoopACycle) {
  std::vector<Cycle> cycles(2);
  cycles[0].number = 1;
  cycles[1].number = 10;
  for (Cycle& cycle : cycles) {
    cycle.record.displacement = {-2e-6, 2e-6, -2e-6};
    cycle.record.force = {-30.0, 30.0, -30.0};
  }
  const io::PlotPanel panel = FrettingLog(cycles, /*is_torsional=*/false);
  EXPECT_EQ(panel.x_label, "displacement [µm]");
  EXPECT_EQ(panel.y_label, "force [N]");
  ASSERT_THAT(panel.series, SizeIs(2));
  EXPECT_EQ(panel.series[1].label, "cycle 10");
  EXPECT_NEAR(panel.series[1].x[1], 2.0, 1e-12);
  EXPECT_NE(panel.series[0].shade, panel.series[1].shade);
}

TEST(Evolutions, HoldEachQuantityOfACycleUnlessItIsOpen) {
  CycleFit fit;
  fit.number = 7;
  fit["sigma"] = 1.5;
  fit["alpha"] = 2.5;
  fit["slip_force"] = 3.5;
  fit["friction_coefficient"] = 4.5;
  fit["half_gap"] = 5.5;
  fit["energy"] = 6.5;
  fit["energy_ratio"] = 7.5;
  fit["contact_radius"] = 8.5;
  fit["rms"] = 2.0;
  const auto held = [&](const std::vector<std::string>& flags) {
    std::vector<Evolution> evolutions = BeginEvolutions(false);
    fit.flags = flags;
    AddTo(evolutions, fit);
    Describe(evolutions);
    std::vector<std::string> all;
    for (const Evolution& evolution : evolutions) {
      const Course::Bin& bin = evolution.course.bins()[0];
      EXPECT_EQ(bin.first_cycle, 7U);
      all.push_back(fmt::format("{} {}", evolution.quantity->name, bin.value));
    }
    return all;
  };
  const std::vector<std::string> whole = {
      "friction_coefficient 4.5", "slip_force 3.5", "half_gap 5.5", "sigma 1.5",
      "contact_radius 8.5",       "alpha 2.5",      "energy 6.5",   "energy_ratio 7.5"};
  EXPECT_EQ(held({"glitches"}), whole);
  EXPECT_THAT(held({"not_converged"}), IsEmpty());
  EXPECT_THAT(held({"sigma_open"}), AllOf(SizeIs(6), Not(Contains(whole[3]))));
  EXPECT_THAT(held({"alpha_open"}), AllOf(SizeIs(7), Not(Contains(whole[5]))));
  EXPECT_THAT(held({"slip_force_open"}),
              AllOf(SizeIs(6), Not(Contains(whole[0])), Not(Contains(whole[1]))));
}

TEST(Headline, IsOfTheHalfGapWhereFewCyclesDetermineTheSlipForce) {
  std::vector<Evolution> evolutions = BeginEvolutions(false);
  CycleFit fit;
  for (fit.number = 1; fit.number <= 100; ++fit.number) {
    const bool is_first = fit.number <= 20;
    const bool is_open = !is_first && fit.number % 4 != 0;
    fit["slip_force"] = is_first ? 2.0 : 0.4;
    fit["half_gap"] = 0.3;
    fit.flags = is_open ? std::vector<std::string>{"slip_force_open"} : std::vector<std::string>{};
    AddTo(evolutions, fit);
  }
  Describe(evolutions);
  EXPECT_EQ(Headline(evolutions), "half gap 300 mN throughout, but for scatter");
  EXPECT_THAT(ChangeStatements(evolutions), IsEmpty());
}

TEST(Headline, IsOfTheHalfGapWhereASpecimenBreaks) {
  std::vector<Evolution> evolutions = BeginEvolutions(false);
  CycleFit fit;
  for (fit.number = 1; fit.number <= 100; ++fit.number) {
    const bool is_broken = fit.number > 80;
    fit["slip_force"] = 60.0;
    fit["sigma"] = 5e7;
    fit["half_gap"] = is_broken ? 0.01 : 50.0;
    fit.flags = is_broken ? std::vector<std::string>{"slip_force_open", "sigma_open"}
                          : std::vector<std::string>{};
    AddTo(evolutions, fit);
  }
  Describe(evolutions);
  EXPECT_EQ(Headline(evolutions), "half gap 50.0 → 0.0 N, settled at cycle 81");
  EXPECT_EQ(EvolutionPanels(evolutions).front().y_label, "half_gap [N]");
}

// ---
// How a course is described.

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
  double count = 0.0;
  std::size_t next = 1;
  for (const Course::Bin& bin : course.bins()) {
    EXPECT_EQ(bin.first_cycle, next);
    EXPECT_NEAR(bin.value, 2 * bin.cycle, 1e-9 * bin.value);
    count += bin.count;
    next = bin.last_cycle + 1;
  }
  EXPECT_EQ(count, kCycles);
}

TEST(Course, MergesBinsByTheirNumbersOfValues) {
  Course course;
  for (std::size_t cycle = 1; cycle <= Course::kMostBins + 1; ++cycle) {
    course.Add(cycle, cycle % 2 == 0 ? 20.0 : 10.0);
  }
  ASSERT_EQ(course.bins().size(), Course::kMostBins / 2 + 1);
  for (std::size_t k = 0; k + 1 < course.bins().size(); ++k) {
    EXPECT_EQ(course.bins()[k].value, 15.0);
    EXPECT_EQ(course.bins()[k].least, 10.0);
    EXPECT_EQ(course.bins()[k].greatest, 20.0);
  }
}

TEST(Describe, StatesTheFirstAndTheLastValueAsTheTableHasThem) {
  EXPECT_FALSE(Describe(Course()).changed());
  Course falling;  // as a run-in: far from any line
  for (std::size_t cycle = 1; cycle <= 30; ++cycle) {
    falling.Add(10 * cycle, 17.6 + 5.5 * std::exp(-static_cast<double>(cycle)));
  }
  const CourseDescription description = Describe(falling);
  EXPECT_EQ(falling.first(), falling.bins().front().value);
  EXPECT_EQ(falling.last(), falling.bins().back().value);
  for (const Change& change : description.changes) {
    EXPECT_LE(std::max(change.from, change.to), falling.first());
  }
}

TEST(Describe, OfFewRowsIsFromTheFirstToTheLast) {
  Course course;
  for (std::size_t cycle = 1; cycle <= 7; ++cycle) course.Add(cycle, static_cast<double>(cycle));
  EXPECT_DOUBLE_EQ(Describe(course).from, 1.0);
  EXPECT_DOUBLE_EQ(Describe(course).to, 7.0);
}

// A line through a run-in misses its first value by more than the scatter.
TEST(Describe, IsFromTheFirstValueWhereTheLineMissesIt) {
  Generator generator(3);
  Course course;
  for (std::size_t row = 0; row < 12; ++row) {
    const double run_in = std::exp(-static_cast<double>(row) / 1.5);
    course.Add(1 + 10 * row, 16.0 - 4 * run_in + 0.01 * Normal(generator), 10);
  }
  const CourseDescription description = Describe(course);
  ASSERT_TRUE(description.changed());
  EXPECT_GT(description.changes[0].from, 12.5);
  EXPECT_EQ(description.from, course.first());
  const CourseDescription step = Describe(
      CourseOf(200, 7, [](std::size_t cycle) { return cycle < 101 ? kLevel : 1.1 * kLevel; }));
  EXPECT_NEAR(step.from, kLevel, kNoise / 2) << "within its scatter, of all before the step";
  EXPECT_NEAR(step.to, 1.1 * kLevel, kNoise / 2);
}

TEST(Describe, FindsAStepBetweenRowsOfSeveralCycles) {
  constexpr std::size_t kOfARow = 10;
  Course course;
  for (std::size_t cycle = 1; cycle <= 400; cycle += kOfARow) {
    course.Add(cycle, cycle <= 200 ? 5.0 : 4.0, kOfARow);
  }
  const CourseDescription description = Describe(course);
  ASSERT_THAT(description.changes, SizeIs(1));
  EXPECT_EQ(description.changes[0].first_cycle, 201U);
  EXPECT_EQ(description.settled_at, 201U);
}

TEST(Describe, FindsNoStepInACurveWithHardlyAnyNoise) {
  Generator generator(3);
  for (const double settling : {20.0, 60.0, 200.0}) {
    Course course;
    for (std::size_t row = 0; row < 500; ++row) {
      const double n = static_cast<double>(row);
      course.Add(row + 1,
                 0.35 + 0.25 * (1 - std::exp(-n / settling)) + 0.0003 * testing::Normal(generator));
    }
    for (const Change& change : Describe(course).changes) {
      EXPECT_FALSE(change.is_step()) << settling << ": " << change.first_cycle;
    }
  }
}

TEST(Describe, FindsAStepWithinABinOfCyclesWhereItIs) {
  for (const std::size_t place : {3201, 3204, 3210, 3216, 3217}) {
    Course course;
    for (std::size_t cycle = 1; cycle <= 5000; ++cycle)
      course.Add(cycle, cycle < place ? 5.0 : 4.0);
    const CourseDescription description = Describe(course);
    ASSERT_THAT(description.changes, SizeIs(1));
    EXPECT_EQ(description.changes[0].first_cycle, place);
  }
}

TEST(Describe, HardlyEverFindsAChangeInNoise) {
  constexpr int kCourses = 200;
  for (const double noise : {kNoise, kNoise / 5}) {  // the less, the smaller a change is reported
    for (const double phi : {0.0, 0.6}) {
      int found = 0;
      for (std::uint64_t seed = 1; seed <= kCourses; ++seed) {
        found += Describe(CourseOf(200, seed, Level, phi, noise)).changed();
      }
      EXPECT_LE(found, kCourses / 20) << noise << ' ' << phi;
    }
  }
}

TEST(Describe, FindsAStepWhereItIs) {
  for (const std::size_t cycles : {100U, 400U, 3000U}) {
    const std::size_t at = 2 * cycles / 3;
    const CourseDescription description = Describe(
        CourseOf(cycles, 7, [&](std::size_t cycle) { return cycle < at ? kLevel : 1.1 * kLevel; }));
    ASSERT_THAT(description.changes, SizeIs(1)) << cycles;
    const Change& step = description.changes[0];
    EXPECT_TRUE(step.is_step());
    EXPECT_NEAR(static_cast<double>(step.first_cycle), static_cast<double>(at),
                2 + static_cast<double>(cycles) / Course::kMostBins);
    EXPECT_NEAR(step.to / step.from, 1.1, 0.01);
    EXPECT_LT(step.p_value, 1e-6);
  }
}

TEST(Describe, FindsAStepThatStandsOutOfTheScatterWhateverItsPercentage) {
  const CourseDescription step = Describe(CourseOf(
      120, 7, [](std::size_t cycle) { return cycle < 57 ? kLevel : 1.005 * kLevel; }, 0.0, 0.02));
  ASSERT_THAT(step.changes, SizeIs(1));
  EXPECT_EQ(step.changes[0].first_cycle, 57U);
  EXPECT_NEAR(step.changes[0].to / step.changes[0].from, 1.005, 1e-3);
  const CourseDescription trend = Describe(CourseOf(
      200, 7,
      [](std::size_t cycle) { return kLevel * (1 + 0.005 * static_cast<double>(cycle) / 200); },
      0.0, 0.02));
  ASSERT_THAT(trend.changes, SizeIs(1));
  EXPECT_EQ(trend.changes[0].last_cycle, 200U);
}

TEST(Describe, FindsOneStepWhereACycleIsAMixtureOfBothLevels) {
  for (const double share : {0.1, 0.3, 0.6, 0.9}) {
    for (const double factor : {0.8, 1.1}) {
      const CourseDescription description = Describe(CourseOf(
          120, 7,
          [&](std::size_t cycle) {
            const double old = cycle < 57 ? 1.0 : cycle == 57 ? share : 0.0;
            return kLevel * (old + (1 - old) * factor);
          },
          0.0, 0.05));
      ASSERT_THAT(description.changes, SizeIs(1)) << share << ' ' << factor;
      EXPECT_TRUE(description.changes[0].is_step());
      EXPECT_EQ(description.changes[0].first_cycle, share < 0.5 ? 57U : 58U) << share;
      EXPECT_NEAR(description.changes[0].to / description.changes[0].from, factor, 0.001);
    }
  }
}

TEST(Describe, FindsATrend) {
  const CourseDescription description = Describe(CourseOf(300, 3, [](std::size_t cycle) {
    return kLevel * (1 - 0.2 * static_cast<double>(cycle) / 300);
  }));
  ASSERT_THAT(description.changes, SizeIs(1));
  EXPECT_EQ(description.changes[0].first_cycle, 1U);
  EXPECT_EQ(description.changes[0].last_cycle, 300U);
  EXPECT_NEAR(description.changes[0].to / description.changes[0].from, 0.8, 0.02);
  EXPECT_FALSE(description.settled_at) << "it changes to the end";
}

TEST(Describe, SaysWhereARunInHasSettled) {
  // Within 5 % of its change after three time constants.
  const CourseDescription description = Describe(CourseOf(
      1000, 5,
      [](std::size_t cycle) { return 0.6 - 0.25 * std::exp(-static_cast<double>(cycle) / 100); },
      0.0, 0.002));
  ASSERT_TRUE(description.settled_at);
  EXPECT_NEAR(static_cast<double>(*description.settled_at), 300.0, 60.0);
  EXPECT_FALSE(Describe(CourseOf(1000, 5, Level)).settled_at);
}

// A law of segments misses a curve by more than the scatter, the less of this the more.
TEST(Describe, FindsARunInAndABumpWhateverTheScatter) {
  for (const double noise : {0.0, 0.1, 1.0, 3.0}) {
    for (const std::size_t cycles : {100U, 300U, 3000U}) {
      const double count = static_cast<double>(cycles);
      const CourseDescription run_in = Describe(CourseOf(
          cycles, 3,
          [&](std::size_t cycle) {
            return kLevel * (1.5 - 0.5 * std::exp(-10 * static_cast<double>(cycle) / count));
          },
          0.0, noise));
      ASSERT_THAT(run_in.changes, Not(IsEmpty())) << noise << ' ' << cycles;
      EXPECT_GT(run_in.changes.front().to, 1.3 * kLevel);
      EXPECT_TRUE(run_in.settled_at || noise > 1);
      const CourseDescription bump = Describe(CourseOf(
          cycles, 3,
          [&](std::size_t cycle) {
            return kLevel *
                   (1 + 0.5 * std::sin(std::numbers::pi * static_cast<double>(cycle) / count));
          },
          0.0, noise));
      ASSERT_THAT(bump.changes, SizeIs(2)) << noise << ' ' << cycles;
      EXPECT_NEAR(bump.changes[0].to, 1.5 * kLevel, 0.1 * kLevel);
      EXPECT_NEAR(bump.changes[1].from, 1.5 * kLevel, 0.1 * kLevel);
      EXPECT_FALSE(bump.changes[0].is_step() || bump.changes[1].is_step());
    }
  }
}

// No two lines describe it better than one.
TEST(Describe, FindsStepsUpAndDownAgain) {
  for (const std::size_t pieces : {2U, 3U, 4U, 6U, 8U}) {
    const auto truth = [](std::size_t cycle) {
      return (cycle - 1) / 25 % 2 == 0 ? kLevel : 0.8 * kLevel;
    };
    const CourseDescription description = Describe(CourseOf(25 * pieces, 5, truth, 0.0, 0.1));
    ASSERT_THAT(description.changes, SizeIs(pieces - 1));
    for (std::size_t k = 0; k < description.changes.size(); ++k) {
      EXPECT_TRUE(description.changes[k].is_step());
      EXPECT_EQ(description.changes[k].first_cycle, 25 * k + 26);
    }
  }
}

TEST(Describe, SaysThatAPeriodicCourseVaries) {
  const auto period = [](double cycles, std::size_t count, double phi = 0.0) {
    return Describe(CourseOf(
        count, 3,
        [=](std::size_t cycle) {
          const double phase = 2 * std::numbers::pi * static_cast<double>(cycle) / cycles;
          return kLevel * (1 + 0.1 * std::sin(phase));
        },
        phi));
  };
  for (const double cycles : {12.0, 20.0, 40.0}) {
    const CourseDescription description = period(cycles, 200);
    EXPECT_TRUE(description.varies) << cycles;
    EXPECT_FALSE(description.changed());
    EXPECT_NEAR(description.from, 0.9 * kLevel, 0.02 * kLevel);
    EXPECT_NEAR(description.to, 1.1 * kLevel, 0.02 * kLevel);
  }
  EXPECT_TRUE(period(200.0, 5000).varies);
  EXPECT_FALSE(period(200.0, 200).varies) << "three trends";
  int found = 0;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    found += Describe(CourseOf(200, seed, Level, 0.6)).varies;
  }
  EXPECT_EQ(found, 0) << "correlated scatter";
}

TEST(Describe, HardlyEverFindsAChangeWhereTheScatterChanges) {
  constexpr int kCourses = 100;
  for (const double quiet : {0.2, 0.5, 0.8}) {
    for (const double ratio : {0.1, 6.0}) {
      int found = 0;
      for (std::uint64_t seed = 1; seed <= kCourses; ++seed) {
        Generator generator(seed);
        Course course;
        for (std::size_t cycle = 1; cycle <= 200; ++cycle) {
          const double noise = kNoise * (static_cast<double>(cycle) < 200 * quiet ? 1.0 : ratio);
          course.Add(cycle, kLevel + noise * Normal(generator));
        }
        const CourseDescription description = Describe(course);
        found += description.changed() || description.varies;
      }
      EXPECT_LE(found, kCourses / 20) << quiet << ' ' << ratio;
    }
  }
}

// In a test of growing amplitude the first cycles hardly determine the slip force: their standard
// errors are large.
TEST(Describe, WeighsValuesByTheirStandardErrors) {
  int found = 0;
  constexpr int kCourses = 50;
  const auto course = [](std::uint64_t seed, double step) {
    Generator generator(seed);
    Course values;
    for (std::size_t cycle = 1; cycle <= 38; ++cycle) {
      const double error = 0.01 + 3 * std::exp(-static_cast<double>(cycle) / 3);
      const double truth = cycle <= 25 ? kLevel : kLevel * (1 + step);
      values.Add(cycle, truth + error * Normal(generator), 1, error);
    }
    return values;
  };
  for (std::uint64_t seed = 1; seed <= kCourses; ++seed) {
    found += Describe(course(seed, 0.0)).changed();
    const CourseDescription step = Describe(course(seed, 0.02));
    ASSERT_THAT(step.changes, SizeIs(1)) << seed;
    EXPECT_EQ(step.changes[0].first_cycle, 26U);
  }
  EXPECT_LE(found, kCourses / 20);
}

TEST(Describe, WeighsValuesWithoutAnErrorAsTheUsualOnes) {
  Generator generator(1);
  Course values;  // of an exponent that is at its bound, 0, in some cycles
  for (std::size_t cycle = 1; cycle <= 100; ++cycle) {
    const bool is_at_bound = cycle % 9 == 0;
    values.Add(cycle, is_at_bound ? 0.0 : 0.02 + 0.004 * Normal(generator), 1,
               is_at_bound ? 0.0 : 0.01);
  }
  const CourseDescription description = Describe(values);
  EXPECT_THAT(description.changes, IsEmpty());
  EXPECT_NEAR(description.from, 0.02, 0.004);
}

TEST(Describe, SettlesAtTheCycleAndNotAtTheBinOfAStep) {
  for (const std::size_t place : {3201, 3204, 3334}) {
    const CourseDescription description = Describe(CourseOf(
        5000, 3, [&](std::size_t cycle) { return cycle < place ? kLevel : 0.9 * kLevel; }));
    EXPECT_EQ(description.settled_at, place);
  }
}

TEST(Describe, DoesNotMindOneCycleThatIsOff) {
  for (const std::size_t off : {1U, 2U, 50U, 98U, 100U}) {
    EXPECT_FALSE(Describe(CourseOf(100, 9,
                                   [&](std::size_t cycle) {
                                     return cycle == off ? kLevel + 20 * kNoise : kLevel;
                                   }))
                     .changed())
        << off;
  }
}

TEST(Describe, DoesNotDependOnTheUnit) {
  const auto truth = [](std::size_t cycle) { return cycle <= 70 ? kLevel : 0.8 * kLevel; };
  const CourseDescription one = Describe(CourseOf(150, 11, truth));
  for (const double factor : {1e-12, 1e9}) {
    const CourseDescription other = Describe(CourseOf(
        150, 11, [&](std::size_t cycle) { return factor * truth(cycle); }, 0.0, factor * kNoise));
    ASSERT_EQ(other.changes.size(), one.changes.size());
    EXPECT_EQ(other.changes[0].first_cycle, one.changes[0].first_cycle);
    EXPECT_NEAR(other.changes[0].to / factor, one.changes[0].to, 1e-9 * kLevel);
  }
}

TEST(Describe, FindsNoChangeOfValuesWhoseSquaresAreNoDoubles) {
  for (const double scale : {1e-158, 1e306}) {
    Course course;
    for (std::size_t cycle = 1; cycle <= 100; ++cycle) {
      course.Add(cycle, scale * (cycle <= 60 ? 5.0 : 4.0));
    }
    EXPECT_FALSE(Describe(course).changed()) << scale;
    EXPECT_EQ(Describe(course).to, 4.0 * scale);
  }
}

TEST(Describe, OfValuesWithoutNoiseIsThatOfTheValues) {
  Course course;
  for (std::size_t cycle = 1; cycle <= 100; ++cycle) course.Add(cycle, cycle <= 60 ? 5.0 : 4.0);
  const CourseDescription description = Describe(course);
  ASSERT_THAT(description.changes, SizeIs(1));
  EXPECT_EQ(description.changes[0].first_cycle, 61U);
  EXPECT_NEAR(description.changes[0].from, 5.0, 1e-12);
  EXPECT_NEAR(description.changes[0].to, 4.0, 1e-12);
  for (const double value : {5.0, 0.0}) {  // α of Jenkins' law is 0 in every row
    Course still;
    for (std::size_t cycle = 1; cycle <= 100; ++cycle) still.Add(cycle, value);
    EXPECT_FALSE(Describe(still).changed()) << value;
  }
}

}  // namespace
}  // namespace mindahl::campaign::evolution_test
