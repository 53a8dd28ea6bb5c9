

#include <fmt/format.h>

#include "mindahl/campaign/evolution.h"
#include "support/prelude.h"

namespace mindahl::campaign::tracked_quantities_test {
namespace {

CycleFit WithSlipForce(std::size_t number, double value, double error) {
  CycleFit fit;
  fit.number = number;
  fit.slip_force = {value, error};
  return fit;
}

// One over their squares is 0 or infinite.
TEST(TrackedCourses, AcceptErrorsOfAnySize) {
  TrackedCourses courses;
  std::size_t number = 0;
  for (const double error : {1e-200, 1e-160, 1.0, 1e160, 1e300}) {
    for (int k = 0; k < 20; ++k) courses.Add(WithSlipForce(++number, 60.0, error));
  }
  for (const Course& course : courses.courses()) {
    for (const Course::Bin& bin : course.bins()) {
      EXPECT_TRUE(std::isfinite(bin.weight) && bin.weight > 0);
      EXPECT_NEAR(bin.value, 60.0, 1e-12);
    }
  }
  for (const CourseDescription& description : courses.Describe()) {
    for (const Stretch& stretch : description.stretches) {
      EXPECT_TRUE(std::isfinite(stretch.at_start) && std::isfinite(stretch.slope_p_value));
    }
  }
}

TEST(SmallTrendStatements, ReportSignificantTrendsBelowOnePercent) {
  CourseDescription course;
  course.stretches = {{.first_cycle = 1,
                       .last_cycle = 100,
                       .at_start = 60.0,
                       .at_end = 59.7,
                       .slope = -0.003,
                       .slope_p_value = 1e-6,
                       .trends = false}};
  EXPECT_THAT(ChangeStatements(course), IsEmpty());
  ASSERT_THAT(SmallTrendStatements(course), SizeIs(1));
  EXPECT_THAT(SmallTrendStatements(course)[0], HasSubstr("60 to 59.7, p 1e-06"));
  course.stretches[0].slope_p_value = 0.02;  // of chance
  EXPECT_THAT(SmallTrendStatements(course), IsEmpty());
  course.stretches[0].slope_p_value = 1e-6;
  course.stretches[0].trends = true;  // among the changes
  EXPECT_THAT(SmallTrendStatements(course), IsEmpty());
  EXPECT_THAT(ChangeStatements(course), SizeIs(1));
}

TEST(TrackedCourses, HoldEachQuantityOfACycleUnlessItIsOpen) {
  CycleFit fit;
  fit.number = 7;
  fit.sigma = {1.5, 0.5};
  fit.alpha = {2.5, 0.25};
  fit.slip_force = {3.5, 0.125};
  fit.friction_coefficient = 4.5;
  fit.half_gap = 5.5;
  fit.energy = 6.5;
  fit.energy_ratio = 7.5;
  fit.rms = 2.0;
  const std::span<const TrackedQuantity> tracked = TrackedQuantities();
  const auto held = [&](const std::vector<std::string>& flags) {
    TrackedCourses courses;
    fit.flags = flags;
    courses.Add(fit);
    std::vector<std::string> all;
    for (std::size_t k = 0; k < tracked.size(); ++k) {
      if (courses.courses()[k].bins().empty()) continue;
      const Course::Bin& bin = courses.courses()[k].bins()[0];
      EXPECT_EQ(bin.first_cycle, 7U);
      all.push_back(fmt::format("{} {} {}", tracked[k].name, bin.value, bin.weight));
    }
    return all;
  };
  // Weights are one over the square of an error; of what is measured, of the rms.
  const std::vector<std::string> whole = {
      "sigma 1.5 4",       "alpha 2.5 16",    "slip_force 3.5 64",    "friction_coefficient 4.5 64",
      "half_gap 5.5 0.25", "energy 6.5 0.25", "energy_ratio 7.5 0.25"};
  EXPECT_EQ(held({}), whole);
  EXPECT_EQ(held({"glitches"}), whole);
  EXPECT_THAT(held({"not_converged"}), IsEmpty());
  EXPECT_THAT(held({"sigma_open"}), AllOf(SizeIs(6), Not(Contains(whole[0]))));
  EXPECT_THAT(held({"alpha_open"}), AllOf(SizeIs(6), Not(Contains(whole[1]))));
  EXPECT_THAT(held({"slip_force_open"}), AllOf(SizeIs(6), Not(Contains(whole[2]))));
  fit.alpha.standard_error.reset();  // held: every cycle has one weight
  EXPECT_THAT(held({}), Contains("alpha 2.5 1"));
  TrackedCourses courses;
  courses.Add(fit);
  for (std::size_t k = 0; k < tracked.size(); ++k) {
    EXPECT_EQ(courses.have_errors()[k], tracked[k].name != "alpha") << tracked[k].name;
  }
}

TEST(ChangeStatements, SayRunningInStepsAndTrendsInTheirOrder) {
  CourseDescription course;
  course.stretches = {{1, 20, 1.5, 2.5, 0.5, 1e-20, true, {}},
                      {21, 40, 3.5, 4.5, 0.5, 0.5, false, {}},
                      {41, 60, 5.5, 6.5, 0.5, 0.004, true, {}}};
  course.changes = {{ChangeKind::kBend, 21, 19, 24, 7.5, 8.5, 0.0625},
                    {ChangeKind::kTransition, 41, 39, 44, 9.5, 10.5, 1e-15}};
  EXPECT_THAT(ChangeStatements(course),
              ElementsAre("from cycle 1 to 20 a trend, 1.5 to 2.5, p < 1e-12",
                          "at cycle 21 (19 to 24) a new rate, 7.5 to 8.5, p 0.06",
                          "at cycle 41 (39 to 44) a step, 9.5 to 10.5, p < 1e-12",
                          "from cycle 41 to 60 a trend, 5.5 to 6.5, p 0.004"));
  course.changes[0].kind = ChangeKind::kEndOfRunningIn;
  EXPECT_THAT(ChangeStatements(course),
              ElementsAre("running-in up to cycle 21 (19 to 24), 1.5 to 7.5, p 0.06",
                          "at cycle 41 (39 to 44) a step, 9.5 to 10.5, p < 1e-12",
                          "from cycle 41 to 60 a trend, 5.5 to 6.5, p 0.004"));
  course.changes[1].kind = ChangeKind::kEndOfRunningIn;
  course.changes[0].kind = ChangeKind::kBend;  // slower twice, and settled only then
  EXPECT_THAT(ChangeStatements(course),
              ElementsAre("running-in up to cycle 41 (39 to 44), 1.5 to 9.5, p < 1e-12",
                          "from cycle 41 to 60 a trend, 5.5 to 6.5, p 0.004"));
}

}  // namespace
}  // namespace mindahl::campaign::tracked_quantities_test
