

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

}  // namespace
}  // namespace mindahl::campaign::tracked_quantities_test
