#include "mindahl/io/csv_table.h"

#include <sys/stat.h>
#include <unistd.h>

#include "reading.h"

namespace mindahl::io::csv_table_test {
namespace {

CsvTable Parse(const std::string& text) {
  const TemporaryDirectory directory;
  return ReadCsvTable(directory.Write("loop.csv", text));
}

/// Returns cells, or none where all are empty.
Strings CellsOf(const CsvTable& table, std::string TableColumn::*member) {
  Strings cells;
  for (const TableColumn& column : table.columns) cells.push_back(column.*member);
  const bool has_any = std::ranges::any_of(cells, [](auto& cell) { return !cell.empty(); });
  return has_any ? cells : Strings{};
}

Numbers Column(const CsvTable& table, std::size_t column) {
  const auto numbers = table.Numbers(column);
  return {numbers.begin(), numbers.end()};
}

struct Format {
  std::string name;
  std::string text;
  Strings names = {"x", "F"};
  Strings units = {};
};

// All hold the same table: x = 0, 1.5, -2; F = 0.5, 3e-3, 1e5.
const std::vector<Format> kFormats = {
    {"Comma", "x,F\n0,.5\n1.5,3e-3\n-2,1E5\n"},
    {"CommaAndBlanks", "x, F\n0, .5\n 1.5 ,\t3e-3 \n-2, 1E5\n"},
    {"CommaBetweenBlanks", "x , F\n0 , .5\n1.5 , 3e-3\n-2 , 1E5\n"},
    {"Semicolon", "x;F\n0;.5\n1.5;3e-3\n-2;1E5\n"},
    {"SemicolonDecimalComma", "x;F\n0;0,5\n1,5;3e-3\n-2;1E5\n"},
    {"Tab", "x\tF\n0\t.5\n1.5\t3e-3\n-2\t1E5\n"},
    {"TabDecimalComma", "x\tF\n0\t0,5\n1,5\t0,003\n-2\t1E5\n"},
    {"Blanks", "x F\n0 .5\n1.5 3e-3\n-2 1E5\n"},
    {"AlignedBlanks", "    x       F\n  0      .5  \n  1.5  3e-3\n -2     1E5\n"},
    {"BlanksDecimalComma", "x F\n0 0,5\n1,5 0,003\n-2 1E5\n"},
    {"BlanksAndTabs", "x F\n0 \t.5\n1.5\t 3e-3\n-2 1E5\n"},
    {"BlanksOrTabs", "x F\n0 .5\n1.5\t3e-3\n-2 1E5\n"},
    {"CrLf", "x,F\r\n0,.5\r\n1.5,3e-3\r\n-2,1E5\r\n"},
    {"Cr", "x,F\r0,.5\r1.5,3e-3\r-2,1E5\r"},
    {"NoNewlineAtTheEnd", "x,F\n0,.5\n1.5,3e-3\n-2,1E5"},
    {"ByteOrderMark", "\xEF\xBB\xBFx,F\n0,.5\n1.5,3e-3\n-2,1E5\n"},
    {"QuotedCells", "\"x\",\"F\"\n\"0\",\".5\"\n1.5,\"3e-3\"\n-2,\" 1E5 \"\n"},
    {"QuotedCommaInName", "\"x, mm\",F\n0,.5\n1.5,3e-3\n-2,1E5\n", {"x, mm", "F"}},
    {"QuotedLineBreakInName", "\"x\ny\",F\n0,.5\n1.5,3e-3\n-2,1E5\n", {"x y", "F"}},
    {"QuotedQuoteInName", "\"x \"\"in\"\"\",F\n0,.5\n1.5,3e-3\n-2,1E5\n", {"x \"in\"", "F"}},
    {"Comments", "# rig, 3\nx,F\n#1,2\n0,.5\n  # note\n1.5,3e-3\n-2,1E5\n#end\n"},
    {"BlankLines", "\n\nx,F\n\n0,.5\n  \t\n1.5,3e-3\n-2,1E5\n\n\n"},
    {"RowsOfDelimiters", "x,F\n,\n0,.5\n1.5,3e-3\n,\n-2,1E5\n,\n"},
    {"PreambleKeysAndValues", "sample_rate,200\nrig,A\nx,F\n0,.5\n1.5,3e-3\n-2,1E5\n"},
    {"PreambleWithTwoNumbers",
     "range,0,10\nx,F,c\n0,.5,1\n1.5,3e-3,1\n-2,1E5,1\n",
     {"x", "F", "c"}},
    {"PreambleOfText", "Run 7, with oil, at night\nx,F\n0,.5\n1.5,3e-3\n-2,1E5\n"},
    {"PreambleLongerThanData",
     "a,1\nb,2\nc,3\nd,4\ne,5\nf,6\ng,7\nh,8\nx,F\n0,.5\n1.5,3e-3\n-2,1E5\n"},
    {"UnitsRow", "x,F\nmm,N\n0,.5\n1.5,3e-3\n-2,1E5\n", {"x", "F"}, {"mm", "N"}},
    {"UnitsRowInBracketsThenBlankLine",
     "x\tF\n[mm]\t[N]\n\n0\t.5\n1.5\t3e-3\n-2\t1E5\n",
     {"x", "F"},
     {"[mm]", "[N]"}},
    {"UnknownUnitInUnitsRow",
     "x,F\nfurlong,N\n0,.5\n1.5,3e-3\n-2,1E5\n",
     {"x", "F"},
     {"furlong", "N"}},
    {"UnitsRowAlone", "mm,N\n0,.5\n1.5,3e-3\n-2,1E5\n", {}, {"mm", "N"}},
    {"UnitSymbolAsName", "x,N\n0,.5\n1.5,3e-3\n-2,1E5\n", {"x", "N"}},
    {"TrailingDelimiterOnData", "x,F\n0,.5,\n1.5,3e-3,\n-2,1E5,\n"},
    {"TrailingDelimiterOnHeader", "x,F,\n0,.5\n1.5,3e-3\n-2,1E5\n"},
    {"TrailingDelimiterOnAll", "x;F;\n0;.5;\n1.5;3e-3;\n-2;1E5;\n"},
    {"TrailingTab", "x\tF\t\n0\t.5\t\n1.5\t3e-3\t\n-2\t1E5\t\n"},
    {"NoHeader", "0,.5\n1.5,3e-3\n-2,1E5\n", {}},
    {"BracketsInBlankSeparatedHeader",
     "x [mm] F (N)\n0 .5\n1.5 3e-3\n-2 1E5\n",
     {"x [mm]", "F (N)"}},
    {"BlanksInNamesTwoBlanksApart",
     "pad position  normal load\n0 .5\n1.5 3e-3\n-2 1E5\n",
     {"pad position", "normal load"}},
    {"BracketsInTabSeparatedHeader",
     "Pad x [mm]\tF (N)\n0\t.5\n1.5\t3e-3\n-2\t1E5\n",
     {"Pad x [mm]", "F (N)"}},
    {"ColumnOfText", "x,F,state\n0,.5,ok\n1.5,3e-3,a;b\n-2,1E5,7\n", {"x", "F", "state"}},
    {"ColumnOfTextMostlyEmpty",
     "x,F,remark\n0,.5,\n1.5,3e-3,\n-2,1E5,slip\n",
     {"x", "F", "remark"}},
    {"ColumnOfDates",
     "x;F;date\n0;0,5;2024-07-12 16:46:43\n1,5;0,003;2024-07-12 16:46:44\n"
     "-2;1E5;2024-07-12 16:46:45\n",
     {"x", "F", "date"}},
    {"PlusSigns", "x,F\n+0,+.5\n+1.5,+3e-3\n-2,+1E+5\n"}};

TEST(CsvTable, IsTheSameInEveryFormat) {
  for (const Format& format : kFormats) {
    SCOPED_TRACE(format.name);
    const CsvTable table = Parse(format.text);
    EXPECT_EQ(CellsOf(table, &TableColumn::name), format.names);
    EXPECT_EQ(CellsOf(table, &TableColumn::unit), format.units);
    ASSERT_GE(table.columns.size(), 2u);
    EXPECT_EQ(Column(table, 0), (Numbers{0, 1.5, -2}));
    EXPECT_EQ(Column(table, 1), (Numbers{0.5, 3e-3, 1e5}));
  }
}

const std::string kWrite = " is not a number: write it like -1.5e-3, or remove the row";
const std::string kGroups =
    " is not a number: write it like -1.5e-3, without marks that separate thousands; where commas "
    "are decimal marks, separate the columns by ';' or tabs, or remove the row";
const std::string kFill = " is not a number: fill in the cell or remove the row";
const std::string kExpected = " has numbers: expected columns of numbers under an optional header";
const std::string kName = ": name every column, or begin the line with '#' if it is a comment";
const std::string kTooMany =
    " is one cell too many: the table has 2 columns; leave out commas that separate thousands, and "
    "separate the columns by ';' or tabs where commas are decimal marks";

// Broken files, and what is said of each.
const std::vector<std::pair<std::string, std::string>> kFaults = {
    {"", "loop.csv: the file is empty"},
    {"\xEF\xBB\xBF", "loop.csv: holds no data, only blank or '#' lines"},
    {"\n  \n# x\n\t\n", "loop.csv: holds no data, only blank or '#' lines"},
    {"Dear Sir,\nyours, truly\n",
     "loop.csv:2:1: 'yours' is not a number, and none of the first 2 rows" + kExpected},
    {std::string("x,F\n1,2\n\0\1", 10),
     "loop.csv:3: is not text, it holds a zero byte: export it as CSV"},
    {"x,F\n1,2\n3,abc\n", "loop.csv:3:2: 'abc'" + kWrite},
    {"x,F\n1,2\n3 mm,4\n", "loop.csv:3:1: '3 mm'" + kWrite},
    {"x,F\n1,2\nnan,4\n", "loop.csv:3:1: 'nan'" + kFill},
    {"NaN,2\n1,2\n", "loop.csv:1:1: 'NaN'" + kFill},
    {"x,F\n1,2\n3,-inf\n", "loop.csv:3:2: '-inf'" + kWrite},
    {"x,F\n1,2\n3,0x1F\n", "loop.csv:3:2: '0x1F'" + kWrite},
    {"x,F\n1,2\n3,\"1,234.5\"\n", "loop.csv:3:2: '1,234.5'" + kGroups},
    {"x;F\n1;2\n3;1.234,5\n", "loop.csv:3:2: '1.234,5'" + kGroups},
    {"x,F\n1,2\n3,+-4\n", "loop.csv:3:2: '+-4'" + kWrite},
    {"a,1,2\n1,b,2\n1,2,c\n", "loop.csv:1:1: 'a'" + kWrite},
    {"x,F\n1,2\n3," + std::string(59, 'a') + "\u00b5bc\n",
     "loop.csv:3:2: '" + std::string(59, 'a') + "\u00b5...'" + kWrite},
    {"x,F\n1,2\n3,-1e999\n", "loop.csv:3:2: '-1e999' is too large: must be below 1.8e308"},
    {"x,F,t\n1,2,3\n3,,4\n", "loop.csv:3:2: ''" + kFill},
    {"x;F\n1,5;2\n3;4.5\n",
     "loop.csv:3:2: '4.5' has the decimal mark '.' and line 2 has ',': use one throughout"},
    {"x,F,t\n1,2,3\n4,5\n6,7,8\n",
     "loop.csv:3:3: the row has 2 cells of 3: complete it or remove it"},
    {"#\n\nx,F\r\n#\r\n1,2\r\n\r\n4\r\n6,7\r\n",
     "loop.csv:7:2: the row has 1 cell of 2: complete it or remove it"},
    {"x,F\n1,\"2\n\"\n3,4\n5,z\n", "loop.csv:5:2: 'z'" + kWrite},
    {"x,F\n1,2\n3,4,5\n6,7\n", "loop.csv:3:3: '5'" + kTooMany},
    {"x,F,\n1,2,\n3,4,,5\n6,7,\n", "loop.csv:3:4: '5'" + kTooMany},
    {"x,F\n.1,.2\n.3,\".4\n.5,.6\n", "loop.csv:3: a quotation mark opened here is never closed"},
    {"\n\"x,F\n1,2\n3,4\n", "loop.csv:2: a quotation mark opened here is never closed"},
    {"x,F\n1,2,3\n4,5,6\n",
     "loop.csv:1: 'x,F' is neither a row of data nor a header for the 3 columns of line 2: name "
     "every column, or begin the line with '#' if it is a comment; or leave out commas that "
     "separate thousands or are decimal marks"},
    {"Measured today\n1,2\n4,5\n",
     "loop.csv:1: 'Measured today' is neither a row of data nor a header for the 2 columns of line "
     "2" +
         kName},
    {"x,F\nabc,1\n1,2\n2,3\n",
     "loop.csv:2: 'abc,1' is neither a row of data nor a header for the 2 columns of line 3" +
         kName},
    {"# rig 3\nx [m],F [N]\n",
     "loop.csv:2: the file ends after its header, with no row of numbers below it: export the data "
     "too"},
    {"x,F\nnan,n/a\n#N/A,nan\n",
     "loop.csv:2:1: 'nan' is not a number, and none of the first 3 rows" + kExpected},
    {"#N/A,#DIV/0!\n#VALUE!,#N/A\n",
     "loop.csv:1:1: '#N/A' is not a number, and none of the first 2 rows" + kExpected},
    {"x,F\n1,a\n2,b\n", "loop.csv:2:2: column 2 holds no numbers"},
    {"x,F\n1,2\n #n/a,3\n", "loop.csv:3:1: '#n/a'" + kFill},
};

TEST(CsvTable, IsRefusedInOneLineWhereItIsBroken) {
  for (const auto& [text, said] : kFaults) {
    SCOPED_TRACE(text);
    const std::string message = MessageOf<InputError>([&, of = text] {
      const CsvTable table = Parse(of);
      for (std::size_t column = 0; column < table.columns.size(); ++column) {
        static_cast<void>(table.Numbers(column));
      }
    });
    EXPECT_EQ(message.substr(message.find("loop.csv")), said);
  }
}

TEST(CsvTable, ReadsTextThatResemblesAnErrorValueAsComment) {
  EXPECT_EQ(Parse("#N/Available,3\n#NA\n1,2\n# N/A\n3,4\n").rows(), 2u);
}

TEST(CsvTable, TakesCommaBetweenIntegersAsDelimiter) {
  const CsvTable table = Parse("1,5\n2,7\n");
  EXPECT_EQ(Column(table, 0), (Numbers{1, 2}));
  EXPECT_EQ(Column(table, 1), (Numbers{5, 7}));
}

TEST(CsvTable, TakesCommaAsDecimalMarkWhenSemicolonSeparates) {
  const CsvTable table = Parse("1,5;2,5;3,5\n");
  ASSERT_EQ(table.columns.size(), 3u);
  EXPECT_EQ(Column(table, 2), (Numbers{3.5}));
}

TEST(CsvTable, TakesCommaAsDecimalMarkWhenBlanksSeparate) {
  const CsvTable table = Parse("1,5 2,5\n");
  ASSERT_EQ(table.columns.size(), 2u);
  EXPECT_EQ(Column(table, 1), (Numbers{2.5}));
}

TEST(CsvTable, TakesRowWithOneUnitSymbolAmongNamesForNames) {
  const CsvTable table = Parse("rig,with,new,pads\nt,x,F,N\n1,2,3,4\n");
  EXPECT_EQ(CellsOf(table, &TableColumn::name), (Strings{"t", "x", "F", "N"}));
  EXPECT_EQ(CellsOf(table, &TableColumn::unit), Strings{});
}

TEST(CsvTable, ReadsSingleRowOfData) {
  const CsvTable table = Parse("x,F\n1,2\n");
  EXPECT_EQ(CellsOf(table, &TableColumn::name), (Strings{"x", "F"}));
  EXPECT_EQ(table.rows(), 1u);
}

TEST(CsvTable, ReadsSingleColumn) {
  const CsvTable table = Parse("displacement [m]\n0.5\n-1\n");
  EXPECT_EQ(CellsOf(table, &TableColumn::name), (Strings{"displacement [m]"}));
  EXPECT_EQ(Column(table, 0), (Numbers{0.5, -1}));
}

TEST(CsvTable, ReadsSixteenColumns) {
  std::string header = "c1";
  std::string row = "1";
  for (int column = 2; column <= 16; ++column) {
    header += ";c" + std::to_string(column);
    row += ";" + std::to_string(column) + ",5";
  }
  const CsvTable table = Parse(header + "\n" + row + "\n");
  ASSERT_EQ(table.columns.size(), 16u);
  EXPECT_EQ(Column(table, 15), (Numbers{16.5}));
}

TEST(CsvTable, KnowsPhysicalLineOfEachRow) {
  const CsvTable table = Parse("rate,2\r\n\r\nx,\"F\r\n[N]\"\r\n#\r\n1,2\r\n\r\n3,4\r\n");
  EXPECT_EQ(table.header_line, 3u);
  EXPECT_EQ(table.lines, (Lines{6, 8}));
}

TEST(CsvTable, HasNoHeaderLineWithoutHeader) { EXPECT_EQ(Parse("1,2\n").header_line, 0u); }

TEST(CsvTable, AcceptsTextInUnusedColumn) {
  const CsvTable table = Parse("x,state,F\n1,ok,2\n3,,4\n");
  EXPECT_EQ(Column(table, 2), (Numbers{2, 4}));
  EXPECT_TRUE(table.columns[1].values.empty());
}

TEST(CsvTable, AcceptsMissingCellInUnusedColumn) {
  const CsvTable table = Parse("x,F,c\n1,2,3\n3,4\n5,6,7\n");
  EXPECT_EQ(Column(table, 1), (Numbers{2, 4, 6}));
}

TEST(CsvTable, ReadsEveryDoubleBackAsWritten) {
  const CsvTable table =
      Parse("x\n0.1\n1.7976931348623157e308\n4.9406564584124654e-324\n1e-400\n-1E-400\n");
  EXPECT_EQ(Column(table, 0), (Numbers{0.1, 1.7976931348623157e308, 5e-324, 0.0, 0.0}));
}

TEST(CsvTable, ReadsFileOfSeveralBlocks) {
  std::string text = "x,F\n";
  for (int row = 0; row < 20000; ++row) text += std::to_string(row) + ",0.25\n";
  const TemporaryDirectory directory;
  const CsvTable table = ReadCsvTable(directory.Write("long.csv", text));
  ASSERT_EQ(table.rows(), 20000u);
  EXPECT_EQ(table.Numbers(0).back(), 19999.0);
}

// A sparse file of 64 GB: what is not text is seen in its first piece.
TEST(CsvTable, ReadsNoFurtherThanAZeroByte) {
  const TemporaryDirectory directory;
  const std::filesystem::path path = directory.Write("sparse.csv", "x,F\n");
  std::filesystem::resize_file(path, std::uintmax_t{64} << 30U);
  EXPECT_EQ(MessageOf<InputError>([&] { ReadCsvTable(path); }),
            path.string() + ":2: is not text, it holds a zero byte: export it as CSV");
}

TEST(CsvTable, RefusesALineThatDoesNotEnd) {
  const TemporaryDirectory directory;
  const std::filesystem::path path =
      directory.Write("line.csv", "x,F\n1,2\n3,4\n" + std::string(18U << 20U, '7'));
  EXPECT_EQ(
      MessageOf<InputError>([&] { ReadCsvTable(path); }),
      path.string() + ": has a line of more than 16777216 bytes: lines must end in LF or CRLF");
}

TEST(CsvTable, RefusesWhatItsLimitsDoNotHold) {
  const TemporaryDirectory directory;
  std::string text = "x,F\n";
  for (int row = 0; row < 20000; ++row) text += std::to_string(row) + ",0.25\n";
  const std::filesystem::path path = directory.Write("long.csv", text);
  EXPECT_EQ(ReadCsvTable(path, {.rows = 20000}).rows(), 20000U);  // the header is none
  EXPECT_THROW(ReadCsvTable(path, {.rows = 19999}), InputError);
  const std::uintmax_t needed = ReadLimits::MemoryOf(20000, text.size());
  EXPECT_EQ(ReadCsvTable(path, {.memory = needed}).rows(), 20000U);
  EXPECT_THROW(ReadCsvTable(path, {.memory = needed - 1}), InputError);
}

TEST(CsvTable, NamesMissingFileAndReason) {
  EXPECT_EQ(MessageOf<InputError>([] { ReadCsvTable("/no/such.csv"); }),
            "cannot read '/no/such.csv': No such file or directory");
}

TEST(CsvTable, RefusesDirectory) {
  const TemporaryDirectory directory;
  EXPECT_EQ(MessageOf<InputError>([&] { ReadCsvTable(directory.path()); }),
            "cannot read '" + directory.path().string() + "': Is a directory");
}

TEST(CsvTable, NamesUnreadableFileAndReason) {
  if (::geteuid() == 0) GTEST_SKIP() << "root may read every file";
  const TemporaryDirectory directory;
  const std::filesystem::path path = directory.Write("loop.csv", "1,2\n");
  ::chmod(path.c_str(), 0);
  EXPECT_EQ(MessageOf<InputError>([&] { ReadCsvTable(path); }),
            "cannot read '" + path.string() + "': Permission denied");
}

}  // namespace
}  // namespace mindahl::io::csv_table_test
