#include "mindahl/core/units.h"

#include "support/prelude.h"

namespace mindahl::units_test {
namespace {

TEST(Units, ReadTheSymbolsOfTheCommandLine) {
  EXPECT_EQ(LengthUnit("m")->ToSi(2.5), 2.5);
  EXPECT_EQ(LengthUnit("mm")->ToSi(2.5), 2.5e-3);
  EXPECT_EQ(LengthUnit("um")->ToSi(2.5), 2.5e-6);
  EXPECT_EQ(LengthUnit("nm")->ToSi(2.5), 2.5e-9);
  EXPECT_EQ(LengthUnit("in")->ToSi(1.0), 0.0254);
  EXPECT_EQ(ForceUnit("N")->ToSi(3.0), 3.0);
  EXPECT_EQ(ForceUnit("kN")->ToSi(3.0), 3e3);
  EXPECT_EQ(ForceUnit("lbf")->ToSi(1.0), 4.4482216152605);
  EXPECT_EQ(ForceUnit("kgf")->ToSi(1.0), 9.80665);
  EXPECT_EQ(TimeUnit("ms")->ToSi(4.0), 4e-3);
}

TEST(Units, CaseDistinguishesMilliFromMega) {
  EXPECT_EQ(ForceUnit("mN")->ToSi(1.0), 1e-3);
  EXPECT_EQ(ForceUnit("MN")->ToSi(1.0), 1e6);
  EXPECT_FALSE(ForceUnit("n"));
}

TEST(Units, AMicronIsAMicrometre) {
  for (const char* name : {"micron", "microns"}) {
    EXPECT_EQ(LengthUnit(name)->ToSi(2.5), 2.5e-6);
    EXPECT_EQ(LengthUnit(name)->symbol, "um");
  }
  EXPECT_FALSE(ForceUnit("micron"));
}

TEST(Units, BothMicroSignsAreMicro) {
  EXPECT_EQ(LengthUnit("\u00b5m")->ToSi(1.0), 1e-6);
  EXPECT_EQ(LengthUnit("\u03bcm")->ToSi(1.0), 1e-6);
  EXPECT_EQ(ForceUnit("\u00b5N")->ToSi(1.0), 1e-6);
}

TEST(Units, MicrometresDivideByAnExactMillion) {
  // The quotient is rounded once; multiplying by the inexact 1e-6 misses it.
  EXPECT_EQ(LengthUnit("um")->ToSi(2.3), 2.3e-6);
  EXPECT_NE(2.3 * 1e-6, 2.3e-6);
}

TEST(Units, AnglesAndTorquesAreRecognised) {
  EXPECT_EQ(AngleUnit("rad")->ToSi(2.0), 2.0);
  EXPECT_EQ(AngleUnit("deg")->ToSi(180.0), std::numbers::pi);
  EXPECT_EQ(AngleUnit("°")->ToSi(180.0), std::numbers::pi);
  EXPECT_EQ(AngleUnit("rev")->ToSi(1.0), 2 * std::numbers::pi);
  EXPECT_FALSE(AngleUnit("m"));
  for (const char* symbol : {"N m", "Nm", "N·m", "N*m", "N-m"}) {
    ASSERT_TRUE(TorqueUnit(symbol)) << symbol;
    EXPECT_EQ(TorqueUnit(symbol)->symbol, "N m");
    EXPECT_EQ(TorqueUnit(symbol)->ToSi(3.0), 3.0);
  }
  EXPECT_EQ(TorqueUnit("Nmm")->ToSi(3.0), 3e-3);
  EXPECT_EQ(TorqueUnit("mNm")->ToSi(3.0), 3e-3);
  EXPECT_EQ(TorqueUnit("\u00b5N m")->ToSi(3.0), 3e-6);
  EXPECT_FALSE(TorqueUnit("N"));
  EXPECT_FALSE(TorqueUnit("m"));
}

TEST(Units, PressuresAreRecognisedAsNoForce) {
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

TEST(Units, AKipIsAThousandPounds) {
  EXPECT_DOUBLE_EQ(ForceUnit("kip")->ToSi(1.0), 1000 * ForceUnit("lbf")->ToSi(1.0));
}

TEST(Units, UnknownSymbolsAreNoUnit) {
  EXPECT_FALSE(LengthUnit("furlong"));
  EXPECT_FALSE(LengthUnit("N"));
  EXPECT_FALSE(ForceUnit("Nm"));
  EXPECT_FALSE(TimeUnit(""));
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
