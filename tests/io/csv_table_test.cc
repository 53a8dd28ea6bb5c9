#include "mindahl/io/csv_table.h"

#include <sys/stat.h>
#include <unistd.h>

#include <map>

#include "io/table.h"
#include "reading.h"

namespace mindahl::io::csv_table_test {
namespace {

CsvTable Parse(const std::string& text) {
  const TemporaryDirectory directory;
  return ReadCsvTable(directory.Write("loop.csv", text));
}

/// Returns "x;F"; "" where all cells are empty.
std::string CellsOf(const CsvTable& table, std::string mindahl::io::Column::*member) {
  std::string cells;
  bool has_any = false;
  for (const mindahl::io::Column& column : table.columns) {
    cells += (cells.empty() ? "" : ";") + column.*member;
    has_any = has_any || !(column.*member).empty();
  }
  return has_any ? cells : "";
}

Numbers Column(const CsvTable& table, std::size_t column) {
  const auto numbers = table.Numbers(column);
  return {numbers.begin(), numbers.end()};
}

// Texts that hold the same table: x = 0, 1.5, -2; F = 0.5, 3e-3, 1e5; its names and units.
const std::string kFormats = R"formats(
x,F¶0,.5¶1.5,3e-3¶-2,1E5¶ | x;F | -
x, F¶0, .5¶ 1.5 ,→3e-3 ¶-2, 1E5¶ | x;F | -
x;F¶0;.5¶1.5;3e-3¶-2;1E5¶ | x;F | -
x;F¶0;0,5¶1,5;3e-3¶-2;1E5¶ | x;F | -
x→F¶0→.5¶1.5→3e-3¶-2→1E5¶ | x;F | -
x→F¶0→0,5¶1,5→0,003¶-2→1E5¶ | x;F | -
x F¶0 .5¶1.5 3e-3¶-2 1E5¶ | x;F | -
¶    x       F¶  0      .5  ¶  1.5  3e-3¶ -2     1E5¶ | x;F | -
x F¶0 0,5¶1,5 0,003¶-2 1E5¶ | x;F | -
x,F␍¶0,.5␍¶1.5,3e-3␍¶-2,1E5␍¶ | x;F | -
x,F¶0,.5¶1.5,3e-3¶-2,1E5 | x;F | -
"x","F"¶"0",".5"¶1.5,"3e-3"¶-2," 1E5 "¶ | x;F | -
"x, mm",F¶0,.5¶1.5,3e-3¶-2,1E5¶ | x, mm;F | mm;
# rig, 3¶x,F¶#1,2¶0,.5¶  # note¶1.5,3e-3¶-2,1E5¶#end¶ | x;F | -
¶¶x,F¶¶0,.5¶  →¶1.5,3e-3¶-2,1E5¶¶¶ | x;F | -
x,F¶,¶0,.5¶1.5,3e-3¶,¶-2,1E5¶,¶ | x;F | -
sample_rate,200¶rig,A¶x,F¶0,.5¶1.5,3e-3¶-2,1E5¶ | x;F | -
range,0,10¶x,F,c¶0,.5,1¶1.5,3e-3,1¶-2,1E5,1¶ | x;F;c | -
Run 7, with oil, at night¶x,F¶0,.5¶1.5,3e-3¶-2,1E5¶ | x;F | -
x,F¶mm,N¶0,.5¶1.5,3e-3¶-2,1E5¶ | x;F | mm;N
x→F¶[mm]→[N]¶¶0→.5¶1.5→3e-3¶-2→1E5¶ | x;F | mm;N
x,F¶furlong,N¶0,.5¶1.5,3e-3¶-2,1E5¶ | x;F | furlong;N
mm,N¶0,.5¶1.5,3e-3¶-2,1E5¶ | - | mm;N
x,N¶0,.5¶1.5,3e-3¶-2,1E5¶ | x;N | -
x,F¶0,.5,¶1.5,3e-3,¶-2,1E5,¶ | x;F | -
x,F,¶0,.5¶1.5,3e-3¶-2,1E5¶ | x;F | -
x;F;¶0;.5;¶1.5;3e-3;¶-2;1E5;¶ | x;F | -
0,.5¶1.5,3e-3¶-2,1E5¶ | - | -
x [mm] F (N)¶0 .5¶1.5 3e-3¶-2 1E5¶ | x [mm];F (N) | mm;N
pad position  normal load¶0 .5¶1.5 3e-3¶-2 1E5¶ | pad position;normal load | -
x,F,state¶0,.5,ok¶1.5,3e-3,a;b¶-2,1E5,7¶ | x;F;state | -
x;F;date¶0;0,5;2024-07-12 16:46:43¶1,5;0,003;2024-07-12 16:46:44¶-2;1E5;2024-07-12 16:46:45¶ |
   x;F;date | -
x,F¶+0,+.5¶+1.5,+3e-3¶-2,+1E+5¶ | x;F | -
)formats";

TEST(CsvTable, IsTheSameInEveryFormat) {
  for (const Strings& format : RowsOf(kFormats)) {
    SCOPED_TRACE(format[0]);
    const CsvTable table = Parse(format[0]);
    EXPECT_EQ(CellsOf(table, &mindahl::io::Column::header), format[1]);
    EXPECT_EQ(CellsOf(table, &mindahl::io::Column::unit), format[2]);
    ASSERT_GE(table.columns.size(), 2u);
    EXPECT_EQ(Column(table, 0), (Numbers{0, 1.5, -2}));
    EXPECT_EQ(Column(table, 1), (Numbers{0.5, 3e-3, 1e5}));
  }
}

// Ends of what is said of broken files.
const std::map<std::string, std::string> kEnds = {
    {"kWrite",
     " is not a number: write one like -1.5e-3, without separators of thousands, or remove the "
     "row"},
    {"kExpected",
     ": expected columns of them, under an optional header, between tabs, ';', blanks, or commas "
     "where these are no decimal marks"},
    {"kName",
     ": name every column, begin the line with '#' if it is a comment, or remove commas within "
     "numbers"},
    {"kTooMany", ": one cell too many: remove it, or commas within numbers"},
};
// Broken files, and what is said of each of them as loop.csv.
const std::string kFaults = R"faults(
¶  ¶# x¶→¶ | : holds no data, only blank or '#' lines
Dear Sir,¶yours, truly¶ | :2: no row down to 'yours, truly' has numbers +kExpected
x,F¶1,2¶3,abc¶ | :3:2: 'abc' +kWrite
x,F¶1,2¶3 mm,4¶ | :3:1: '3 mm' +kWrite
x,F¶1,2¶nan,4¶ | :3:1: 'nan' +kWrite
NaN,2¶1,2¶ | :1:1: 'NaN' +kWrite
x,F¶1,2¶3,-inf¶ | :3:2: '-inf' +kWrite
x,F¶1,2¶3,0x1F¶ | :3:2: '0x1F' +kWrite
x,F¶1,2¶3,"1,234.5"¶ | :3:2: '1,234.5' +kWrite
x;F¶1;2¶3;1.234,5¶ | :3:2: '1.234,5' +kWrite
x,F¶1,2¶3,+-4¶ | :3:2: '+-4' +kWrite
a,1,2¶1,b,2¶1,2,c¶ | :1:1: 'a' +kWrite
x,F¶1,2¶3,-1e999¶ | :3:2: '-1e999' +kWrite
x,F,t¶1,2,3¶3,,4¶ | :3:2: '' +kWrite
x;F¶1,5;2¶3;4.5¶ | :2:1: '1,5' +kWrite
x;F¶1,5;2¶2,5;3¶3;4.5¶ | :4:2: '4.5' is not a number: write one like -1,5e-3, without separators of thousands, or
   remove the row
x,F,t¶1,2,3¶4,5¶6,7,8¶ | :3:3: the row ends before this column: complete it or remove it
#¶¶x,F␍¶#␍¶1,2␍¶␍¶4␍¶6,7␍¶ | :7:2: the row ends before this column: complete it or remove it
x,F¶1,"2¶"¶3,4¶5,z¶ | :2: a quotation mark opened here is never closed in its line
"x¶[mm]",F¶1,2¶3,4¶ | :1: a quotation mark opened here is never closed in its line
x,F¶1,2¶3,4,5¶6,7¶ | :3:3 +kTooMany
x,F,¶1,2,¶3,4,,5¶6,7,¶ | :3:4 +kTooMany
x,F¶.1,.2¶.3,".4¶.5,.6¶ | :3: a quotation mark opened here is never closed in its line
¶"x,F¶1,2¶3,4¶ | :2: a quotation mark opened here is never closed in its line
x,F¶1,2,3¶4,5,6¶ | :1: 'x,F' is neither a row of data nor a header for line 2:
   name every column, begin the line with '#' if it is a comment, or remove commas within numbers
Measured today¶1,2¶4,5¶ | :1: 'Measured today' is neither a row of data nor a header for line 2 +kName
x,F¶abc,1¶1,2¶2,3¶ | :2: 'abc,1' is neither a row of data nor a header for line 3 +kName
# rig 3¶x [m],F [N]¶ | :2: no row down to 'x [m],F [N]' has numbers +kExpected
x,F¶nan,n/a¶#N/A,nan¶ | :3: no row down to '#N/A,nan' has numbers +kExpected
#N/A,#DIV/0!¶#VALUE!,#N/A¶ | :2: no row down to '#VALUE!,#N/A' has numbers +kExpected
x,F¶1,a¶2,b¶ | :2:2: 'F' (column 2) holds no numbers
x,F¶1,2¶ #n/a,3¶ | :3:1: '#n/a' +kWrite
)faults";

TEST(CsvTable, IsRefusedInOneLineWhereItIsBroken) {
  std::vector<Strings> faults = RowsOf(kFaults);
  faults.push_back({"", ": the file is empty"});
  faults.push_back({"\xEF\xBB\xBF", ": holds no data, only blank or '#' lines"});
  faults.push_back({std::string("x,F\n1,2\n\0\1", 10),
                    ":3: is not text, it holds a zero byte: export it as CSV, or give --encoding"});
  faults.push_back({"x,F\n1,2\n3," + std::string(59, 'a') + "µbc\n",
                    ":3:2: '" + std::string(59, 'a') + "µ...' +kWrite"});
  for (const Strings& fault : faults) {
    SCOPED_TRACE(fault[0]);
    const std::string message = MessageOf<InputError>([&] {
      const CsvTable table = Parse(fault[0]);
      for (std::size_t column = 0; column < table.columns.size(); ++column) {
        static_cast<void>(table.Numbers(column));
      }
    });
    const std::size_t plus = fault[1].rfind(" +k");
    const std::string end = plus == std::string::npos ? "" : kEnds.at(fault[1].substr(plus + 2));
    EXPECT_EQ(message.substr(message.find("loop.csv")),
              "loop.csv" + fault[1].substr(0, plus) + end);
  }
}

TEST(CsvTable, FindsColumnsRowsAndLines) {
  EXPECT_EQ(Parse("#N/Available,3\n#NA\n1,2\n# N/A\n3,4\n").rows(), 2u) << "comments";
  EXPECT_EQ(Column(Parse("1,5\n2,7\n"), 1), (Numbers{5, 7})) << "no decimal comma";
  EXPECT_EQ(Column(Parse("1,5;2,5;3,5\n"), 2), (Numbers{3.5}));
  EXPECT_EQ(Column(Parse("1,5 2,5\n"), 1), (Numbers{2.5}));
  EXPECT_EQ(Column(Parse("displacement [m]\n0.5\n-1\n"), 0), (Numbers{0.5, -1}));
  EXPECT_EQ(CellsOf(Parse("rig,with,new,pads\nt,x,F,N\n1,2,3,4\n"), &mindahl::io::Column::header),
            "t;x;F;N");
  EXPECT_EQ(Parse("1,2\n").header_line, 0u);
  const CsvTable lines = Parse("rate,2\r\n\r\nx,\"F [N]\"\r\n\r\n#\r\n1,2\r\n\r\n3,4\r\n");
  EXPECT_EQ(lines.header_line, 3u);
  EXPECT_EQ(lines.lines, (Lines{6, 8}));
  const CsvTable text = Parse("x,state,F\n1,ok,2\n3,,4\n");
  EXPECT_EQ(Column(text, 2), (Numbers{2, 4}));
  EXPECT_TRUE(text.columns[1].values.empty());
  EXPECT_EQ(Column(Parse("x,F,c\n1,2,3\n3,4\n5,6,7\n"), 1), (Numbers{2, 4, 6})) << "c is not used";
  EXPECT_EQ(Column(Parse("x\n0.1\n1.7976931348623157e308\n4.9406564584124654e-324\n1e-400\n"), 0),
            (Numbers{0.1, 1.7976931348623157e308, 5e-324, 0.0}));
}

// A sparse file of 64 GB: what is not text is seen in its first piece.
TEST(CsvTable, ReadsNoFurtherThanAZeroByte) {
  const TemporaryDirectory directory;
  const std::filesystem::path path = directory.Write("sparse.csv", "x,F\n");
  std::filesystem::resize_file(path, std::uintmax_t{64} << 30U);
  EXPECT_EQ(MessageOf<InputError>([&] { ReadCsvTable(path); }),
            path.string() +
                ":2: is not text, it holds a zero byte: export it as CSV, or give --encoding");
}

TEST(CsvTable, RefusesALineThatDoesNotEnd) {
  const TemporaryDirectory directory;
  const std::filesystem::path path =
      directory.Write("line.csv", "x,F\n1,2\n3,4\n" + std::string(18U << 20U, '7'));
  EXPECT_EQ(
      MessageOf<InputError>([&] { ReadCsvTable(path); }),
      path.string() + ": has a line of more than 16777216 bytes: lines must end in LF or CRLF");
}

TEST(CsvTable, SaysWhyAFileCannotBeRead) {
  const TemporaryDirectory directory;
  const auto refusal = [](const std::filesystem::path& path) {
    return MessageOf<InputError>([&] { ReadCsvTable(path); });
  };
  EXPECT_EQ(refusal("/no/such.csv"), "cannot read '/no/such.csv': No such file or directory");
  EXPECT_EQ(refusal(directory.path()),
            "cannot read '" + directory.path().string() + "': Is a directory");
  if (::geteuid() == 0) GTEST_SKIP() << "root may read every file";
  const std::filesystem::path path = directory.Write("loop.csv", "1,2\n");
  ::chmod(path.c_str(), 0);
  EXPECT_EQ(refusal(path), "cannot read '" + path.string() + "': Permission denied");
}

TEST(CsvWriter, WritesHeaderAndRows) {
  const Numbers time = {0, 1};
  const Numbers force = {-2.5, 1e300};
  EXPECT_EQ(CsvText({{"time [s]", time}, {"force [N]", force}}),
            "time [s],force [N]\n0,-2.5\n1,1.0000000000000001e+300\n");
  EXPECT_EQ(CsvText({{"x", {}}}), "x\n");
}

TEST(CsvWriter, WritesEveryDoubleSoThatItReadsBackAsItself) {
  const Numbers values = {0.1,
                          1.0 / 3,
                          -0.0,
                          5e-324,
                          std::numeric_limits<double>::max(),
                          1e23,
                          std::nextafter(1.0, 2.0)};
  const CsvTable table = Parse(CsvText({{"x", values}}));
  const auto read = table.Numbers(0);
  ASSERT_EQ(read.size(), values.size());
  for (std::size_t row = 0; row < values.size(); ++row) {
    EXPECT_EQ(read[row], values[row]);
    EXPECT_EQ(std::signbit(read[row]), std::signbit(values[row]));
  }
}

TEST(CsvWriter, QuotesNamesSoThatTheyReadBackAsThemselves) {
  const std::vector<std::string> names = {"x, mm", "the \"pad\"", "#1", "x; y", "plain"};
  const Numbers one = {1};
  std::vector<CsvColumn> columns;
  for (const std::string& name : names) columns.push_back({name, one});
  const std::string text = CsvText(columns);
  const CsvTable table = Parse(text);
  for (std::size_t k = 0; k < names.size(); ++k) {
    EXPECT_EQ(table.columns[k].header, names[k]);
  }
  EXPECT_EQ(text.substr(0, 22), "\"x, mm\",\"the \"\"pad\"\"\",");
  EXPECT_NE(text.find(",plain\n"), std::string::npos);
}

TEST(CsvWriter, QuotesCellsThatAReaderWouldTakeForSomethingElse) {
  for (const auto& [text, cell] : {std::pair{"-1.csv", "-1.csv"},
                                   {"@a,b", "\"@a,b\""},
                                   {" a", "\" a\""},
                                   {"a ", "\"a \""},
                                   {"#", "\"#\""},
                                   {"", "\"\""}}) {
    EXPECT_EQ(CsvCell(text), cell);
  }
}

TEST(CsvWriter, LeavesCellOfUnknownValueEmptyAndRefusesOthers) {
  const Numbers first = {1, std::nan("")};
  const Numbers second = {std::nan(""), 2};
  EXPECT_EQ(CsvText({{"a", first}, {"b", second}}), "a,b\n1,\n,2\n");
  const Numbers infinite = {1, -std::numeric_limits<double>::infinity()};
  const Numbers one = {1};
  const auto refusal = [](const std::vector<CsvColumn>& columns) {
    return MessageOf<InvalidArgument>([&] { CsvText(columns); });
  };
  EXPECT_EQ(refusal({{"force [N]", infinite}}),
            "force [N] of row 2 = -inf is invalid: must be finite");
  EXPECT_EQ(refusal({{"a", first}, {"b", one}}), "a has 2 values and b has 1: must be equal");
  EXPECT_EQ(refusal({}), "number of columns = 0 is invalid: must be >= 1");
}

}  // namespace
}  // namespace mindahl::io::csv_table_test
