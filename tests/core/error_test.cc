#include "support/prelude.h"

namespace mindahl::error_test {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(Error, NamesQuantityValueAndRule) {
  EXPECT_EQ(MessageOf([] { RequirePositive("slip force [N]", -3); }),
            "slip force [N] = -3 is invalid: must be finite and > 0");
  EXPECT_EQ(MessageOf([] { RequireNonNegative("amplitude [m]", -1e-9); }),
            "amplitude [m] = -1e-09 is invalid: must be finite and >= 0");
  EXPECT_EQ(MessageOf([] { RequireFinite("offset [N]", kInfinity); }),
            "offset [N] = inf is invalid: must be finite");
  EXPECT_EQ(MessageOf([] { RequireSameSize("displacement", 3, "force", 4); }),
            "displacement has 3 values and force has 4: must be equal");
}

TEST(Error, IsThrownOfNoValidValue) {
  EXPECT_THROW(RequirePositive("x", 0.0), InvalidArgument);
  EXPECT_NO_THROW(RequirePositive("x", std::numeric_limits<double>::denorm_min()));
  EXPECT_NO_THROW(RequireNonNegative("x", 0.0));
  EXPECT_NO_THROW(RequireFinite("x", -1.0));
  EXPECT_NO_THROW(RequireSameSize("a", 2, "b", 2));
  for (const auto require : {RequirePositive, RequireNonNegative, RequireFinite}) {
    EXPECT_THROW(require("x", std::nan("")), InvalidArgument);
    EXPECT_THROW(require("x", kInfinity), InvalidArgument);
  }
}

}  // namespace
}  // namespace mindahl::error_test
