#include "mindahl/campaign/evolution.h"

#include <fmt/format.h>

#include "support/prelude.h"

namespace mindahl::campaign::evolution_test {
namespace {

/// A quantity by its name, described by hand.
Evolution Of(std::string_view name, std::string unit, CourseDescription description) {
  Evolution evolution{.unit = std::move(unit), .description = std::move(description)};
  evolution.description.from = evolution.description.first;
  evolution.description.to = evolution.description.last;
  evolution.quantity = &*std::ranges::find(TrackedQuantities(), name, &TrackedQuantity::name);
  for (std::size_t cycle = 1; cycle <= 200; ++cycle) {
    evolution.course.Add(cycle, cycle % 2 == 0 ? 5e7 : 4e7);
  }
  return evolution;
}

std::vector<Evolution> RunIn() {
  return {Of("friction_coefficient", "-",
             {.first = 0.352,
              .last = 0.6,
              .settled_at = 480,
              .steps = {},
              .trends = {{1, 480, 0.352, 0.6, 1e-20}}}),
          Of("slip_force", "N",
             {.first = 35.2, .last = 60, .steps = {}, .trends = {{1, 480, 35.2, 60, 1e-20}}}),
          Of("sigma", "N/m", {.first = 5e7, .last = 8e7, .steps = {{61, 61, 5e7, 8e7, 0.003}}}),
          Of("contact_radius", "m",
             {.first = 250e-6, .last = 400e-6, .steps = {{61, 61, 250e-6, 400e-6, 0.003}}}),
          Of("alpha", "-", {.first = 0.33, .last = 0.34})};
}

TEST(Headline, SaysTheTestInOneLine) {
  EXPECT_EQ(Headline(RunIn()), "μ 0.352 → 0.600, settled at cycle 480; σ +60 %; a 250 → 400 µm");
  std::vector<Evolution> still = {Of("slip_force", "N", {.first = 15.0, .last = 15.1}),
                                  Of("half_gap", "N", {.first = 14.0, .last = 14.1}),
                                  Of("sigma", "N/m", {.first = 4.8e7, .last = 4.81e7})};
  EXPECT_EQ(Headline(still),
            "Tc 15 N throughout, but for scatter; σ 48 N/µm throughout, but for scatter");
  still.resize(1);
  still.front().course = {};
  still.front().course.Add(1, 15.0);
  EXPECT_EQ(Headline(still), "Tc 15.0 → 15.1 N, in too few rows to test");
  EXPECT_EQ(Headline({}), "");
}

TEST(Headline, SaysWhatIsFarBeyondFirstAndLast) {
  EXPECT_EQ(Headline(std::vector<Evolution>{
                Of("slip_force", "N",
                   {.first = 60.5,
                    .last = 60.1,
                    .steps = {},
                    .trends = {{1, 150, 60.2, 90.2, 1e-20}, {151, 300, 90.2, 60.3, 1e-20}}})}),
            "Tc 60.5 → 90.2 → 60.1 N");
}

TEST(Headline, SaysInHowManyRowsAQuantityIsKnown) {
  std::vector<Evolution> seized = {Of("slip_force", "N", {.first = 59.9, .last = 60.1})};
  seized.front().fits = 198;
  seized.front().known = 99;
  EXPECT_EQ(Headline(seized), "Tc 59.9 N where it is known, in 99 of 198 rows");
}

TEST(Describe, FindsADropThatMakesTheErrorsAsMuchLess) {
  Course course;
  for (std::size_t cycle = 1; cycle <= 100; ++cycle) {
    const double gain = cycle <= 50 ? 1.0 : 1e-3;
    course.Add(cycle, gain * (cycle % 3 == 0 ? 59.9 : 60.05), 1 / (gain * gain));
  }
  const CourseDescription drop = *Describe(course);
  ASSERT_THAT(drop.steps, SizeIs(1));
  EXPECT_EQ(drop.steps[0].first_cycle, 51U);
}

TEST(Describe, StandsForAnUnchangedQuantityByItsMean) {
  Course course;
  course.Add(1, 0.476, 1e-3);  // hardly determined
  for (std::size_t cycle = 2; cycle <= 60; ++cycle) {
    course.Add(cycle, cycle % 2 == 0 ? 0.599 : 0.601, 1.0);
  }
  const CourseDescription description = *Describe(course);
  EXPECT_FALSE(description.changed());
  EXPECT_NEAR(description.from, 0.6, 1e-3);
  EXPECT_EQ(description.first, 0.476);
}

TEST(Headline, NeverFallsByMoreThanAHundredPercent) {
  const std::vector<Evolution> turned = {
      Of("sigma", "N/m", {.first = 2.0, .last = -3.0, .steps = {{9, 9, 2.0, -3.0, 1e-9}}})};
  EXPECT_EQ(Headline(turned), "σ 2.00 → -3.00 N/m");
  EXPECT_THAT(ChangeStatements(turned),
              ElementsAre("sigma: a step at cycle 9, 2.00 → -3.00 N/m, p = 1e-09"));
}

TEST(ChangeStatements, NameEachStepAndTrend) {
  EXPECT_THAT(ChangeStatements(RunIn()),
              ElementsAre("friction_coefficient: cycles 1 to 480, 0.352 → 0.600 (+70 %), p < 1e-12",
                          "slip_force: cycles 1 to 480, 35.2 → 60.0 N (+70 %), p < 1e-12",
                          "sigma: a step at cycle 61, 50.0 → 80.0 N/µm (+60 %), p = 0.003",
                          "contact_radius: a step at cycle 61, 250 → 400 µm (+60 %), p = 0.003"));
}

TEST(ChangeStatements, OfManyAreTheLargest) {
  CourseDescription course{.first = 1, .last = 2};
  for (std::size_t k = 1; k <= 15; ++k) {
    course.steps.push_back({k, k, 1.0, 1.0 + 0.03 * static_cast<double>(k), 1e-3});
  }
  const std::vector<std::string> lines =
      ChangeStatements(std::vector<Evolution>{Of("energy", "J", course)});
  ASSERT_THAT(lines, SizeIs(10));
  EXPECT_THAT(lines[0], HasSubstr("at cycle 7,"));
  EXPECT_THAT(lines[8], HasSubstr("at cycle 15,"));
  EXPECT_EQ(lines[9], "and 6 smaller ones, which --json lists");
}

TEST(EvolutionPanels, DrawEachQuantityOverALogarithmicAxisOfCycles) {
  const std::vector<io::PlotPanel> panels = EvolutionPanels(RunIn());
  ASSERT_THAT(panels, SizeIs(4));  // slip_force says what friction_coefficient does
  EXPECT_EQ(panels[0].y_label, "friction_coefficient");
  EXPECT_TRUE(panels[0].log_x);
  ASSERT_THAT(panels[0].marks, SizeIs(1));
  EXPECT_EQ(panels[0].marks[0].label, "settled, 480");
  EXPECT_EQ(panels[1].y_label, "sigma [N/µm]");
  EXPECT_EQ(panels[1].marks[0].label, "step, 61");
  const io::PlotSeries& course = panels[1].series[0];
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

CycleFit WithSlipForce(std::size_t number, double value, double error) {
  CycleFit fit;
  fit.number = number;
  fit["slip_force"] = value;
  fit["slip_force_error"] = error;
  return fit;
}

// One over their squares is 0 or infinite.
TEST(Evolutions, AcceptErrorsOfAnySize) {
  std::vector<Evolution> evolutions = BeginEvolutions(false);
  std::size_t number = 0;
  for (const double error : {1e-200, 1e-160, 1.0, 1e160, 1e300}) {
    for (int k = 0; k < 20; ++k) AddTo(evolutions, WithSlipForce(++number, 60.0, error));
  }
  Describe(evolutions);
  ASSERT_THAT(evolutions, SizeIs(1));
  for (const Course::Bin& bin : evolutions[0].course.bins()) {
    EXPECT_TRUE(std::isfinite(bin.weight) && bin.weight > 0);
    EXPECT_NEAR(bin.value, 60.0, 1e-12);
  }
  EXPECT_FALSE(evolutions[0].description.changed());
}

TEST(Evolutions, HoldEachQuantityOfACycleUnlessItIsOpen) {
  CycleFit fit;
  fit.number = 7;
  fit["sigma"] = 1.5;
  fit["sigma_error"] = 0.5;
  fit["alpha"] = 2.5;
  fit["alpha_error"] = 0.25;
  fit["slip_force"] = 3.5;
  fit["slip_force_error"] = 0.125;
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
      all.push_back(fmt::format("{} {} {}", evolution.quantity->name, bin.value, bin.weight));
    }
    return all;
  };
  // Weights are one over the square of an error; of what is measured, of the rms.
  const std::vector<std::string> whole = {"friction_coefficient 4.5 64",
                                          "slip_force 3.5 64",
                                          "half_gap 5.5 0.25",
                                          "sigma 1.5 4",
                                          "contact_radius 8.5 4",
                                          "alpha 2.5 16",
                                          "energy 6.5 0.25",
                                          "energy_ratio 7.5 0.25"};
  EXPECT_EQ(held({"glitches"}), whole);
  EXPECT_THAT(held({"not_converged"}), IsEmpty());
  EXPECT_THAT(held({"sigma_open"}), AllOf(SizeIs(6), Not(Contains(whole[3]))));
  EXPECT_THAT(held({"alpha_open"}), AllOf(SizeIs(7), Not(Contains(whole[5]))));
  EXPECT_THAT(held({"slip_force_open"}), AllOf(SizeIs(7), Not(Contains(whole[1]))));
  fit["alpha_error"].reset();  // held: every cycle has one weight
  EXPECT_THAT(held({}), Contains("alpha 2.5 1"));
}

}  // namespace
}  // namespace mindahl::campaign::evolution_test
