#include "mindahl/io/record_stream.h"

#include <fmt/format.h>

#include <filesystem>

#include "mindahl/io/record_reader.h"
#include "support/prelude.h"
#include "temporary_directory.h"

namespace mindahl::io::record_stream_test {
namespace {

template <typename Call>
std::string RefusalOf(Call call) {
  try {
    call();
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

class RecordStreamTest : public ::testing::Test {
 protected:
  std::filesystem::path Write(const std::string& text) {
    return directory_.Write("loop.csv", text);
  }

 private:
  TemporaryDirectory directory_;
};

const RecordColumns kSkipping = [] {
  RecordColumns columns;
  columns.skip_broken_rows = true;
  return columns;
}();

Samples ReadAll(const std::filesystem::path& path, const RecordColumns& columns = {}) {
  RecordStream stream(path, columns);
  Samples all;
  Samples piece;
  const auto append = [](std::vector<double>& to, const std::vector<double>& from) {
    to.insert(to.end(), from.begin(), from.end());
  };
  while (stream.Next(piece)) {
    append(all.displacement, piece.displacement);
    append(all.force, piece.force);
    append(all.time, piece.time);
    append(all.normal_load, piece.normal_load);
    all.lines.insert(all.lines.end(), piece.lines.begin(), piece.lines.end());
  }
  return all;
}

void ExpectSameAsWhole(const std::filesystem::path& path, const RecordColumns& columns = {}) {
  const RecordFile whole = ReadRecord(path, columns);
  const Samples samples = ReadAll(path, columns);
  EXPECT_EQ(samples.displacement, whole.record.displacement);
  EXPECT_EQ(samples.force, whole.record.force);
  EXPECT_EQ(samples.time, whole.record.time);
  EXPECT_EQ(samples.normal_load, whole.record.normal_load);
  EXPECT_EQ(samples.lines, whole.lines);
}

struct Text {
  std::string name;
  std::string text;
};

void PrintTo(const Text& text, std::ostream* out) { *out << text.name; }

class RecordStreamText : public RecordStreamTest, public ::testing::WithParamInterface<Text> {};

TEST_P(RecordStreamText, ReadsWhatAWholeFileHolds) { ExpectSameAsWhole(Write(GetParam().text)); }

INSTANTIATE_TEST_SUITE_P(
    , RecordStreamText,
    ::testing::Values(
        Text{"Comma", "x [um],F [kN]\n0,.5\n1.5,3e-3\n-2,1E5\n"},
        Text{"BlanksAroundCells", "x [um],F [kN]\n 0 ,  .5\t\n1.5 , 3e-3\n+2,-1E5\n"},
        Text{"SemicolonAndDecimalComma", "x;F\n0;0,5\n1,5;3e-3\n-2;1E5\n"},
        Text{"TabAndDecimalComma", "x\tF\n0\t0,5\n1,5\t0,003\n-2\t1E5\n"},
        Text{"Blanks", "    x       F\n  0      .5  \n  1.5  3e-3\n -2  \t   1E5\n"},
        Text{"CarriageReturns", "x,F\r\n0,.5\r\n1.5,3e-3\r\n-2,1E5\r\n"},
        Text{"ByteOrderMark", "\xEF\xBB\xBFx,F\n0,.5\n1.5,3e-3\n-2,1E5\n"},
        Text{"NoHeader", "0,.5\n1.5,3e-3\n-2,1E5\n"},
        Text{"PreambleAndUnitsRow", "rig 7\nTime,x,F\ns,mm,N\n0,0,.5\n1,1.5,3e-3\n2,-2,1E5\n"},
        Text{"LastLineWithoutEnd", "x,F\n0,.5\n1.5,3e-3\n-2,1E5"},
        Text{"RemarksAndBlankLines", "x,F\n0,.5\n# a remark, 3\n\n1.5,3e-3\n,\n-2,1E5\n"},
        Text{"RemarksBeforeAnotherColumn", "note,x,F\n1,0,.5\n#2,1,1\n3,1.5,3e-3\n4,-2,1E5\n"},
        Text{"QuotedCells", "x,F\n\"0\",.5\n1.5,\"3e-3\"\n-2,1E5\n"},
        Text{"TrailingDelimiters", "x,F,\n0,.5,\n1.5,3e-3,\n-2,1E5,\n"},
        Text{"TextInAnotherColumn", "x,note,F\n0,a b,.5\n1.5,\"c,d\",3e-3\n-2,,1E5\n"},
        Text{"TimeAndLoad", "t [ms],F [N],x [nm],Fn [N]\n0,1,2,10\n1,2,3,11\n2,1,2,12\n"},
        Text{"SmallestAndLargest", "x,F\n0,1e-400\n5e-324,-0\n1.7976931348623157e308,1E5\n"},
        Text{"AngleAndTorque", "angle [deg],torque [N mm]\n0,.5\n1.5,3e-3\n-2,1E5\n"}),
    [](const auto& text) { return text.param.name; });

/// As long as several pieces, so that lines are cut by their ends.
std::string LongText(std::size_t rows) {
  std::string text = "time [s],displacement [m],force [N]\n";
  for (std::size_t i = 0; i < rows; ++i) {
    const double phase = 0.01 * static_cast<double>(i);
    text += fmt::format("{},{},{}\n", phase, 1e-6 * std::sin(phase), 20 * std::cos(phase));
  }
  return text;
}

constexpr std::size_t kManyRows = 60'000;  // 3 MB

TEST_F(RecordStreamTest, ReadsALongFileInPieces) {
  const std::filesystem::path path = Write(LongText(kManyRows));
  ExpectSameAsWhole(path);
  RecordStream stream(path);
  Samples samples;
  ASSERT_TRUE(stream.Next(samples));
  EXPECT_LT(samples.size(), kManyRows / 2);
}

TEST_F(RecordStreamTest, ReportsBrokenRowLikeTheWholeReader) {
  for (const char* row : {"1,2x", "1", "1,", "1,2,3", "1,nan", "1,1e999", "1,0x10"}) {
    const std::filesystem::path path =
        Write(fmt::format("x,F\n0,.5\n1.5,3e-3\n{}\n-2,1E5\n3,4\n", row));
    const std::string whole = RefusalOf([&] { ReadRecord(path); });
    EXPECT_EQ(RefusalOf([&] { ReadAll(path); }), whole) << row;
  }
}

TEST_F(RecordStreamTest, RefusesATimeThatRunsBackwardsAsTheWholeReaderDoes) {
  const std::filesystem::path path = Write("t [ms],x,F\n0,0,.5\n2,1,1\n\n1,2,2\n2,3,3\n");
  const std::string whole = RefusalOf([&] { ReadRecord(path); });
  EXPECT_THAT(whole, ::testing::HasSubstr(":5:1: time = 1 ms is before the 2 ms"));
  EXPECT_EQ(RefusalOf([&] { ReadAll(path); }), whole);
}

TEST_F(RecordStreamTest, SkipsOneRowWhereAClockStartsAgain) {
  const std::filesystem::path path = Write("t,x,F\n5,0,.5\n6,1,1\n0,2,2\n1,3,3\n2,4,4\n");
  RecordStream stream(path, kSkipping);
  Samples samples;
  ASSERT_TRUE(stream.Next(samples));
  EXPECT_EQ(samples.lines, (std::vector<std::size_t>{2, 3, 5, 6}));
  EXPECT_EQ(stream.left_out().count, 1u);
}

TEST_F(RecordStreamTest, RefusesASecondDecimalMarkAsTheWholeReaderDoes) {
  const std::filesystem::path path = Write("x;F\n0;0.5\n1;3\n2;1,5\n");
  EXPECT_EQ(RefusalOf([&] { ReadAll(path); }), RefusalOf([&] { ReadRecord(path); }));
}

TEST_F(RecordStreamTest, SkipsBrokenRowsAndCountsThem) {
  const std::filesystem::path path =
      Write("x,F [N]\n0,.5\n1.5,oops\n1,2\n\"3,4\n5,6\n7\n8,9,10\n-2,1E5\n");
  RecordStream stream(path, kSkipping);
  Samples samples;
  ASSERT_TRUE(stream.Next(samples));
  EXPECT_EQ(samples.displacement, (std::vector<double>{0, 1, 5, -2}));
  EXPECT_EQ(samples.lines, (std::vector<std::size_t>{2, 4, 6, 9}));
  EXPECT_FALSE(stream.Next(samples));
  EXPECT_EQ(stream.left_out().count, 4u);
  EXPECT_EQ(stream.left_out().fault,
            fmt::format("{}:3:2: 'oops' is not a number: write it like -1.5e-3, or remove the row",
                        path.string()));
}

TEST_F(RecordStreamTest, FindsABrokenRowFarBeyondTheFirstPiece) {
  std::string text = LongText(kManyRows);
  text += "1,2\n";
  EXPECT_EQ(
      RefusalOf([&] { ReadAll(Write(text)); }).substr(Write(text).string().size()),
      fmt::format(":{}:3: the row has 2 cells of 3: complete it or remove it", kManyRows + 2));
}

TEST_F(RecordStreamTest, SkipsARowFarBeyondTheFirstPieceThatTheColumnsOfTheFirstDoNotAllow) {
  constexpr std::size_t kRows = 20'000;  // 300 kB, more than the columns are judged by
  struct Case {
    const char* header;
    const char* row;  // with the displacement in it
    const char* broken;
    const char* fault;
  };
  for (const Case& at :
       {Case{"time,x,F", "12:00:00.5,{0},1", "noon,1,2", ":1: 'noon' is not a number"},
        Case{"x;F", "{0};0,500000000000", "1;1.5", ":2: '1.5' has the decimal mark '.'"},
        Case{"x [um],F [kN]", "{0},0.500000000000", "1,1e307",
             ":2: force = 1e+307 kN is too large"}}) {
    std::string text = fmt::format("{}\n", at.header);
    for (std::size_t i = 0; i < kRows; ++i) {
      text += fmt::format(fmt::runtime(at.row), i % 7) + '\n';
    }
    const std::filesystem::path path =
        Write(text + at.broken + '\n' + fmt::format(fmt::runtime(at.row), 3));
    RecordStream stream(path, kSkipping);
    Samples samples;
    std::size_t rows = 0;
    while (stream.Next(samples)) rows += samples.size();
    EXPECT_EQ(rows, kRows + 1) << at.header;
    EXPECT_EQ(stream.left_out().count, 1u);
    EXPECT_THAT(stream.left_out().fault,
                ::testing::HasSubstr(fmt::format("{}:{}{}", path.string(), kRows + 2, at.fault)));
  }
}

TEST_F(RecordStreamTest, GivesTheSamplesBeforeARowThatItRefuses) {
  const std::filesystem::path path = Write("x,F\n0,.5\n1.5,1\n1,oops\n-2,1E5\n3,4\n");
  RecordStream stream(path);
  Samples samples;
  ASSERT_TRUE(stream.Next(samples));
  EXPECT_EQ(samples.displacement, (std::vector<double>{0, 1.5}));
  EXPECT_THROW(stream.Next(samples), InputError);
  EXPECT_THROW(stream.Next(samples), InputError);
}

TEST_F(RecordStreamTest, RefusesWhatHoldsNoRecord) {
  for (const char* text : {"", "x,F\n", "words alone\n", "x\n1\n2\n"}) {
    const std::filesystem::path path = Write(text);
    const std::string whole = RefusalOf([&] { ReadRecord(path); });
    EXPECT_EQ(RefusalOf([&] { ReadAll(path); }), whole) << text;
  }
  EXPECT_THROW(RecordStream("/nonexistent/loop.csv", {}), InputError);
}

}  // namespace
}  // namespace mindahl::io::record_stream_test
