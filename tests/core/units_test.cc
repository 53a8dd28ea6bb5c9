#include "mindahl/core/units.h"

#include "support/prelude.h"

namespace mindahl::units_test {
namespace {

TEST(Units, AreFoundByTheirNamesAndConverted) {
  struct Row {
    std::string base;
    std::string name;
    double number, in_si;
    std::string symbol = {};  // where it is not the name
  };
  constexpr double kPi = std::numbers::pi;
  for (const Row& row : std::vector<Row>{{"m", "m", 2.5, 2.5},
                                         {"m", "mm", 2.5, 2.5e-3},
                                         {"m", "nm", 2.5, 2.5e-9},
                                         {"m", "in", 1.0, 0.0254},
                                         // Rounded once, by an exact million: 2.3 * 1e-6 misses it.
                                         {"m", "um", 2.3, 2.3e-6},
                                         {"m", "micron", 2.5, 2.5e-6, "um"},
                                         {"m", "microns", 2.5, 2.5e-6, "um"},
                                         {"m", "\u00b5m", 1.0, 1e-6, "um"},
                                         {"m", "\u03bcm", 1.0, 1e-6, "um"},
                                         {"N", "N", 3.0, 3.0},
                                         {"N", "kN", 3.0, 3e3},
                                         {"N", "mN", 1.0, 1e-3},
                                         {"N", "MN", 1.0, 1e6},
                                         {"N", "\u00b5N", 1.0, 1e-6, "uN"},
                                         {"N", "lbf", 1.0, 4.4482216152605},
                                         {"N", "kip", 1.0, 4448.2216152605},
                                         {"N", "kgf", 1.0, 9.80665},
                                         {"s", "ms", 4.0, 4e-3},
                                         {"rad", "rad", 2.0, 2.0},
                                         {"rad", "deg", 180.0, kPi},
                                         {"rad", "°", 180.0, kPi, "deg"},
                                         {"rad", "rev", 1.0, 2 * kPi},
                                         {"N m", "N m", 3.0, 3.0},
                                         {"N m", "Nm", 3.0, 3.0, "N m"},
                                         {"N m", "N·m", 3.0, 3.0, "N m"},
                                         {"N m", "N*m", 3.0, 3.0, "N m"},
                                         {"N m", "N-m", 3.0, 3.0, "N m"},
                                         {"N m", "Nmm", 3.0, 3e-3, "N mm"},
                                         {"N m", "mNm", 3.0, 3e-3, "mN m"},
                                         {"N m", "\u00b5N m", 3.0, 3e-6, "uN m"}}) {
    const std::optional<Unit> unit = FindUnit(row.base, row.name);
    ASSERT_TRUE(unit) << row.name;
    EXPECT_EQ(unit->ToSi(row.number), row.in_si) << row.name;
    EXPECT_EQ(unit->symbol, row.symbol.empty() ? row.name : row.symbol);
  }
}

TEST(Units, AreNotThoseOfAnotherKind) {
  for (const auto& [base, name] : {std::pair<const char*, const char*>("m", "furlong"),
                                   {"m", "N"},
                                   {"N", "n"},
                                   {"N", "Nm"},
                                   {"N", "micron"},
                                   {"rad", "m"},
                                   {"N m", "N"},
                                   {"N m", "m"},
                                   {"s", ""}}) {
    EXPECT_FALSE(FindUnit(base, name)) << name;
  }
  for (const char* symbol : {"bar", "mbar", "Pa", "hPa", "kPa", "MPa", "GPa", "psi"}) {
    EXPECT_TRUE(IsPressureUnit(symbol)) << symbol;
    EXPECT_FALSE(FindUnit("N", symbol)) << symbol;
  }
  EXPECT_FALSE(IsPressureUnit("N"));
  EXPECT_FALSE(IsPressureUnit("mpa"));
}

TEST(ParseQuantity, TakesANumberOrAUnitOfItsKind) {
  EXPECT_EQ(ParseQuantity("210GPa", "Pa"), 210e9);
  EXPECT_EQ(ParseQuantity(" 50 N ", "N"), 50.0);
  EXPECT_EQ(ParseQuantity("+2.1e11", "Pa"), 2.1e11);
  EXPECT_EQ(ParseQuantity("0.3", "-"), 0.3);
  EXPECT_DOUBLE_EQ(*ParseQuantity("48 N/um", "N/m"), 48e6);
  EXPECT_DOUBLE_EQ(*ParseQuantity("4.2e-2 1/GPa", "1/Pa"), 4.2e-11);
  EXPECT_EQ(ParseQuantity("3 N s/m", "N s/m"), 3.0);
  for (const auto& [text, unit] : {std::pair("50 mm", "N"),
                                   {"", "N"},
                                   {"N", "N"},
                                   {"5 N", "-"},
                                   {"5 N", "N/m"},
                                   {"1,5", "N"},
                                   {"5 N N", "N"}}) {
    EXPECT_FALSE(ParseQuantity(text, unit)) << text;
  }
}

TEST(Units, ListTheirSymbolsForMessages) {
  EXPECT_EQ(UnitSymbols("m"), "m, mm, um, nm, cm, in, ft, mil, pm");
  EXPECT_EQ(UnitSymbols("rad"), "rad, mrad, deg, rev");
  EXPECT_EQ(UnitSymbols("N"), "N, mN, uN, kN, MN, lbf, kgf, kip, gf, daN, dyn");
  EXPECT_EQ(UnitSymbols("N m"), "N m, mN m, uN m, kN m, N mm, lbf in, lbf ft");
  EXPECT_EQ(UnitSymbols("s"), "s, ms, us, ns, min, h");
}

}  // namespace
}  // namespace mindahl::units_test
