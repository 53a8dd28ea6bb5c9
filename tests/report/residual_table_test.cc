

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

TEST(ResidualTable, HasEachSampleInItsRow) {
  report::ReportInput input = MadeInput({MadeRecord(1e-6, 3), MadeRecord(1e-6, 3)}, 1e-6);
  double next = 1.5;
  for (std::size_t r = 0; r < 2; ++r) {
    loop::Record& record = input.records[r].record;
    identification::RecordFit& fit = input.fit.records[r];
    fit.fitted_displacement.resize(3);
    for (auto* column : {&record.time, &record.displacement, &record.force, &fit.fitted_force,
                         &fit.fitted_displacement, &fit.residual}) {
      for (double& value : *column) value = next++;
    }
  }
  const std::string head = "file,time [s],displacement [m],force [N],";
  EXPECT_EQ(ResidualsCsv(report::MakeReport(input)),
            head +
                "fitted_force [N],residual [N]\n"
                "1,1.5,4.5,7.5,10.5,16.5\n1,2.5,5.5,8.5,11.5,17.5\n"
                "1,3.5,6.5,9.5,12.5,18.5\n2,19.5,22.5,25.5,28.5,34.5\n"
                "2,20.5,23.5,26.5,29.5,35.5\n2,21.5,24.5,27.5,30.5,36.5\n");
  input.fit.response = loop::Channel::kDisplacement;
  EXPECT_THAT(ResidualsCsv(report::MakeReport(input)),
              AllOf(StartsWith(head + "fitted_displacement [m]"),
                    HasSubstr("\n1,1.5,4.5,7.5,13.5,"), HasSubstr("\n2,21.5,24.5,27.5,33.5,")));
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
