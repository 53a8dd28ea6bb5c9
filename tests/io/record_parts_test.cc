#include "reading.h"

// Parts of records, and records of parts.
namespace mindahl::io::record_parts_test {
namespace {

/// Four cycles of 40 samples at 20 N, four at 50 N; the lines of the file begin with a header.
RecordFile TwoLoads() {
  RecordFile file;
  file.name = "series.csv";
  file.record.covariates = {{.name = "p", .unit = "bar", .values = {}}};
  for (std::size_t i = 0; i < 320; ++i) {
    file.lines.push_back(i + 2);
    file.record.displacement.push_back(
        std::sin(2 * std::numbers::pi * static_cast<double>(i) / 40));
    file.record.force.push_back(static_cast<double>(i));
    file.record.time.push_back(0.1 * static_cast<double>(i));
    file.record.normal_load.push_back(i < 160 ? 20.0 : 50.0);
    file.record.covariates[0].values.push_back(-static_cast<double>(i));
  }
  return file;
}

TEST(TimeWindow, KeepsEveryColumnOfTheSamplesInItEndsIncluded) {
  RecordFile file = TwoLoads();
  file.record.time.assign(file.lines.begin(), file.lines.end());
  KeepTimeWindow(file, 5, 6);
  EXPECT_THAT(file.record.time, ElementsAre(5, 6));
  EXPECT_THAT(file.record.displacement, SizeIs(2));
  EXPECT_THAT(file.record.force, ElementsAre(3, 4));
  EXPECT_THAT(file.record.normal_load, ElementsAre(20, 20));
  EXPECT_THAT(file.record.covariates[0].values, ElementsAre(-3, -4));
  const auto refusal = [&] { return MessageOf<InputError>([&] { KeepTimeWindow(file, 7, 8); }); };
  EXPECT_THAT(refusal(), HasSubstr("no sample lies in the window of time 7:8"));
  file.record.time.clear();
  EXPECT_THAT(refusal(), HasSubstr("needs a time: name its column with --time"));
}

}  // namespace
}  // namespace mindahl::io::record_parts_test
