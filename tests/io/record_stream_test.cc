#include <fmt/format.h>

#include <tuple>

#include "mindahl/io/record_reader.h"
#include "reading.h"

// A stream reads a record in pieces; that it gives what reading whole gives is tested elsewhere.
namespace mindahl::io::record_stream_test {
namespace {

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

TEST(RecordStream, ReadsALongFileInPieces) {
  const TemporaryDirectory directory;
  const std::filesystem::path path = directory.Write("loop.csv", LongText(kManyRows));
  ReadBothWays(path);
  RecordStream stream(path);
  Samples samples;
  ASSERT_TRUE(stream.Next(samples));
  EXPECT_LT(samples.size(), kManyRows / 2);
}

TEST(RecordStream, RefusesAsReadingWholeDoes) {
  const auto refusal_of_row = [](const std::string& row) {
    return Refusal(fmt::format("x,F\n0,.5\n1.5,3e-3\n{}\n-2,1E5\n3,4\n", row));
  };
  for (const char* row : {"1", "1,", "1,2,3"}) EXPECT_THAT(refusal_of_row(row), HasSubstr(":4:"));
  for (const std::string cell :
       {"2x",         "text", "nan",   "inf", "-inf",  "1e999", "0x10", "0x1p3",
        "1e",         "--1",  "1.2.3", "1 2", "#N/A",  "#REF!", "null", "1:30",
        "2024-01-01", "=1+1", "1e5e5", "+-1", "1_000", "\x01"}) {
    EXPECT_THAT(refusal_of_row("1," + cell), StartsWith("loop.csv:4:2: ")) << cell;
    if (cell[0] == '#') continue;  // a comment
    EXPECT_THAT(refusal_of_row(cell + ",1"), StartsWith("loop.csv:4:1: ")) << cell;
  }
  for (const char* text : {"", "x,F\n", "words alone\n", "x\n1\n2\n", "x;F\n0;0.5\n1;3\n2;1,5\n"}) {
    Refusal(text);
  }
  EXPECT_THAT(Refusal("t [ms],x,F\n0,0,.5\n2,1,1\n\n1,2,2\n2,3,3\n"),
              StartsWith("loop.csv:5: has a time before"));
  EXPECT_THAT(Refusal(LongText(kManyRows) + "1,2\n"),
              HasSubstr(fmt::format(":{}:3: the row ends before this column", kManyRows + 2)));
  EXPECT_THROW(RecordStream("/nonexistent/loop.csv"), InputError);
}

TEST(RecordStream, SkipsBrokenRowsAndCountsThem) {
  const TemporaryDirectory directory;
  const std::filesystem::path path =
      directory.Write("loop.csv", "x,F [N]\n0,.5\n1.5,oops\n1,2\n\"3,4\n5,6\n7\n8,9,10\n-2,1E5\n");
  RecordStream stream(path, kSkipping);
  Samples samples;
  ASSERT_TRUE(stream.Next(samples));
  EXPECT_EQ(samples.displacement, (std::vector<double>{0, 1, 5, -2}));
  EXPECT_EQ(samples.lines, (std::vector<std::size_t>{2, 4, 6, 9}));
  EXPECT_FALSE(stream.Next(samples));
  EXPECT_EQ(stream.layout().left_out.count, 4u);
  EXPECT_EQ(stream.layout().left_out.fault,
            fmt::format("{}:3:2: 'oops' is not a number: write one like -1.5e-3, without "
                        "separators of thousands, or remove the row",
                        path.string()));
}

TEST(RecordStream, SkipsARowFarBeyondTheFirstPieceThatTheColumnsOfTheFirstDoNotAllow) {
  constexpr std::size_t kRows = 20'000;  // 300 kB, more than the columns are judged by
  // A header, a row with the displacement in it, a broken one, and what is said of that.
  for (const auto& [header, row, broken, fault] :
       {std::tuple("time,x,F\n", "12:00:00.5,{},1\n", "noon,1,2\n", ":1: 'noon' is not a number"),
        {"x;F\n", "{};0,500000000000\n", "1;1.5\n",
         ":2: '1.5' is not a number: write one like -1,5e-3"},
        {"x [um],F [kN]\n", "{},0.500000000000\n", "1,1e307\n",
         ": has a number that is too large"}}) {
    std::string text = header;
    for (std::size_t i = 0; i < kRows; ++i) text += fmt::format(fmt::runtime(row), i % 7);
    text += broken + fmt::format(fmt::runtime(row), 3);
    const TemporaryDirectory directory;
    RecordStream stream(directory.Write("loop.csv", text), kSkipping);
    Samples samples;
    std::size_t rows = 0;
    while (stream.Next(samples)) rows += samples.size();
    EXPECT_EQ(rows, kRows + 1) << header;
    EXPECT_EQ(stream.layout().left_out.count, 1u);
    EXPECT_THAT(stream.layout().left_out.fault,
                HasSubstr(fmt::format("loop.csv:{}{}", kRows + 2, fault)));
  }
}

TEST(RecordStream, GivesTheSamplesBeforeARowThatItRefuses) {
  const TemporaryDirectory directory;
  const std::filesystem::path path =
      directory.Write("loop.csv", "x,F\n0,.5\n1.5,1\n1,oops\n-2,1E5\n3,4\n");
  RecordStream stream(path);
  Samples samples;
  ASSERT_TRUE(stream.Next(samples));
  EXPECT_EQ(samples.displacement, (std::vector<double>{0, 1.5}));
  EXPECT_THROW(stream.Next(samples), InputError);
  EXPECT_THROW(stream.Next(samples), InputError);
}

}  // namespace
}  // namespace mindahl::io::record_stream_test
