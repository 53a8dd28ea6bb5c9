#include <fmt/format.h>

#include "io/number_cell.h"
#include "mindahl/io/csv_table.h"
#include "support/prelude.h"

// Marks that separate thousands in a file that has no decimals, and decimals that look like them.
namespace mindahl::io::thousands_test {
namespace {

/// 1234 as "1.234", 999 as "999".
std::string Grouped(int value, char mark) {
  const int size = std::abs(value);
  const std::string sign = value < 0 ? "-" : "";
  if (size < 1000) return fmt::format("{}{}", sign, size);
  return fmt::format("{}{}{}{:03}", sign, size / 1000, mark, size % 1000);
}

/// A loop's force, whole numbers of so much at most.
std::vector<int> Swings(double most, double centre) {
  std::vector<int> values;
  for (int i = 0; i < 120; ++i) {
    values.push_back(static_cast<int>(std::lround(centre + most * std::sin(0.1 * i))));
  }
  return values;
}

std::string Table(const std::vector<int>& force, char delimiter, char mark) {
  std::string text = fmt::format("x{}F\n", delimiter);
  for (std::size_t i = 0; i < force.size(); ++i) {
    text += fmt::format("{}{}{}\n", i, delimiter, Grouped(force[i], mark));
  }
  return text;
}

/// What is said against the second column; "" where nothing is.
std::string Fault(const std::string& text) {
  const CsvTable table = ParseCsvTable(text, "loop.csv");
  try {
    static_cast<void>(table.Numbers(1));
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(FindThousands, ComparesSmoothnessOverTheRangeOfEachReading) {
  // 0, 500, 1,000, …, 9,000: taken for decimals it leaps once by a range of 500, which is less in
  // newtons than each of the even steps, and far more of the range.
  std::vector<std::string> cells;
  for (int value = 0; value <= 9000; value += 500) cells.push_back(Grouped(value, ','));
  const std::vector<std::string_view> views(cells.begin(), cells.end());
  EXPECT_EQ(FindThousands(views), std::optional<std::size_t>(2));
}

TEST(Thousands, OfALoopBeyondThemAreRefusedWithPlaceAndRemedy) {
  const std::vector<int> force = Swings(1500, 0);
  const auto first = static_cast<std::size_t>(
      std::ranges::find_if(force, [](int value) { return std::abs(value) >= 1000; }) -
      force.begin());
  EXPECT_EQ(Fault(Table(force, ',', '.')),
            fmt::format("loop.csv:{}:2: '{}' has a '.' that separates thousands, since other "
                        "numbers of this column are whole and it would jump back to 1 after 999: "
                        "write {}",
                        first + 2, Grouped(force[first], '.'), force[first]));
}

TEST(Thousands, AreFoundWithACommaTooAndAwayFromZero) {
  EXPECT_NE(Fault(Table(Swings(1500, 0), ';', ',')), "");
  EXPECT_NE(Fault(Table(Swings(300, 1100), ',', '.')), "");
  EXPECT_NE(Fault(Table(Swings(30, -1010), '\t', '.')), "");
}

TEST(Thousands, AreNoneOfDecimalsThatLookLikeThem) {
  // Three decimals each, and whole numbers among them, as another program leaves zeros out.
  std::string text = "x,F\n";
  for (const int thousandths : Swings(5000, 7000)) {
    text += thousandths % 1000 == 0
                ? fmt::format("1,{}\n", thousandths / 1000)
                : fmt::format("1,{}.{:03}\n", thousandths / 1000, thousandths % 1000);
  }
  text += "1,7\n";
  EXPECT_EQ(Fault(text), "");
  EXPECT_EQ(Fault("x,F\n0,1.125\n1,2.250\n2,3.375\n3,4\n4,5.625\n"), "");
}

TEST(Thousands, AreNoneWhereAnyNumberShowsADecimalMark) {
  const std::string grouped = Table(Swings(1500, 0), ',', '.');
  EXPECT_EQ(Fault(grouped + "120,0.5\n"), "");
  EXPECT_EQ(Fault(grouped + "120,12.5\n"), "");
  EXPECT_EQ(Fault(grouped + "120,1e2\n"), "");
}

TEST(Thousands, MayBeOnlyWhereValuesAllow) {
  EXPECT_TRUE(MayHaveThousands(std::vector<double>{999, 1.0, 1.001, -1.25}));
  EXPECT_FALSE(MayHaveThousands(std::vector<double>{999, 1.0005}));
  EXPECT_FALSE(MayHaveThousands(std::vector<double>{999, 0.5}));
  EXPECT_FALSE(MayHaveThousands(std::vector<double>{999, 1000.5}));
}

}  // namespace
}  // namespace mindahl::io::thousands_test
