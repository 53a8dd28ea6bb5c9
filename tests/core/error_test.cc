

#include "support/prelude.h"

namespace mindahl::error_test {
namespace {

using ::testing::StrEq;

TEST(Error, NamesQuantityValueAndRule) {
  EXPECT_THAT(MessageOf([] { RequirePositive("slip force [N]", -3); }),
              StrEq("slip force [N] = -3 is invalid: must be finite and > 0"));
  EXPECT_THAT(MessageOf([] { RequireNonNegative("amplitude [m]", -1e-9); }),
              StrEq("amplitude [m] = -1e-09 is invalid: must be finite and >= 0"));
  EXPECT_THAT(
      MessageOf([] { RequireFinite("offset [N]", std::numeric_limits<double>::infinity()); }),
      StrEq("offset [N] = inf is invalid: must be finite"));
  EXPECT_THAT(MessageOf([] { RequireSameSize("displacement", 3, "force", 4); }),
              StrEq("displacement has 3 values and force has 4: must be equal"));
}

TEST(Error, RefusesNotANumber) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(RequirePositive("x", nan), InvalidArgument);
  EXPECT_THROW(RequireNonNegative("x", nan), InvalidArgument);
  EXPECT_THROW(RequireFinite("x", nan), InvalidArgument);
}

TEST(Error, LetsValidValuesPass) {
  EXPECT_NO_THROW(RequirePositive("x", std::numeric_limits<double>::denorm_min()));
  EXPECT_NO_THROW(RequireNonNegative("x", 0.0));
  EXPECT_NO_THROW(RequireFinite("x", -1.0));
  EXPECT_NO_THROW(RequireSameSize("a", 2, "b", 2));
}

TEST(Error, ZeroIsNotPositive) { EXPECT_THROW(RequirePositive("x", 0.0), InvalidArgument); }

}  // namespace
}  // namespace mindahl::error_test
