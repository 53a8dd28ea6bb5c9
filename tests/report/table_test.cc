#include "report/json.h"
#include "support/prelude.h"

namespace mindahl::report::table_test {
namespace {

const Json kRows = {{"sigma", {{"value", 4.0e7}, {"unit", "N/m"}, {"known", true}}},
                    {"Tc", {{"value", nullptr}, {"unit", "N"}, {"known", false}}}};

TEST(TableText, AlignsNumbersToTheRightBelowTheirNames) {
  EXPECT_EQ(TableText(kRows),
            "         value  unit  known\n"
            "  sigma  4e+07  N/m   yes\n"
            "  Tc         -  N     no\n");
  EXPECT_EQ(TableText(Json::array()), "");
}

TEST(TableText, NamesMembersOfMembers) {
  const Json rows =
      Json::array({{{"largest_error", 1}, {"of", {{"a", 2}, {"b", 3}}}, {"list", {1}}},
                   {{"largest_error", 1}, {"of", {{"a", 2}, {"b", 3}}}, {"c", 4}}});
  EXPECT_EQ(TableText(rows),
            "  largest_error  of a  of b  c\n"
            "              1     2     3\n"
            "              1     2     3  4\n");
}

TEST(TableCsv, HasEveryDigitAndNothingOfNull) {
  const Json rows = Json::array({{{"file", "a,b"}, {"value", 0.1}, {"none", nullptr}},
                                 {{"file", ""}, {"value", 1.0 / 3}, {"none", 2}}});
  EXPECT_EQ(TableCsv(rows), "file,value,none\n\"a,b\",0.1,\n,0.3333333333333333,2\n");
}

}  // namespace
}  // namespace mindahl::report::table_test
