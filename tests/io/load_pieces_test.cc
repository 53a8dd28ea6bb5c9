

#include "mindahl/io/record_reader.h"
#include "support/prelude.h"

namespace mindahl::io::load_pieces_test {
namespace {

/// Four cycles of 40 samples at 20 N, four at 50 N; the lines of the file begin with a header.
RecordFile TwoLoads() {
  RecordFile file;
  file.notes = {"a note"};
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

TEST(LoadPieces, HaveEveryColumnTheirLinesAndANameOfTheirOwn) {
  const std::vector<NamedRecord> pieces = SplitAtLoadSteps(TwoLoads(), "series.csv");
  ASSERT_EQ(pieces.size(), 2U);
  EXPECT_EQ(pieces[0].name, "series.csv:2-161");
  EXPECT_EQ(pieces[1].name, "series.csv:192-321");  // the sine turns at samples 170 and 190
  const RecordFile& second = pieces[1].file;
  EXPECT_THAT(second.notes, IsEmpty());
  ASSERT_EQ(second.record.size(), 130U);
  EXPECT_EQ(second.lines.front(), 192U);
  EXPECT_EQ(second.lines.back(), 321U);
  EXPECT_EQ(second.record.force.front(), 190.0);
  EXPECT_EQ(second.record.time.front(), 19.0);
  EXPECT_EQ(second.record.normal_load.back(), 50.0);
  EXPECT_EQ(second.record.covariates[0].values.front(), -190.0);
  EXPECT_EQ(second.record.covariates[0].unit, "bar");
  EXPECT_EQ(second.piece->normal_load, 50.0);
  EXPECT_EQ(pieces[0].file.piece->left_out + second.piece->left_out, 30U);
}

TEST(LoadPieces, OfOneLoadAreTheRecordItself) {
  RecordFile file = TwoLoads();
  std::ranges::fill(file.record.normal_load, 20.0);
  const std::vector<NamedRecord> pieces = SplitAtLoadSteps(file, "loop.csv");
  ASSERT_EQ(pieces.size(), 1U);
  EXPECT_EQ(pieces[0].name, "loop.csv");
  EXPECT_FALSE(pieces[0].file.piece);
  EXPECT_EQ(pieces[0].file.notes.size(), 1U);
  EXPECT_EQ(pieces[0].file.record.size(), 320U);
}

}  // namespace
}  // namespace mindahl::io::load_pieces_test
