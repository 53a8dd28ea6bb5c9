#include "mindahl/loop/record.h"

#include "support/prelude.h"

namespace mindahl::loop::record_test {
namespace {

std::string RefusalOf(const Record& record) {
  return MessageOf([&] { Validate(record); });
}

TEST(Record, NamesColumnsOfDifferentLengthsButNeedsNotAll) {
  EXPECT_EQ(RefusalOf({{1, 2}, {3, 4}, {}, {}}), "");
  EXPECT_EQ(RefusalOf({{1, 2}, {3, 4}, {0, 1}, {5, 5}}), "");
  EXPECT_EQ(RefusalOf({{1, 2}, {3}, {}, {}}),
            "displacement has 2 values and force has 1: must be equal");
  EXPECT_EQ(RefusalOf({{1, 2}, {3, 4}, {0}, {}}),
            "displacement has 2 values and time has 1: must be equal");
  EXPECT_EQ(RefusalOf({{1, 2}, {3, 4}, {}, {5, 5, 5}}),
            "displacement has 2 values and normal load has 3: must be equal");
}

TEST(Record, NamesTheColumnAndTheSampleThatIsNotFinite) {
  const double none = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(RefusalOf({{1, none}, {3, 4}, {}, {}}),
            "displacement [m] of sample 1 = nan is invalid: must be finite");
  EXPECT_EQ(RefusalOf({{1, 2}, {3, std::numeric_limits<double>::infinity()}, {}, {}}),
            "force [N] of sample 1 = inf is invalid: must be finite");
  EXPECT_EQ(RefusalOf({{1, 2}, {3, 4}, {none, 1}, {5, 5}}),
            "time [s] of sample 0 = nan is invalid: must be finite");
  EXPECT_EQ(RefusalOf({{1, 2}, {3, 4}, {0, 1}, {5, none}}),
            "normal load [N] of sample 1 = nan is invalid: must be finite");
  Record record{{1, 2}, {3, 4}, {0, 1}, {5, 5}};
  record.covariates = {{.name = "heat", .unit = "K", .values = {1, 2}},
                       {.name = "wear", .unit = "m", .values = {none, 2}}};
  EXPECT_EQ(RefusalOf(record), "wear of sample 0 = nan is invalid: must be finite");
  record.covariates[0].values = {1};
  EXPECT_EQ(RefusalOf(record), "displacement has 2 values and heat has 1: must be equal");
}

}  // namespace
}  // namespace mindahl::loop::record_test
