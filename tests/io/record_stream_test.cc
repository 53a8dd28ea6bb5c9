#include "mindahl/io/record_stream.h"

#include <fmt/format.h>

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
  for (const char* row : {"1,2x", "1", "1,", "1,2,3", "1,nan", "1,1e999", "1,0x10"}) {
    Refusal(fmt::format("x,F\n0,.5\n1.5,3e-3\n{}\n-2,1E5\n3,4\n", row));
  }
  for (const char* text : {"", "x,F\n", "words alone\n", "x\n1\n2\n", "x;F\n0;0.5\n1;3\n2;1,5\n"}) {
    Refusal(text);
  }
  EXPECT_THAT(Refusal("t [ms],x,F\n0,0,.5\n2,1,1\n\n1,2,2\n2,3,3\n"),
              StartsWith("loop.csv:5:1: time = 1 ms is before the 2 ms"));
  EXPECT_THAT(Refusal(LongText(kManyRows) + "1,2\n"),
              HasSubstr(fmt::format(":{}:3: the row has 2 cells of 3", kManyRows + 2)));
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
  EXPECT_EQ(stream.left_out().count, 4u);
  EXPECT_EQ(stream.left_out().fault,
            fmt::format("{}:3:2: 'oops' is not a number: write it like -1.5e-3, or remove the row",
                        path.string()));
}

TEST(RecordStream, SkipsARowFarBeyondTheFirstPieceThatTheColumnsOfTheFirstDoNotAllow) {
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
    const TemporaryDirectory directory;
    const std::filesystem::path path =
        directory.Write("loop.csv", text + at.broken + '\n' + fmt::format(fmt::runtime(at.row), 3));
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
