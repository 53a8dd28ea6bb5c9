

#include "reading.h"

namespace mindahl::io::column_table_test {
namespace {

constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();

std::string Said(const std::vector<NamedColumn>& columns) {
  return MessageOf<InputError>([&] { RecordOf(TableOfColumns(columns, "frame")); });
}

TEST(ColumnTable, IsReadByNamesAndUnitsAsAFileIs) {
  const RecordFile file = RecordOf(TableOfColumns(
      {{"F (kN)", {1, 2, 3}}, {"temp", {20, 21, 22}}, {"x [um]", {0, 1, 0}}}, "frame"));
  EXPECT_EQ(file.record.force, (Numbers{1000, 2000, 3000}));
  EXPECT_EQ(file.record.displacement, (Numbers{0, 1e-6, 0}));
  EXPECT_EQ(file.displacement.index, 3U);
  ASSERT_EQ(file.record.covariates.size(), 1U);
  EXPECT_EQ(file.record.covariates.front().name, "temp");
  EXPECT_EQ(file.lines, (std::vector<std::size_t>{1, 2, 3}));
}

TEST(ColumnTable, NamesRowAndColumnOfAMissingNumber) {
  EXPECT_EQ(Said({{"x [m]", {0, 1, 2}}, {"F [N]", {0, kMissing, 2}}}),
            "frame:2:2: holds no number; 1 of 3 rows are so: --broken-rows skip leaves them out");
}

TEST(ColumnTable, RefusesColumnsOfTwoLengthsAndNone) {
  EXPECT_EQ(Said({{"x", {0, 1}}, {"F", {0}}}),
            "frame: 'x' has 2 rows and 'F' 1: give as many of both");
  EXPECT_EQ(Said({{"x", {0, 1}}, {"F", {0, 1, 2}}}),
            "frame: 'x' has 2 rows and 'F' 3: give as many of both");
  EXPECT_EQ(Said({}), "frame: there is no column");
  EXPECT_EQ(Said({{"x", {}}}), "frame: there is no row");
}

}  // namespace
}  // namespace mindahl::io::column_table_test
