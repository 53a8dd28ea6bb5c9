#include "mindahl/convert/conversion.h"

#include <numeric>
#include <variant>

#include "mindahl/models/steady_loop.h"
#include "support/histories.h"
#include "support/prelude.h"

namespace mindahl::convert::conversion_test {
namespace {

using models::BranchLaw;

const ModelLaw kMindlin{&Model("mindlin-dahl"), {4e7, 1.0 / 3, 40.0}};
constexpr double kGrossSlip = 1.5e-6;  // 3Tc/(2σ) [m]
constexpr double kAmplitude = 0.8 * kGrossSlip;
/// Roots are found to 48 bits, energies of Bouc's and Wen's law to 1e-9.
constexpr double kSolved = 1e-8;

const TargetRow& Target(std::string_view name) {
  return *std::ranges::find(Targets(), name, &TargetRow::name);
}

Conversion To(std::string_view target, const ModelLaw& contact, ConversionOptions options = {}) {
  if (options.amplitude == 0) options.amplitude = kAmplitude;
  return Convert(contact, Target(target), options);
}

TEST(Conversion, BetweenMasingAndDahlIsExactAtTheAmplitude) {
  // Both sides' roundings, of some 16 ε each, over a T* near Tc and an energy of a fifth of 4XT*.
  constexpr double kRounding = 512 * std::numeric_limits<double>::epsilon();
  const Conversion dahl = To("dahl", kMindlin);
  EXPECT_LT(dahl.at_amplitude.force, kRounding);
  EXPECT_LT(std::abs(dahl.at_amplitude.energy), kRounding);
  const Conversion back = To("masing", std::get<ModelLaw>(dahl.law));
  EXPECT_LT(back.at_amplitude.force, kRounding);
  const BranchLaw law = std::get<ModelLaw>(back.law).law;
  EXPECT_NEAR(law.tangential_stiffness / 4e7, 1.0, kRounding);
  EXPECT_NEAR(law.slip_force / 40.0, 1.0, kRounding);
  // Elsewhere it is not, and the range that is stated ends on either side.
  ASSERT_TRUE(dahl.within);
  EXPECT_GT(dahl.within->first, 0.5 * kAmplitude);
  EXPECT_LT(dahl.within->first, kAmplitude);
  EXPECT_GT(dahl.within->second, kAmplitude);
}

TEST(Conversion, OfALawToItselfIsTheLaw) {
  const Conversion same = To("masing", kMindlin);
  EXPECT_EQ(std::get<ModelLaw>(same.law).law.tangential_stiffness, 4e7);
  EXPECT_EQ(same.at_amplitude.force, 0.0);
  ASSERT_TRUE(same.within);
  EXPECT_NEAR(same.within->second / kAmplitude, 100.0, 1e-9);  // as far as is looked
}

TEST(Conversion, FindsTheLawWhereItIsOne) {
  const ModelLaw exponential{&Model("dahl"), {4e7, 1.0, 40.0}};
  const BranchLaw lugre = std::get<ModelLaw>(To("lugre", exponential).law).law;
  EXPECT_NEAR(lugre.tangential_stiffness / 4e7, 1.0, kSolved);
  EXPECT_NEAR(lugre.slip_force / 40.0, 1.0, kSolved);
  EXPECT_EQ(lugre.shape_exponent, 1.0);
  const ModelLaw jenkins{&Model("mindlin-dahl"), {4e7, 0.0, 40.0}};
  const BranchLaw spring = std::get<ModelLaw>(To("lammps", jenkins, {.amplitude = 3e-6}).law).law;
  EXPECT_NEAR(spring.tangential_stiffness / 4e7, 1.0, kSolved);
  EXPECT_NEAR(spring.slip_force / 40.0, 1.0, kSolved);
  const Conversion iwan = To("iwan", jenkins, {.amplitude = 3e-6});
  EXPECT_EQ(std::get<methods::IwanElements>(iwan.law).size(), 1U);
  EXPECT_LT(iwan.at_amplitude.force, 1e-14);
}

TEST(Conversion, HasThePeakForceAndTheEnergyOfTheContact) {
  for (const double lambda : {0.1, 0.8, 3.0}) {
    const double amplitude = lambda * kGrossSlip;
    for (const ModelLaw& contact : {kMindlin, ModelLaw{&Model("dahl"), {4e7, 0.7, 40.0}}}) {
      for (const char* target : {"lugre", "bouc-wen", "lammps"}) {
        const Conversion made = To(target, contact, {.amplitude = amplitude});
        EXPECT_NEAR(LoopOf(made.law, amplitude).peak / LoopOf(contact, amplitude).peak, 1.0,
                    kSolved)
            << target << ' ' << lambda;
        EXPECT_NEAR(made.at_amplitude.energy, 0.0, 1e-6) << target << ' ' << lambda;
        EXPECT_LT(made.at_amplitude.force, 0.3) << target << ' ' << lambda;
      }
    }
  }
}

TEST(Conversion, SaysWhereForceAndEnergyAreWithinTheTolerance) {
  const Conversion dahl = To("dahl", kMindlin, {.tolerance = 0.05});
  ASSERT_TRUE(dahl.within);
  for (const double edge : {dahl.within->first, dahl.within->second}) {
    const LoopError error = CompareLoops(dahl.law, kMindlin, edge);
    EXPECT_NEAR(std::max(error.force, std::abs(error.energy)), 0.05, 1e-3);
  }
  EXPECT_FALSE(To("lammps", kMindlin).within);
}

TEST(Conversion, KeepsTheToleranceBetweenTheCornersOfTheElements) {
  // The error has a lobe from one corner to the next: at 1.12 µm one of 3.6 % that a search in wide
  // steps misses, with 1.36 µm on its other side.
  struct Case {
    double shape_exponent;
    double amplitude;
    std::size_t elements;
    double tolerance;
  };
  for (const Case& of :
       {Case{0.1, 1.362e-6, 4, 0.02}, Case{0.5, 5.264275516634976e-06, 8, 0.01},
        Case{1.0, 3.4576194912451477e-6, 16, 0.02}, Case{0.1, 6.051340769204074e-7, 32, 0.01}}) {
    const ModelLaw contact{&Model("mindlin-dahl"), {4e7, of.shape_exponent, 40.0}};
    const Conversion iwan =
        To("iwan", contact,
           {.amplitude = of.amplitude, .tolerance = of.tolerance, .elements = of.elements});
    ASSERT_TRUE(iwan.within);
    const auto [low, high] = *iwan.within;
    constexpr int kPlaces = 500;
    constexpr double kSearched = 1e-6;  // the top of a lobe, as exactly as it is searched for
    double largest = 0.0;
    for (int i = 0; i <= kPlaces; ++i) {
      const double amplitude = low * std::pow(high / low, static_cast<double>(i) / kPlaces);
      const LoopError error = CompareLoops(iwan.law, contact, amplitude);
      largest = std::max({largest, error.force, std::abs(error.energy)});
    }
    EXPECT_LE(largest, of.tolerance * (1 + kSearched)) << of.shape_exponent;
  }
}

TEST(Conversion, ToElementsIsTheTangentsOfTheVirginCurve) {
  double last = 1.0;
  for (const std::size_t elements : {1U, 2U, 4U, 8U, 16U}) {
    const Conversion made = To("iwan", kMindlin, {.elements = elements});
    const auto& law = std::get<methods::IwanElements>(made.law);
    EXPECT_EQ(law.slip_force, methods::MakeIwanElements(kMindlin.law, elements).slip_force);
    EXPECT_LT(made.at_amplitude.force, last);
    last = made.at_amplitude.force;
  }
  EXPECT_LT(last, 0.002);  // 0.192/16² of Tc, twice, over T*
  // Dahl's own law, and Masing's with the same loop.
  const ModelLaw dahl{&Model("dahl"), {4e7, 0.5, 40.0}};
  EXPECT_LT(To("iwan", dahl, {.elements = 64}).at_amplitude.force, 1e-3);
}

TEST(Conversion, RefusesOptionsThatBreakARule) {
  EXPECT_THROW(To("dahl", kMindlin, {.amplitude = -1.0}), InvalidArgument);
  EXPECT_THROW(To("dahl", kMindlin, {.tolerance = 0.0}), InvalidArgument);
  EXPECT_THROW(To("dahl", kMindlin, {.tolerance = 1.0}), InvalidArgument);
  EXPECT_THROW(To("iwan", kMindlin, {.elements = 0}), InvalidArgument);
  EXPECT_THROW(To("lammps", kMindlin, {.normal_load = -1.0}), InvalidArgument);
  EXPECT_THROW(To("dahl", kMindlin, {.normal_load = 1.0}), InputError);
}

TEST(Parameters, OfMasingsLawAreItsOwn) {
  const std::vector<Parameter> parameters = To("masing", kMindlin).parameters;
  ASSERT_EQ(parameters.size(), 3U);
  EXPECT_EQ(parameters[0].row.name, "sigma");
  EXPECT_EQ(parameters[0].value, 4e7);
  EXPECT_EQ(parameters[2].value, 40.0);
}

TEST(Parameters, HaveAFrictionCoefficientWhereTheLoadIsKnown) {
  EXPECT_EQ(To("lammps", kMindlin).parameters.size(), 2U);
  const std::vector<Parameter> parameters =
      To("lammps", kMindlin, {.normal_load = 100.0}).parameters;
  ASSERT_EQ(parameters.size(), 3U);
  EXPECT_EQ(parameters[2].row.name, "mu");
  EXPECT_EQ(parameters[2].value, parameters[1].value / 100.0);
}

TEST(Parameters, OfBoucAndWenShareTheExponentsUnitBetweenBetaAndGamma) {
  const std::vector<Parameter> parameters = To("bouc-wen", kMindlin).parameters;
  ASSERT_EQ(parameters.size(), 5U);
  EXPECT_EQ(parameters[2].row.name, "beta");
  EXPECT_EQ(parameters[3].row.name, "gamma");
  EXPECT_EQ(parameters[3].value, parameters[2].value);
}

TEST(InputLines, OfLammpsNeedANormalLoad) {
  EXPECT_THAT(To("lammps", kMindlin).input_lines, IsEmpty());
  EXPECT_THAT(To("lammps", kMindlin, {.normal_load = 100.0}).input_lines, SizeIs(2));
}

TEST(InputLines, HaveEveryValue) {
  for (const TargetRow& target : Targets()) {
    ConversionOptions options;
    if (target.form == Form::kSpring) options = {.normal_load = 100.0};
    const std::vector<std::string> lines = To(target.name, kMindlin, options).input_lines;
    EXPECT_THAT(lines, Not(IsEmpty())) << target.name;
    for (const std::string& line : lines) EXPECT_THAT(line, Not(HasSubstr("{")));
  }
}

}  // namespace
}  // namespace mindahl::convert::conversion_test
