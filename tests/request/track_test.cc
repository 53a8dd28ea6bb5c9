#include "mindahl/request/track.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace mindahl::request::track_test {
namespace {

using ::testing::HasSubstr;

TrackedTest TestOf(std::size_t fits) {
  TrackedTest test;
  for (std::size_t k = 0; k < fits; ++k) test.Add({.number = k + 1});
  return test;
}

TEST(SeparateTests, CountTheFitsThatWereThereApart) {
  SeparateTests tests("table.csv", /*has_document=*/false);
  tests.Add("a.csv", "", TestOf(3), /*was_there=*/true);
  tests.Add("b.csv", "", TestOf(4), /*was_there=*/false);
  EXPECT_THAT(tests.ToText(), HasSubstr("2 tests, 7 fits in table.csv\n3 of them were there"));
}

}  // namespace
}  // namespace mindahl::request::track_test
