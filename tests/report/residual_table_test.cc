

#include "mindahl/report/report.h"
#include "report/made_report.h"
#include "support/prelude.h"

namespace mindahl::report::residual_table_test {
namespace {

using namespace loop;

using report::ResidualsCsv;

std::string Csv(const std::vector<Record>& records) {
  return ResidualsCsv(report::MakeReport(MadeInput(records, 1e-6)));
}

TEST(ResidualTable, HasARowForEverySampleOfEveryFile) {
  const std::string csv = Csv({MadeRecord(1e-6, 5), MadeRecord(1e-6, 7)});
  EXPECT_THAT(csv, StartsWith("file,time [s],displacement [m],force [N],fitted_force [N],residual "
                              "[N]\n1,0,"));
  EXPECT_EQ(std::ranges::count(csv, '\n'), 1 + 5 + 7);
}

TEST(ResidualTable, HasTimeOnlyWhereEveryRecordHasIt) {
  const Record timed = MadeRecord(1e-6);
  Record untimed = timed;
  untimed.time.clear();
  const char* without = "file,displacement [m],force [N],fitted_force [N],residual [N]\n";
  EXPECT_THAT(Csv({timed, untimed}), StartsWith(without));
  EXPECT_THAT(Csv({untimed, timed}), StartsWith(without));
  EXPECT_THAT(Csv({timed, timed}), StartsWith("file,time [s],"));
  EXPECT_THAT(Csv({untimed}), StartsWith("displacement [m],"));
  EXPECT_THAT(Csv({timed}), StartsWith("time [s],displacement [m],"));
}

TEST(ResidualTable, OfAFitThatFailedIsRefused) {
  EXPECT_THROW(ResidualsCsv(report::MakeReport(testing::FailedInput())), InvalidArgument);
}

}  // namespace
}  // namespace mindahl::report::residual_table_test
