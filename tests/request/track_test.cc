#include "mindahl/request/track.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace mindahl::request::track_test {
namespace {

using ::testing::HasSubstr;

TrackedTest TestOf(std::size_t fits) {
  TrackedTest test;
  for (std::size_t k = 0; k < fits; ++k) test.Add({});
  return test;
}

TEST(SeparateTests, CountTheFitsThatWereThereApart) {
  SeparateTests tests("table.csv", /*has_document=*/false);
  tests.Add("a.csv", "", TestOf(3), /*was_there=*/true);
  tests.Add("b.csv", "", TestOf(4), /*was_there=*/false);
  EXPECT_THAT(tests.ToText(), HasSubstr("2 tests, 7 fits in table.csv\n3 of them existed"));
}

TEST(TrackedTest, CountsACycleOnceThatHasTwoFlags) {
  TrackedTest test;
  campaign::CycleFit open;
  open.flags = {"sigma_open", "alpha_open"};
  test.Add(open);
  test.Add({});
  EXPECT_EQ(test.fits, 2U);
  EXPECT_EQ(test.flagged, 1U);
  EXPECT_EQ(test.flags.at("alpha_open"), 1U);
}

}  // namespace
}  // namespace mindahl::request::track_test
