#include <fmt/format.h>
#include <iconv.h>

#include "io/source.h"
#include "reading.h"

// Files as loggers write them: each is read whole and as a stream, to the same numbers.
namespace mindahl::io::logger_file_test {
namespace {

/// Returns a text in another encoding, by iconv of the system: what the reader must undo.
std::string Encoded(std::string text, const char* encoding) {
  const iconv_t encoder = ::iconv_open(encoding, "UTF-8");
  std::string encoded(4 * text.size() + 4, '\0');
  char* from = text.data();
  char* to = encoded.data();
  std::size_t left = text.size();
  std::size_t room = encoded.size();
  EXPECT_NE(::iconv(encoder, &from, &left, &to, &room), static_cast<std::size_t>(-1)) << encoding;
  ::iconv_close(encoder);
  encoded.resize(encoded.size() - room);
  return encoded;
}

TEST(LoggerFile, IsTheSameRecordInEveryEncoding) {
  const std::string western = "Weg [µm];Kraft [N]\n0;1.5\n12;-2.5\n7;3\n";
  const std::string japanese = "測定条件,摩擦試験\n変位 [um],摩擦力 [N]\n0,1.5\n12,-2.5\n7,3\n";
  const std::string mark = "\xEF\xBB\xBF";
  for (const std::string& text :
       {western, mark + western, Encoded(mark + western, "UTF-16LE"),
        Encoded(mark + western, "UTF-16BE"), Encoded(western, "LATIN1"), japanese,
        Encoded(japanese, "CP932"), Encoded(mark + japanese, "UTF-16LE")}) {
    const RecordFile file = Read(text);
    EXPECT_THAT(file.record.displacement, ElementsAre(0.0, 12 / 1e6, 7 / 1e6));
    EXPECT_THAT(file.record.force, ElementsAre(1.5, -2.5, 3.0));
    EXPECT_EQ(file.displacement.unit, "um");
  }
}

TEST(LoggerFile, SaysWhichEncodingWasGuessed) {
  EXPECT_THAT(Read(Encoded("x [µm],F [N]\n0,1\n1,2\n", "LATIN1")).notes,
              Contains(HasSubstr("was read as Latin-1")));
  EXPECT_THAT(Read(Encoded("摩擦試験,,\nx [um],F [N]\n0,1\n1,2\n", "CP932")).notes,
              Contains(HasSubstr("was read as Shift-JIS")));
  for (const std::string& note : Read("x [µm],F [N]\n0,1\n1,2\n").notes) {
    EXPECT_THAT(note, ::testing::Not(HasSubstr("read as")));
  }
}

// Cut at every byte, a character that is two or four bytes long is whole again.
TEST(LoggerFile, MayHaveCharactersThatGoOnInTheNextBlock) {
  std::string text = "x [m],F [N]\n";
  for (int k = 0; k < 60'000; ++k)
    text += fmt::format("{},{}{}\n", k, k % 7, k % 2 == 0 ? "" : ".5");
  text += "# 𝛿 µ\n1,2\n";
  const RecordFile plain = Read(text);
  const RecordFile wide = Read("\xFF\xFE" + Encoded(text, "UTF-16LE"));
  EXPECT_EQ(wide.record.force, plain.record.force);
  EXPECT_EQ(wide.record.displacement, plain.record.displacement);
  EXPECT_EQ(plain.record.size(), 60'001U);
}

TEST(LoggerFile, IsReadInTheEncodingThatIsGiven) {
  RecordColumns columns;
  columns.encoding = "CP1251";
  const RecordFile file = Read(Encoded("сила [N],x [mm]\n1,2\n3,4\n", "CP1251"), columns);
  EXPECT_THAT(file.record.displacement, ElementsAre(2 / 1e3, 4 / 1e3));
  columns.encoding = "ASCII";
  EXPECT_THAT(Refusal("x [µm],F [N]\n1,2\n", columns),
              HasSubstr("byte 4 is not valid in ASCII: give the encoding of the file"));
  columns.encoding = "no-such";
  EXPECT_THAT(Refusal("x [µm],F [N]\n1,2\n", columns), HasSubstr("--encoding no-such"));
}

std::string Preamble(int lines) {
  std::string text;
  for (int k = 0; k < lines; ++k) {
    text += k % 3 == 0 ? fmt::format("Channel {},{},{}\n", k, k, 2 * k)
                       : fmt::format("Setting {}: value {}\n", k, k);
  }
  return text;
}

TEST(LoggerFile, MayHaveALongPreambleButNoFooter) {
  std::string data = "time [s],x [mm],F [N]\n";
  for (int k = 0; k < 20; ++k) data += fmt::format("{},{},{}\n", k, k % 3, 2 * k);
  const RecordFile file = Read(Preamble(41) + data);
  ASSERT_EQ(file.record.size(), 20U);
  EXPECT_EQ(file.record.force.back(), 38.0);
  EXPECT_THAT(Refusal(data + "End of test\n"), StartsWith("loop.csv:22:1: 'End of test'"));
}

TEST(LoggerFile, MayHaveAColumnThatOnlySomeRowsHave) {
  const std::string header = "x [mm],F [N],Events\n";
  for (const std::string rows : {"0,1,Start\n1,2\n2,3\n3,4,Stop\n", "0,1\n1,2\n2,3,Pause\n3,4\n",
                                 "0,1\n1,2\n2,3,Pause\n3,4"}) {
    const RecordFile file = Read(header + rows);
    EXPECT_THAT(file.record.force, ElementsAre(1.0, 2.0, 3.0, 4.0));
  }
}

TEST(LoggerFile, MayHaveTimesOfDay) {
  EXPECT_THAT(Read("Date/Time,x [mm],F [N]\n2021-12-31 23:59:59.500,0,1\n2022-01-01 00:00:00.250,1,"
                   "2\n2022-01-03 12:30:00,2,3\n")
                  .record.time,
              ElementsAre(0, 0.75, 217'800.5));
  for (const char* time :
       {"-1:00:00", "1:-2:00", "1:00", "1:00:-1", "1:00:99", "2024-13-01 1:00:00"}) {
    EXPECT_THAT(Refusal(fmt::format("Time,x [mm],F [N]\n0:00:00,0,1\n{},0,1\n0:00:09,1,2\n", time)),
                StartsWith("loop.csv:3:1: '" + std::string(time)));
  }
  EXPECT_THAT(Refusal("Time,x [mm],F [N]\n11:00:02,0,1\n11:00:01,1,2\n"),
              StartsWith("loop.csv:3: has a time"));
}

}  // namespace
}  // namespace mindahl::io::logger_file_test
