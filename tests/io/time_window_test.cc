

#include "mindahl/io/record_reader.h"
#include "support/prelude.h"

namespace mindahl::io::time_window_test {
namespace {

RecordFile TimedFile() {
  RecordFile file;
  file.record.time = {0, 1, 2, 3};
  file.record.displacement = {10, 11, 12, 13};
  file.record.force = {20, 21, 22, 23};
  file.record.normal_load = {30, 31, 32, 33};
  file.record.covariates = {{.name = "p", .unit = "bar", .values = {40, 41, 42, 43}}};
  return file;
}

std::string MessageOf(RecordFile file, double first, double last) {
  try {
    KeepTimeWindow(file, "loop.csv", first, last);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(TimeWindow, KeepsEveryColumnOfTheSamplesInItEndsIncluded) {
  RecordFile file = TimedFile();
  KeepTimeWindow(file, "loop.csv", 1, 2);
  EXPECT_THAT(file.record.time, ElementsAre(1, 2));
  EXPECT_THAT(file.record.displacement, ElementsAre(11, 12));
  EXPECT_THAT(file.record.force, ElementsAre(21, 22));
  EXPECT_THAT(file.record.normal_load, ElementsAre(31, 32));
  EXPECT_EQ(file.record.covariates[0].name, "p");
  EXPECT_EQ(file.record.covariates[0].unit, "bar");
  EXPECT_THAT(file.record.covariates[0].values, ElementsAre(41, 42));
  EXPECT_THAT(file.notes, ElementsAre("loop.csv: 2 of 4 samples lie in the time window 1:2 s"));
}

TEST(TimeWindow, WithoutTimeOrSamplesIsRefused) {
  EXPECT_THAT(MessageOf(TimedFile(), 4, 5),
              HasSubstr("4:5 holds no sample: the record runs from 0 to 3 s"));
  RecordFile untimed = TimedFile();
  untimed.record.time.clear();
  EXPECT_THAT(MessageOf(untimed, 0, 1), HasSubstr("needs a time column"));
}

}  // namespace
}  // namespace mindahl::io::time_window_test
