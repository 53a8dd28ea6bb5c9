#include "mindahl/loop/record.h"

#include "support/prelude.h"

namespace mindahl::loop::record_test {
namespace {

std::string MessageOf(const Record& record) {
  try {
    Validate(record);
  } catch (const InvalidArgument& error) {
    return error.what();
  }
  return "";
}

TEST(Record, IsValidWithOrWithoutTheOptionalColumns) {
  EXPECT_EQ(MessageOf({{1, 2}, {3, 4}, {}, {}}), "");
  EXPECT_EQ(MessageOf({{1, 2}, {3, 4}, {0, 1}, {5, 5}}), "");
}

TEST(Record, NamesColumnsOfDifferentLengths) {
  EXPECT_EQ(MessageOf({{1, 2}, {3}, {}, {}}),
            "displacement has 2 values and force has 1: must be equal");
  EXPECT_EQ(MessageOf({{1, 2}, {3, 4}, {0}, {}}),
            "displacement has 2 values and time has 1: must be equal");
  EXPECT_EQ(MessageOf({{1, 2}, {3, 4}, {}, {5, 5, 5}}),
            "displacement has 2 values and normal load has 3: must be equal");
}

TEST(Record, NamesACovariateOfAnotherLengthOrThatIsNotFinite) {
  Record record{{1, 2}, {3, 4}, {}, {}};
  record.covariates = {{"pressure", "bar", {1}}};
  EXPECT_EQ(MessageOf(record), "displacement has 2 values and pressure has 1: must be equal");
  record.covariates = {{"pressure", "bar", {1, std::nan("")}}};
  EXPECT_EQ(MessageOf(record), "pressure of sample 1 = nan is invalid: must be finite");
}

TEST(Record, NamesTheSampleThatIsNotFinite) {
  EXPECT_EQ(MessageOf({{1, 2}, {3, std::numeric_limits<double>::infinity()}, {}, {}}),
            "force [N] of sample 1 = inf is invalid: must be finite");
}

}  // namespace
}  // namespace mindahl::loop::record_test
