#include "mindahl/report/load_series.h"

#include <fmt/format.h>

#include <boost/math/distributions/students_t.hpp>
#include <nlohmann/json.hpp>

#include "mindahl/contact/shape_under_load.h"
#include "mindahl/report/report.h"
#include "report/made_report.h"
#include "support/prelude.h"

// Fits of a load series made by hand: each error, correlation and inflation of an interval has a
// number of its own, so that each is seen in what follows from it.
namespace mindahl::report::load_series_test {
namespace {

using contact::KnownContact;
using identification::FitResult;
using identification::ParameterEstimate;

constexpr double kRounding = 64 * std::numeric_limits<double>::epsilon();

constexpr double kExponent = 0.35;
constexpr double kErrorOfExponent = 0.03;
constexpr double kShape = 0.31;
constexpr double kErrorOfShape = 0.02;
constexpr double kErrorOfLogStiffness = 0.01;  // as MadeFit() has it

struct Correlations {
  double exponent_shape = 0.0;
  double exponent_stiffness = 0.0;
};

/// Two loads, 20 and 60 N; sigma, alpha, slip_force, load_exponent in this order.
ReportInput SeriesOf(const Correlations& correlations) {
  ReportInput input = MadeInput({MadeRecord(1e-6), MadeRecord(2e-6)}, 1e-6);
  FitResult& fit = input.fit;
  fit.parameters[1] = MadeParameter("alpha", "-", kShape, kErrorOfShape);
  fit.parameters.push_back(MadeParameter("load_exponent", "-", kExponent, kErrorOfExponent));
  const double shape = correlations.exponent_shape;
  const double stiffness = correlations.exponent_stiffness;
  fit.correlation = {1, 0, 0, stiffness, 0, 1, 0, shape, 0, 0, 1, 0, stiffness, shape, 0, 1};
  fit.normal_load = 40.0;
  fit.load_exponent = kExponent;
  fit.records[0].normal_load = 20.0;
  fit.records[0].load_ratio = 0.5;
  fit.records[1].normal_load = 60.0;
  fit.records[1].load_ratio = 1.5;
  return input;
}

double Quantile(const FitResult& fit) {
  return boost::math::quantile(boost::math::students_t(fit.ErrorDegreesOfFreedom()), 0.975);
}

const LoadLaw& Law(const LoadSeries& series, std::string_view name) {
  return *std::ranges::find(series.laws, name, &LoadLaw::name);
}

TEST(LoadSeriesHypotheses, HaveTheErrorOfTheDifferenceOfTwoFittedExponents) {
  const FitResult fit = SeriesOf({.exponent_shape = 0.9}).fit;
  const LoadSeries series = *DescribeLoadSeries(fit, {});
  const auto elements = std::ranges::find(series.hypotheses, "elements", &LoadHypothesis::name);
  // The variance of p − α has −2·cov, not +2·cov: 0.0147 in place of 0.0488.
  const double error = std::sqrt(std::pow(kErrorOfExponent, 2) + std::pow(kErrorOfShape, 2) -
                                 2 * 0.9 * kErrorOfExponent * kErrorOfShape);
  ASSERT_TRUE(elements->z);
  EXPECT_NEAR(*elements->z / ((kExponent - kShape) / error), 1, kRounding);
}

TEST(LoadLawsByHand, InheritIntervalInflationOfTheExponent) {
  FitResult fit = SeriesOf({.exponent_stiffness = 0.5}).fit;
  const double half = std::log(Law(*DescribeLoadSeries(fit, {}), "sphere").stiffness95->upper /
                               Law(*DescribeLoadSeries(fit, {}), "sphere").stiffness95->lower) /
                      2;
  constexpr double kWidened = 0.04;
  ParameterEstimate& exponent = fit.parameters[3];
  exponent.upper95 = kExponent + Quantile(fit) * kErrorOfExponent + kWidened;
  const identification::Interval wide = *Law(*DescribeLoadSeries(fit, {}), "sphere").stiffness95;
  // With p held ln σ moves by cov(ln σ, p)/var(p) of what p moves.
  const double gain = 0.5 * kErrorOfLogStiffness / kErrorOfExponent;
  EXPECT_NEAR((std::log(wide.upper / wide.lower) / 2 - half) / (gain * kWidened), 1,
              kRounding / (gain * kWidened));
}

TEST(LoadLawsByHand, PropagateTheErrorOfTheExponentToThatOfTheProfile) {
  const FitResult fit = SeriesOf({}).fit;
  const LoadLaw law = Law(*DescribeLoadSeries(fit, {}), "elements");
  const auto profile =
      std::ranges::find(law.quantities, "profile_exponent", &QuantityUnderLaw::key);
  ASSERT_NE(profile, law.quantities.end());
  // p = α: their mean weighted by 1/error², and its error; n = 1/p − 1, |dn/dp| = 1/p².
  const double weight_of_exponent = std::pow(kErrorOfExponent, -2);
  const double weight_of_shape = std::pow(kErrorOfShape, -2);
  const double both = weight_of_exponent + weight_of_shape;
  const double common = (weight_of_exponent * kExponent + weight_of_shape * kShape) / both;
  EXPECT_NEAR(profile->value.value / (1 / common - 1), 1, kRounding);
  EXPECT_NEAR(profile->value.standard_error / (1 / (common * common * std::sqrt(both))), 1,
              kRounding);
}

const QuantityUnderLaw& Quantity(const LoadLaw& law, std::string_view key) {
  return *std::ranges::find(law.quantities, key, &QuantityUnderLaw::key);
}

/// Half the logarithm of an interval's width.
double HalfWidth(const identification::Interval& interval) {
  return std::log(interval.upper / interval.lower) / 2;
}

constexpr double kNormalQuantile = 1.959963984540054;
// An interval's ends are found to the last places of a logarithm.
constexpr double kOfLogarithm = 1e-12;

TEST(LoadLawsByHand, AddTheSquaresOfTheErrorsOfFitAndInputs) {
  // a = σG*/8, whatever the law: the error of G* beside that of σ.
  KnownContact known;
  known.tangential_compliance = contact::UncertainValue{8e-11, 0.01 * 8e-11};
  const LoadSeries series = *DescribeLoadSeries(SeriesOf({}).fit, known);
  const LoadLaw& law = Law(series, "sphere");
  const QuantityUnderLaw& radius = Quantity(law, "contact_radius");
  ASSERT_TRUE(radius.interval95 && law.stiffness95);
  const double expected = std::hypot(HalfWidth(*law.stiffness95), kNormalQuantile * 0.01);
  EXPECT_NEAR(HalfWidth(*radius.interval95), expected, kOfLogarithm);
}

TEST(LoadLawsByHand, CompareAnEquivalentRadiusWithThatOfTheBodies) {
  KnownContact known;
  known.body_1 = {.youngs_modulus = 210e9, .poisson_ratio = 0.3, .radius = 0.1};
  known.body_2 = {.youngs_modulus = 70e9, .poisson_ratio = 0.3, .radius = 0.4};
  const LoadSeries series = *DescribeLoadSeries(SeriesOf({}).fit, known);
  const QuantityUnderLaw& radius = Quantity(Law(series, "sphere"), "equivalent_radius");
  ASSERT_TRUE(radius.predicted);
  EXPECT_NEAR(*radius.predicted / 0.08, 1, kRounding);  // 1/(1/0.1 + 1/0.4)
}

TEST(LoadLawsByHand, MoveTheEndsOfAModulusByWhatElseIsKnownOfTheContact) {
  // ln σ = (ln N + …)/3 …: an error of the load acts as one of ln σ a third as large.
  constexpr double kErrorOfLoad = 0.05;
  const FitResult fit = SeriesOf({}).fit;
  KnownContact known;
  known.normal_load = contact::UncertainValue{40.0, kErrorOfLoad * 40.0};
  known.body_1 = {.youngs_modulus = 210e9, .poisson_ratio = 0.3, .radius = 0.15};
  known.body_2 = {.youngs_modulus = std::nullopt,
                  .poisson_ratio = 0.3,
                  .radius = std::numeric_limits<double>::infinity()};
  const LoadSeries series = *DescribeLoadSeries(fit, known);
  const LoadLaw& law = Law(series, "sphere");
  const QuantityUnderLaw& modulus = Quantity(law, "youngs_modulus");
  ASSERT_TRUE(modulus.interval95 && law.stiffness95);
  const double half_width =
      std::hypot(HalfWidth(*law.stiffness95), kNormalQuantile * kErrorOfLoad / 3);
  for (const double sign : {-1.0, 1.0}) {
    const contact::UncertainValue stiffness{law.stiffness.value * std::exp(sign * half_width), 0.0};
    const auto shape =
        contact::IdentifyShape(contact::ContactShape::kSphere, stiffness, known).youngs_modulus;
    ASSERT_TRUE(shape);
    const double end = sign < 0 ? modulus.interval95->lower : modulus.interval95->upper;
    EXPECT_NEAR(end / shape->value, 1, 1e-9);
  }
}

/// The line of a load, without its unit's blanks.
std::string LineOfLoad(const ReportInput& input, std::string_view load) {
  const std::string text = ToText(MakeReport(input));
  const std::size_t begin = text.find(fmt::format("\n  {} ", load)) + 1;
  return text.substr(begin, text.find('\n', begin) - begin);
}

TEST(LoadSeriesText, HasNoNumberOfWhatIsNotKnown) {
  ReportInput input = SeriesOf({});
  const auto stiffness = HasSubstr("N/µm");
  const auto slip_force = HasSubstr("20.00 ± 0.20 N");
  EXPECT_THAT(LineOfLoad(input, "20 N"), AllOf(stiffness, slip_force));
  input.fit.parameters[2].identifiability = identification::Identifiability::kBoundedBelow;
  EXPECT_THAT(LineOfLoad(input, "20 N"), AllOf(stiffness, Not(slip_force)));
  input.fit.parameters[2].identifiability = identification::Identifiability::kIdentifiable;
  input.fit.parameters[0].identifiability = identification::Identifiability::kNotIdentifiable;
  EXPECT_THAT(LineOfLoad(input, "20 N"), AllOf(Not(stiffness), slip_force));
}

TEST(LoadSeriesJson, HasTheContactAtEachLoad) {
  // σ ∝ N^p and Tc = μN, with the errors of ln σ and of p, which the mean load leaves apart.
  const nlohmann::json fit = nlohmann::json::parse(ToJson(MakeReport(SeriesOf({}))));
  for (std::size_t r = 0; r < 2; ++r) {
    const nlohmann::json record = fit["load_series"]["records"][r];
    const double ratio = r == 0 ? 0.5 : 1.5;
    const double sigma = kSigma * std::pow(ratio, kExponent);
    EXPECT_EQ(record["normal_load"], 40 * ratio);
    EXPECT_NEAR(record["sigma"]["value"].get<double>() / sigma, 1, kRounding);
    EXPECT_NEAR(record["sigma"]["standard_error"].get<double>() /
                    (sigma * std::hypot(kErrorOfLogStiffness, kErrorOfExponent * std::log(ratio))),
                1, kRounding);
    EXPECT_NEAR(record["slip_force"]["value"].get<double>() / (kSlipForce * ratio), 1, kRounding);
    EXPECT_NEAR(record["slip_force"]["standard_error"].get<double>() / (0.01 * kSlipForce * ratio),
                1, kRounding);
  }
}

TEST(LoadSeriesJson, HasBothEndsOfTheIntervalsOfARecordAlone) {
  ReportInput input = SeriesOf({});
  input.fit.records[1].alone = {.stiffness = MadeParameter("sigma", "N/m", 5e7, 1e6),
                                .slip_force = MadeParameter("slip_force", "N", 60.0, 3.0)};
  const nlohmann::json fit = nlohmann::json::parse(ToJson(MakeReport(std::move(input))));
  const nlohmann::json alone = fit["load_series"]["records"][1]["alone"];
  EXPECT_EQ(alone["sigma"]["ci95"], nlohmann::json({4.8e7, 5.2e7}));
  EXPECT_EQ(alone["slip_force"]["ci95"], nlohmann::json({54.0, 66.0}));
}

}  // namespace
}  // namespace mindahl::report::load_series_test
