#include "mindahl/core/units.h"

#include "support/prelude.h"

namespace mindahl::units_test {
namespace {

TEST(Units, AreFoundByTheirNamesAndConverted) {
  struct Row {
    Dimension dimension;
    std::string name;
    double number, in_si;
    std::string symbol = {};  // where it is not the name
  };
  constexpr double kPi = std::numbers::pi;
  for (const Row& row :
       std::vector<Row>{{Dimension::kLength, "m", 2.5, 2.5},
                        {Dimension::kLength, "mm", 2.5, 2.5e-3},
                        {Dimension::kLength, "nm", 2.5, 2.5e-9},
                        {Dimension::kLength, "in", 1.0, 0.0254},
                        // Rounded once, by an exact million: 2.3 * 1e-6 misses it.
                        {Dimension::kLength, "um", 2.3, 2.3e-6},
                        {Dimension::kLength, "micron", 2.5, 2.5e-6, "um"},
                        {Dimension::kLength, "microns", 2.5, 2.5e-6, "um"},
                        {Dimension::kLength, "\u00b5m", 1.0, 1e-6, "um"},
                        {Dimension::kLength, "\u03bcm", 1.0, 1e-6, "um"},
                        {Dimension::kForce, "N", 3.0, 3.0},
                        {Dimension::kForce, "kN", 3.0, 3e3},
                        {Dimension::kForce, "mN", 1.0, 1e-3},
                        {Dimension::kForce, "MN", 1.0, 1e6},
                        {Dimension::kForce, "\u00b5N", 1.0, 1e-6, "uN"},
                        {Dimension::kForce, "lbf", 1.0, 4.4482216152605},
                        {Dimension::kForce, "kip", 1.0, 4448.2216152605},
                        {Dimension::kForce, "kgf", 1.0, 9.80665},
                        {Dimension::kTime, "ms", 4.0, 4e-3},
                        {Dimension::kAngle, "rad", 2.0, 2.0},
                        {Dimension::kAngle, "deg", 180.0, kPi},
                        {Dimension::kAngle, "°", 180.0, kPi, "deg"},
                        {Dimension::kAngle, "rev", 1.0, 2 * kPi},
                        {Dimension::kTorque, "N m", 3.0, 3.0},
                        {Dimension::kTorque, "Nm", 3.0, 3.0, "N m"},
                        {Dimension::kTorque, "N·m", 3.0, 3.0, "N m"},
                        {Dimension::kTorque, "N*m", 3.0, 3.0, "N m"},
                        {Dimension::kTorque, "N-m", 3.0, 3.0, "N m"},
                        {Dimension::kTorque, "Nmm", 3.0, 3e-3, "N mm"},
                        {Dimension::kTorque, "Ncm", 3.0, 3e-2, "N cm"},
                        {Dimension::kTorque, "ft-lb", 1.0, 4.4482216152605 * 0.3048, "lbf ft"},
                        {Dimension::kTorque, "kgf.cm", 1.0, 9.80665e-2, "kgf cm"},
                        {Dimension::kLength, "㎜", 1.0, 1e-3, "mm"},
                        {Dimension::kForce, "oz", 16.0, 4.4482216152605, "ozf"},
                        {Dimension::kTorque, "mNm", 3.0, 3e-3, "mN m"},
                        {Dimension::kTorque, "\u00b5N m", 3.0, 3e-6, "uN m"}}) {
    const std::optional<Unit> unit = FindUnit(row.name);
    ASSERT_TRUE(unit) << row.name;
    EXPECT_EQ(unit->dimension, row.dimension) << row.name;
    EXPECT_EQ(unit->ToSi(row.number), row.in_si) << row.name;
    EXPECT_EQ(unit->symbol, row.symbol.empty() ? row.name : row.symbol);
  }
}

TEST(Units, AreFoundAsTheyAreWrittenAlone) {
  for (const char* name : {"furlong", "n", "mpa", "", "in N", "N/m", "m N"})
    EXPECT_FALSE(FindUnit(name)) << name;
  for (const char* symbol : {"bar", "mbar", "Pa", "hPa", "kPa", "MPa", "GPa", "psi"}) {
    EXPECT_EQ(FindUnit(symbol)->dimension, Dimension::kPressure) << symbol;
  }
}

TEST(ParseQuantity, TakesANumberOrAUnitOfItsKind) {
  EXPECT_EQ(ParseQuantity("210GPa", "Pa"), 210e9);
  EXPECT_EQ(ParseQuantity(" 50 N ", "N"), 50.0);
  EXPECT_EQ(ParseQuantity("+2.1e11", "Pa"), 2.1e11);
  EXPECT_EQ(ParseQuantity("0.3", "-"), 0.3);
  EXPECT_EQ(ParseQuantity("30%", "-"), 0.3);
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
  EXPECT_EQ(UnitSymbols(Dimension::kLength), "m, mm, um, nm, cm, in, ft, mil, pm");
  EXPECT_EQ(UnitSymbols(Dimension::kAngle), "rad, mrad, deg, rev");
  EXPECT_EQ(UnitSymbols(Dimension::kForce),
            "N, mN, uN, kN, MN, lbf, kgf, kip, gf, daN, dyn, ozf, cN");
  EXPECT_EQ(UnitSymbols(Dimension::kTorque), "N m, N mm");
  EXPECT_EQ(UnitSymbols(Dimension::kTime), "s, ms, us, ns, min, h");
}

}  // namespace
}  // namespace mindahl::units_test
