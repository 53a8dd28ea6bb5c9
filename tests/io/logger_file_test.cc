#include <fmt/format.h>
#include <iconv.h>

#include <cstdlib>
#include <filesystem>

#include "io/temporary_directory.h"
#include "mindahl/core/units.h"
#include "mindahl/io/record_reader.h"
#include "mindahl/io/record_stream.h"
#include "support/measured.h"
#include "support/prelude.h"

// Files as loggers write them: each is read whole and as a stream, to the same numbers.
namespace mindahl::io::logger_file_test {
namespace {

using ::testing::DoubleEq;

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

template <typename Call>
std::string MessageOf(Call call) {
  try {
    call();
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

struct Streamed {
  RecordFile layout;
  Samples samples;
};

Streamed Stream(const std::filesystem::path& path, const RecordColumns& columns) {
  RecordStream stream(path, columns);
  Streamed all{.layout = stream.layout(), .samples = {}};
  for (Samples piece; stream.Next(piece);) {
    const auto append = [](const auto& from, auto& to) {
      to.insert(to.end(), from.begin(), from.end());
    };
    append(piece.displacement, all.samples.displacement);
    append(piece.force, all.samples.force);
    append(piece.time, all.samples.time);
    append(piece.lines, all.samples.lines);
  }
  return all;
}

class LoggerFile : public ::testing::Test {
 protected:
  /// Reads a file in both ways and expects one record and the same assumptions.
  RecordFile Read(const std::string& text, const RecordColumns& columns = {}) {
    const std::filesystem::path path = directory_.Write("log.txt", text);
    RecordFile file = ReadRecord(path, columns);
    const Streamed streamed = Stream(path, columns);
    EXPECT_EQ(streamed.samples.displacement, file.record.displacement);
    EXPECT_EQ(streamed.samples.force, file.record.force);
    EXPECT_EQ(streamed.samples.time, file.record.time);
    EXPECT_EQ(streamed.samples.lines, file.lines);
    EXPECT_EQ(streamed.layout.displacement.unit, file.displacement.unit);
    return file;
  }

  TemporaryDirectory directory_;
};

// --- Encodings ----------------------------------------------------------------------------------

TEST_F(LoggerFile, IsTheSameRecordInEveryEncoding) {
  const std::string western = "Weg [µm];Kraft [N]\n0;1.5\n12;-2.5\n7;3\n";
  const std::string japanese = "測定条件,摩擦試験\n変位 [um],摩擦力 [N]\n0,1.5\n12,-2.5\n7,3\n";
  const std::string mark = "\xEF\xBB\xBF";
  for (const std::string& text :
       {western, mark + western, Encoded(mark + western, "UTF-16LE"),
        Encoded(mark + western, "UTF-16BE"), Encoded(western, "UTF-16LE"),
        Encoded(western, "UTF-16BE"), Encoded(western, "LATIN1"), japanese,
        Encoded(japanese, "CP932"), Encoded(mark + japanese, "UTF-16LE")}) {
    const RecordFile file = Read(text);
    EXPECT_THAT(file.record.displacement, ElementsAre(0.0, 12 / 1e6, 7 / 1e6));
    EXPECT_THAT(file.record.force, ElementsAre(1.5, -2.5, 3.0));
    EXPECT_EQ(file.displacement.unit, "um");
  }
}

TEST_F(LoggerFile, SaysWhichEncodingWasGuessed) {
  EXPECT_THAT(Read(Encoded("x [µm],F [N]\n0,1\n1,2\n", "LATIN1")).notes,
              Contains(HasSubstr("was read as Latin-1")));
  EXPECT_THAT(Read(Encoded("摩擦試験,,\nx [um],F [N]\n0,1\n1,2\n", "CP932")).notes,
              Contains(HasSubstr("was read as Shift-JIS")));
  for (const std::string& note : Read("x [µm],F [N]\n0,1\n1,2\n").notes) {
    EXPECT_THAT(note, ::testing::Not(HasSubstr("read as")));
  }
}

// Cut at every byte, a character that is two or four bytes long is whole again.
TEST_F(LoggerFile, MayHaveCharactersThatGoOnInTheNextBlock) {
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

TEST_F(LoggerFile, IsReadInTheEncodingThatIsGiven) {
  RecordColumns columns;
  columns.encoding = "CP1251";
  const RecordFile file = Read(Encoded("сила [N],x [mm]\n1,2\n3,4\n", "CP1251"), columns);
  EXPECT_THAT(file.record.displacement, ElementsAre(2 / 1e3, 4 / 1e3));
  columns.encoding = "ASCII";
  const std::filesystem::path path = directory_.Write("log.txt", "x [µm],F [N]\n1,2\n");
  EXPECT_THAT(MessageOf([&] { ReadRecord(path, columns); }),
              HasSubstr("byte 4 is not valid in ASCII: give the encoding of the file"));
  columns.encoding = "no-such";
  EXPECT_THAT(MessageOf([&] { ReadRecord(path, columns); }), HasSubstr("--encoding no-such"));
}

// --- Calibration and units ----------------------------------------------------------------------

TEST_F(LoggerFile, IsCalibratedByFactorAndOffset) {
  RecordColumns columns;
  columns.force = "F*98.0665-245.16625";
  columns.displacement = "-2*x";
  const RecordFile file = Read("x [mm],F [V]\n1,2.5\n3,3.5\n", columns);
  EXPECT_THAT(file.record.force, ElementsAre(::testing::DoubleNear(0, 1e-12), DoubleEq(98.0665)));
  EXPECT_THAT(file.record.displacement, ElementsAre(DoubleEq(-2e-3), DoubleEq(-6e-3)))
      << "in the header's unit, which is one of a displacement";
  columns.force += " [kN]";
  EXPECT_THAT(Read("x [mm],F [V]\n1,2.5\n3,3.5\n", columns).record.force,
              ElementsAre(::testing::DoubleNear(0, 1e-9), DoubleEq(98066.5)));
}

TEST_F(LoggerFile, MayBeInGramsAndInches) {
  constexpr double kGravity = 9.80665;  // [m/s²], standard
  const RecordFile file = Read("x [inch],F [g]\n1,1000\n2,0\n");
  EXPECT_THAT(file.record.displacement, ElementsAre(DoubleEq(0.0254), DoubleEq(0.0508)));
  EXPECT_THAT(file.record.force, ElementsAre(DoubleEq(kGravity), 0.0));
  for (const auto& [symbol, metres] : {std::pair{"cm", 0.01},
                                       {"ft", 0.3048},
                                       {"feet", 0.3048},
                                       {"in", 0.0254},
                                       {"inches", 0.0254},
                                       {"mil", 2.54e-5}}) {
    EXPECT_DOUBLE_EQ(LengthUnit(symbol)->ToSi(1.0), metres) << symbol;
  }
  for (const auto& [symbol, newtons] : {std::pair{"gf", 1e-3 * kGravity},
                                        {"kg", kGravity},
                                        {"daN", 10.0},
                                        {"lb", 4.4482216152605}}) {
    EXPECT_DOUBLE_EQ(ForceUnit(symbol)->ToSi(1.0), newtons) << symbol;
  }
}

// --- What stands around the data ----------------------------------------------------------------

std::string Preamble(int lines) {
  std::string text;
  for (int k = 0; k < lines; ++k) {
    text += k % 3 == 0 ? fmt::format("Channel {},{},{}\n", k, k, 2 * k)
                       : fmt::format("Setting {}: value {}\n", k, k);
  }
  return text;
}

TEST_F(LoggerFile, MayHaveALongPreambleButNoFooter) {
  std::string data = "time [s],x [mm],F [N]\n";
  for (int k = 0; k < 20; ++k) data += fmt::format("{},{},{}\n", k, k % 3, 2 * k);
  const RecordFile file = Read(Preamble(41) + data);
  ASSERT_EQ(file.record.size(), 20U);
  EXPECT_EQ(file.record.force.back(), 38.0);
  EXPECT_THAT(file.notes, Contains(HasSubstr("41 rows above the header skipped")));
  const auto path = directory_.Write("log.txt", data + "End of test\n");
  EXPECT_THAT(MessageOf([&] { ReadRecord(path); }), HasSubstr("log.txt:22:1: 'End of test'"));
  EXPECT_THAT(MessageOf([&] { Stream(path, {}); }), HasSubstr("log.txt:22:1: 'End of test'"));
}

TEST_F(LoggerFile, IsRefusedWhereATextStandsAmongItsData) {
  const std::filesystem::path path =
      directory_.Write("log.txt", "x [mm],F [N]\n0,1\n1,2\nstopped,0\n2,3\n");
  EXPECT_THAT(MessageOf([&] { ReadRecord(path); }), HasSubstr("log.txt:4:1: 'stopped'"));
  EXPECT_THAT(MessageOf([&] { Stream(path, {}); }), HasSubstr("log.txt:4:1: 'stopped'"));
  const std::filesystem::path cut = directory_.Write("cut.txt", "x [mm],F [N]\n0,1\n1,n/a\n");
  EXPECT_THAT(MessageOf([&] { ReadRecord(cut); }), HasSubstr("cut.txt:3:2: 'n/a'"));
  EXPECT_THAT(MessageOf([&] { Stream(cut, {}); }), HasSubstr("cut.txt:3:2: 'n/a'"));
}

TEST_F(LoggerFile, MayHaveAColumnThatOnlySomeRowsHave) {
  const std::string header = "x [mm],F [N],Events\n";
  for (const std::string rows : {"0,1,Start\n1,2\n2,3\n3,4,Stop\n", "0,1\n1,2\n2,3,Pause\n3,4\n",
                                 "0,1\n1,2\n2,3,Pause\n3,4"}) {
    const RecordFile file = Read(header + rows);
    EXPECT_THAT(file.record.force, ElementsAre(1.0, 2.0, 3.0, 4.0));
  }
  const std::filesystem::path longer = directory_.Write("log.txt", "x,F\n0,1\n1,2,3\n2,3\n");
  EXPECT_THAT(MessageOf([&] { ReadRecord(longer); }), HasSubstr("one cell too many"));
}

// --- Times of day -------------------------------------------------------------------------------

TEST_F(LoggerFile, MayHaveTimesOfDay) {
  const RecordFile file = Read(
      "Date/Time,x [mm],F [N]\n2021-12-31 23:59:59.500,0,1\n2022-01-01 00:00:00.250,1,2\n"
      "2022-01-03 12:30:00,2,3\n");
  constexpr double kDay = 86'400;
  EXPECT_THAT(file.record.time, ElementsAre(kDay - 0.5, kDay + 0.25, 3 * kDay + 12.5 * 3600));
  EXPECT_THAT(file.notes, Contains(HasSubstr("times of day")));
  EXPECT_THAT(MessageOf([&] { Read("Time,x [mm],F [N]\n11:00:02,0,1\n11:00:01,1,2\n"); }),
              HasSubstr("log.txt:3:1: time"));
}

// --- One file a stroke --------------------------------------------------------------------------

TEST_F(LoggerFile, JoinsPiecesWhoseClockBeginsAnew) {
  const auto piece = [&](const char* name, const std::string& rows) {
    return ReadRecord(directory_.Write(name, "time [s],x [m],F [N],c\n" + rows));
  };
  const RecordFile joined =
      Joined({piece("a", "0,0,1,5\n1,1,2,6\n"), piece("b", "0,2,3,7\n1,3,4,8\n"),
              piece("c", "7,4,5,9\n8,5,6,1\n")},
             {"a", "b", "c"});
  EXPECT_THAT(joined.record.time, ElementsAre(0, 1, 2, 3, 9, 10))
      << "a clock that begins anew goes on by one step, and keeps its zero from there";
  EXPECT_THAT(joined.record.force, ElementsAre(1, 2, 3, 4, 5, 6));
  EXPECT_THAT(joined.record.covariates.front().values, ElementsAre(5, 6, 7, 8, 9, 1));
  const std::filesystem::path other = directory_.Write("d", "x [m],F [N]\n0,1\n1,2\n");
  EXPECT_THAT(MessageOf([&] {
                Joined({piece("a", "0,0,1,5\n1,1,2,6\n"), ReadRecord(other)}, {"a", "d"});
              }),
              HasSubstr("one of a and d has a time"));
}

TEST_F(LoggerFile, JoinedPiecesKeepTheCovariatesThatAllHave) {
  const auto piece = [&](const std::string& text) {
    return ReadRecord(directory_.Write("a", text));
  };
  const RecordFile joined =
      Joined({piece("x [m],F [N],b,c\n0,1,5,7\n1,2,6,8\n"), piece("x [m],F [N],c\n2,3,9\n3,4,0\n")},
             {"a", "b"});
  ASSERT_EQ(joined.record.covariates.size(), 1u);
  EXPECT_EQ(joined.record.covariates.front().name, "c");
  EXPECT_THAT(joined.record.covariates.front().values, ElementsAre(7, 8, 9, 0));
  EXPECT_EQ(joined.covariates.size(), 1u);
}

// --- A logger's own file ------------------------------------------------------------------------

TEST(MeasuredLogger, IsReadAsItIs) {
  const std::filesystem::path path =
      testing::MeasuredPath("mr_damper_utfsm/logger_raw_ME2mm5Hz.txt");
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there";
  RecordColumns columns;
  columns.displacement = "CHANNEL0";
  columns.force = "CHANNEL1";
  const RecordFile file = ReadRecord(path, columns);
  ASSERT_EQ(file.record.size(), 7420U);
  EXPECT_EQ(file.lines.front(), 8U);
  EXPECT_THAT(file.notes, Contains(HasSubstr("6 rows above the header skipped")));
  const Streamed streamed = Stream(path, columns);
  EXPECT_EQ(streamed.samples.time, file.record.time);
  EXPECT_EQ(streamed.samples.force, file.record.force);
}

}  // namespace
}  // namespace mindahl::io::logger_file_test
