#include "mindahl/core/units.h"

#include "support/prelude.h"

namespace mindahl::units_test {
namespace {

using Lookup = std::optional<Unit> (*)(std::string_view);

TEST(Units, AreFoundByTheirNamesAndConverted) {
  struct Row {
    Lookup unit_of;
    std::string name;
    double number, in_si;
    std::string symbol = {};  // where it is not the name
  };
  constexpr double kPi = std::numbers::pi;
  for (const Row& row : std::vector<Row>{{LengthUnit, "m", 2.5, 2.5},
                                         {LengthUnit, "mm", 2.5, 2.5e-3},
                                         {LengthUnit, "nm", 2.5, 2.5e-9},
                                         {LengthUnit, "in", 1.0, 0.0254},
                                         // Rounded once, by an exact million: 2.3 * 1e-6 misses it.
                                         {LengthUnit, "um", 2.3, 2.3e-6},
                                         {LengthUnit, "micron", 2.5, 2.5e-6, "um"},
                                         {LengthUnit, "microns", 2.5, 2.5e-6, "um"},
                                         {LengthUnit, "\u00b5m", 1.0, 1e-6, "um"},
                                         {LengthUnit, "\u03bcm", 1.0, 1e-6, "um"},
                                         {ForceUnit, "N", 3.0, 3.0},
                                         {ForceUnit, "kN", 3.0, 3e3},
                                         {ForceUnit, "mN", 1.0, 1e-3},
                                         {ForceUnit, "MN", 1.0, 1e6},
                                         {ForceUnit, "\u00b5N", 1.0, 1e-6, "uN"},
                                         {ForceUnit, "lbf", 1.0, 4.4482216152605},
                                         {ForceUnit, "kip", 1.0, 4448.2216152605},
                                         {ForceUnit, "kgf", 1.0, 9.80665},
                                         {TimeUnit, "ms", 4.0, 4e-3},
                                         {AngleUnit, "rad", 2.0, 2.0},
                                         {AngleUnit, "deg", 180.0, kPi},
                                         {AngleUnit, "°", 180.0, kPi, "deg"},
                                         {AngleUnit, "rev", 1.0, 2 * kPi},
                                         {TorqueUnit, "N m", 3.0, 3.0},
                                         {TorqueUnit, "Nm", 3.0, 3.0, "N m"},
                                         {TorqueUnit, "N·m", 3.0, 3.0, "N m"},
                                         {TorqueUnit, "N*m", 3.0, 3.0, "N m"},
                                         {TorqueUnit, "N-m", 3.0, 3.0, "N m"},
                                         {TorqueUnit, "Nmm", 3.0, 3e-3, "N mm"},
                                         {TorqueUnit, "mNm", 3.0, 3e-3, "mN m"},
                                         {TorqueUnit, "\u00b5N m", 3.0, 3e-6, "uN m"}}) {
    const std::optional<Unit> unit = row.unit_of(row.name);
    ASSERT_TRUE(unit) << row.name;
    EXPECT_EQ(unit->ToSi(row.number), row.in_si) << row.name;
    EXPECT_EQ(unit->symbol, row.symbol.empty() ? row.name : row.symbol);
  }
}

TEST(Units, AreNotThoseOfAnotherKind) {
  for (const auto& [unit_of, name] : {std::pair<Lookup, const char*>(LengthUnit, "furlong"),
                                      {LengthUnit, "N"},
                                      {ForceUnit, "n"},
                                      {ForceUnit, "Nm"},
                                      {ForceUnit, "micron"},
                                      {AngleUnit, "m"},
                                      {TorqueUnit, "N"},
                                      {TorqueUnit, "m"},
                                      {TimeUnit, ""}}) {
    EXPECT_FALSE(unit_of(name)) << name;
  }
  for (const char* symbol : {"bar", "mbar", "Pa", "hPa", "kPa", "MPa", "GPa", "psi"}) {
    EXPECT_TRUE(IsPressureUnit(symbol)) << symbol;
    EXPECT_FALSE(ForceUnit(symbol)) << symbol;
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
  EXPECT_EQ(LengthUnitSymbols(), "m, mm, um, nm, cm, in, ft, mil, pm");
  EXPECT_EQ(AngleUnitSymbols(), "rad, mrad, deg, rev");
  EXPECT_EQ(ForceUnitSymbols(), "N, mN, uN, kN, MN, lbf, kgf, kip, gf, daN, dyn");
  EXPECT_EQ(TorqueUnitSymbols(), "N m, mN m, uN m, kN m, N mm, lbf in, lbf ft");
  EXPECT_EQ(TimeUnitSymbols(), "s, ms, us, ns, min, h");
}

}  // namespace
}  // namespace mindahl::units_test
