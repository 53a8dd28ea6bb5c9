

#include "reading.h"

namespace mindahl::io::csv_writer_test {
namespace {

CsvTable Parse(const std::string& text) {
  const TemporaryDirectory directory;
  return ReadCsvTable(directory.Write("x.csv", text));
}

TEST(CsvWriter, WritesHeaderAndRows) {
  const Numbers time = {0, 1};
  const Numbers force = {-2.5, 1e300};
  EXPECT_EQ(CsvText({{"time [s]", time}, {"force [N]", force}}),
            "time [s],force [N]\n0,-2.5\n1,1.0000000000000001e+300\n");
}

TEST(CsvWriter, WritesHeaderAloneWithoutRows) { EXPECT_EQ(CsvText({{"x", {}}}), "x\n"); }

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
  const std::vector<std::string> names = {"x, mm", "the \"pad\"", "a\nb", "#1", "x; y", "plain"};
  const Numbers one = {1};
  std::vector<CsvColumn> columns;
  for (const std::string& name : names) columns.push_back({name, one});
  const std::string text = CsvText(columns);
  const CsvTable table = Parse(text);
  for (std::size_t k = 0; k < names.size(); ++k) {
    EXPECT_EQ(table.columns[k].name, k == 2 ? "a b" : names[k]);
  }
  EXPECT_EQ(text.substr(0, 24), "\"x, mm\",\"the \"\"pad\"\"\",\"a");
  EXPECT_NE(text.find(",plain\n"), std::string::npos);
}

TEST(CsvWriter, QuotesCellsThatAReaderOrASpreadsheetWouldTakeForSomethingElse) {
  for (const auto& [text, cell] : {std::pair{"=HYPERLINK(1)", "./=HYPERLINK(1)"},
                                   {"+1.csv", "./+1.csv"},
                                   {"-1.csv", "./-1.csv"},
                                   {"@a,b", "\"./@a,b\""},
                                   {"-", "-"},
                                   {"a=b", "a=b"},
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
}  // namespace mindahl::io::csv_writer_test
