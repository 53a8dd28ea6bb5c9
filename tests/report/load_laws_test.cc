

#include "mindahl/contact/cattaneo_mindlin.h"
#include "mindahl/contact/hertz.h"
#include "mindahl/identification/fit.h"
#include "mindahl/report/contact.h"
#include "mindahl/report/load_series.h"
#include "mindahl/report/page.h"
#include "mindahl/report/report.h"
#include "recovery/recovered.h"
#include "support/prelude.h"

// What a whole load series says of a contact by a law of the load: loops are made of contacts under
// several loads, by Hertz's law or another, and what is taken away of the bodies comes back.
namespace mindahl::report::load_laws_test {
namespace {

using contact::Body;
using contact::KnownContact;
using identification::Depth;
using identification::FitOptions;
using identification::FitResult;
using loop::Record;
using models::BranchLaw;

constexpr std::array kLoads = {20.0, 50.0, 110.0};  // [N], of mean 60
constexpr double kMeanLoad = 60.0;
constexpr double kFriction = 0.4;
constexpr Body kBall{210e9, 0.3, 0.05};
constexpr Body kPlate{70e9, 0.3, std::numeric_limits<double>::infinity()};
constexpr double kNoise = 0.1;  // [N], 0.4 % of Tc at the mean load

using Radius = std::function<double(double load)>;

double RadiusOfBall(double load) {
  return contact::HertzContactRadius(load, kBall.radius, contact::EffectiveModulus(kBall, kPlate));
}

constexpr double kConeSlope = 0.01;

/// Sneddon: N = (π/2)·E*a²·tan θ.
double RadiusOfCone(double load) {
  return std::sqrt(load / (M_PI / 2 * contact::EffectiveModulus(kBall, kPlate) * kConeSlope));
}

double RadiusOfPunch(double) { return 1e-4; }

BranchLaw LawUnder(double load, const Radius& radius, double shape_exponent) {
  return {contact::MindlinTangentialStiffness(radius(load),
                                              contact::TangentialCompliance(kBall, kPlate)),
          shape_exponent, kFriction * load};
}

/// One loop a load, driven to 1.3 times gross slip, each with offsets of its own.
std::vector<Record> Series(const Radius& radius, double shape_exponent, Generator& generator,
                           double noise = kNoise) {
  std::vector<Record> records;
  double offset = 1.0;
  for (const double load : kLoads) {
    const BranchLaw law = LawUnder(load, radius, shape_exponent);
    const double reach =
        1.3 * law.slip_force / (law.tangential_stiffness * (1 - law.shape_exponent));
    const auto displacement = testing::Cycling(testing::Wave::kSine, reach, 2.0, 100);
    records.push_back(testing::WithForceNoise(
        testing::Shifted(
            testing::MakeRecord(
                displacement, testing::Respond(testing::Model("mindlin-dahl"), law, displacement)),
            0.1 * reach, offset),
        noise, generator));
    offset += 1.0;
  }
  return records;
}

FitResult FitUnderLoads(const std::vector<Record>& records, std::optional<double> held = {},
                        Depth depth = Depth::kIntervals) {
  FitOptions options;
  options.normal_loads = {kLoads.begin(), kLoads.end()};
  options.initial_state = models::InitialState::kVirgin;
  if (held) options.fixed["load_exponent"] = *held;
  return identification::Fit(records, options, depth);
}

FitResult FitOf(const Radius& radius, double shape_exponent, std::uint64_t seed = 5) {
  Generator generator(seed);
  return FitUnderLoads(Series(radius, shape_exponent, generator));
}

KnownContact Bodies() {
  return {.normal_load = kMeanLoad,
          .body_1 = {kBall.youngs_modulus, kBall.poisson_ratio, kBall.radius},
          .body_2 = {kPlate.youngs_modulus, kPlate.poisson_ratio, kPlate.radius}};
}

KnownContact WithoutRadius() {
  KnownContact known = Bodies();
  known.body_1.radius.reset();
  return known;
}

KnownContact WithoutModuli() {
  KnownContact known = Bodies();
  known.body_1.youngs_modulus.reset();
  known.body_2.youngs_modulus.reset();
  return known;
}

KnownContact WithoutModulusOfPlate() {
  KnownContact known = Bodies();
  known.body_2.youngs_modulus.reset();
  return known;
}

const LoadLaw* Find(const LoadSeries& series, std::string_view name) {
  const auto law = std::ranges::find(series.laws, name, &LoadLaw::name);
  return law == series.laws.end() ? nullptr : &*law;
}

const QuantityUnderLaw* Find(const LoadSeries& series, std::string_view name,
                             std::string_view key) {
  const LoadLaw* const law = Find(series, name);
  if (law == nullptr) return nullptr;
  const auto quantity = std::ranges::find(law->quantities, key, &QuantityUnderLaw::key);
  return quantity == law->quantities.end() ? nullptr : &*quantity;
}

/// What is missing of the bodies, and the quantity of which it is.
struct Unknown {
  std::string_view key;
  KnownContact known;
  double truth;
};

std::vector<Unknown> Unknowns() {
  return {
      {"equivalent_radius", WithoutRadius(), kBall.radius},
      {"compliance", WithoutModuli(), contact::TangentialCompliance(kBall, kPlate)},
      {"effective_modulus", WithoutModuli(), contact::EffectiveModulus(kBall, kPlate)},
      {"youngs_modulus", WithoutModulusOfPlate(), kPlate.youngs_modulus},
      {"compliance", WithoutModulusOfPlate(), contact::TangentialCompliance(kBall, kPlate)},
  };
}

TEST(LoadLaws, RecoverUnknownPropertiesOfABall) {
  // 5 standard errors, which are a millionth of the quantity: for normal errors once in 10⁶.
  constexpr double kErrors = 5.0;
  constexpr double kFaint = 1e-4;  // [N]
  Generator generator(2);
  const FitResult fit = FitUnderLoads(Series(RadiusOfBall, 1.0 / 3, generator, kFaint));
  for (const Unknown& unknown : Unknowns()) {
    const auto series = DescribeLoadSeries(fit, unknown.known);
    ASSERT_TRUE(series);
    const QuantityUnderLaw* const quantity = Find(*series, "sphere", unknown.key);
    ASSERT_NE(quantity, nullptr) << unknown.key;
    EXPECT_LT(quantity->value.standard_error, 1e-4 * unknown.truth) << unknown.key;
    EXPECT_LT(std::abs(quantity->value.value - unknown.truth),
              kErrors * quantity->value.standard_error)
        << unknown.key;
    EXPECT_EQ(quantity->value.input_error, 0.0);
  }
}

TEST(LoadLaws, HaveTheStiffnessOfAFitWithTheExponentHeld) {
  // To first order the two are one; what is left is of the second, the square of errors of 3e-3.
  constexpr double kOfAnError = 0.05;
  const FitResult fit = FitOf(RadiusOfBall, 1.0 / 3);
  Generator generator(5);
  const FitResult held = FitUnderLoads(Series(RadiusOfBall, 1.0 / 3, generator), 1.0 / 3);
  const auto series = DescribeLoadSeries(fit, WithoutRadius());
  const LoadLaw* const law = Find(*series, "sphere");
  ASSERT_NE(law, nullptr);
  const double error = *held.Find("sigma")->standard_error;
  EXPECT_NEAR(law->stiffness.value, held.law.tangential_stiffness, kOfAnError * error);
  EXPECT_NEAR(law->stiffness.standard_error / error, 1, kOfAnError);
  EXPECT_LT(law->stiffness.standard_error, *fit.Find("sigma")->standard_error);
  const LoadLaw of_held = *Find(*DescribeLoadSeries(held, WithoutRadius()), "sphere");
  // The logarithm of a stiffness of 3e7 N/m, and back: 17 roundings of the last digit.
  EXPECT_NEAR(of_held.stiffness.value / held.law.tangential_stiffness, 1.0, 1e-14);
}

/// Series of noise of their own, and in how many of them the interval of each quantity covers it.
struct Coverage {
  std::size_t tenable = 0;
  std::vector<std::size_t> covered;
};

Coverage Cover(std::size_t series_count) {
  const std::vector<Unknown> unknowns = Unknowns();
  Coverage coverage{.tenable = 0, .covered = std::vector<std::size_t>(unknowns.size())};
  Generator generator(23);
  for (std::size_t s = 0; s < series_count; ++s) {
    const FitResult fit = FitUnderLoads(Series(RadiusOfBall, 1.0 / 3, generator));
    for (std::size_t u = 0; u < unknowns.size(); ++u) {
      const auto series = DescribeLoadSeries(fit, unknowns[u].known);
      const QuantityUnderLaw* const quantity = Find(*series, "sphere", unknowns[u].key);
      if (quantity == nullptr) continue;
      if (u == 0) ++coverage.tenable;
      if (quantity->interval95->lower <= unknowns[u].truth &&
          unknowns[u].truth <= quantity->interval95->upper) {
        ++coverage.covered[u];
      }
    }
  }
  return coverage;
}

/// Of `count` a share of 0.92 to 0.96, as docs/coverage.md has it of every parameter, to four
/// standard deviations of the binomial law.
void ExpectNineteenOfTwenty(std::size_t found, std::size_t count) {
  const auto all = static_cast<double>(count);
  const double chance = 4 * std::sqrt(0.95 * 0.05 * all);
  EXPECT_GE(static_cast<double>(found), 0.92 * all - chance);
  EXPECT_LE(static_cast<double>(found), 0.96 * all + chance);
}

void ExpectCoverage(std::size_t series_count) {
  const Coverage coverage = Cover(series_count);
  ExpectNineteenOfTwenty(coverage.tenable, series_count);
  for (const std::size_t covered : coverage.covered) {
    ExpectNineteenOfTwenty(covered, coverage.tenable);
  }
  ::testing::Test::RecordProperty("tenable", static_cast<int>(coverage.tenable));
  for (std::size_t u = 0; u < coverage.covered.size(); ++u) {
    ::testing::Test::RecordProperty("covered_" + std::to_string(u),
                                    static_cast<int>(coverage.covered[u]));
  }
}

TEST(LoadLaws, CoverTruthInNineteenOfTwentySeries) { ExpectCoverage(60); }

TEST(LoadLawsOfManySeries, CoverTruthInNineteenOfTwenty) { ExpectCoverage(4000); }

TEST(LoadLaws, GiveNoSphereWhereHertzIsRejectedAndTheConeThatIsTenable) {
  const FitResult fit = FitOf(RadiusOfCone, 0.5);
  EXPECT_TRUE(DeniesHertz(fit));
  const auto series = DescribeLoadSeries(fit, Bodies());
  EXPECT_EQ(Find(*series, "sphere"), nullptr);
  const QuantityUnderLaw* const slope = Find(*series, "cone", "slope");
  ASSERT_NE(slope, nullptr);
  constexpr double kErrors = 5.0;
  EXPECT_LT(std::abs(slope->value.value - kConeSlope), kErrors * slope->value.standard_error);
  // A body z ∝ r^n is a cone where n is 1.
  const QuantityUnderLaw* const profile = Find(*series, "elements", "profile_exponent");
  ASSERT_NE(profile, nullptr);
  EXPECT_LT(std::abs(profile->value.value - 1.0), kErrors * profile->value.standard_error);
  const contact::IdentifiedContact contact = IdentifyFittedContact(fit, Bodies());
  EXPECT_FALSE(contact.equivalent_radius);
  EXPECT_FALSE(contact.maximum_pressure);
  EXPECT_TRUE(contact.contact_radius);
}

TEST(LoadLaws, GiveTheRadiusOfAFlatPunchAndTheLengthOfRoughSurfaces) {
  constexpr double kErrors = 5.0;
  const auto punch = DescribeLoadSeries(FitOf(RadiusOfPunch, 0.2), Bodies());
  const QuantityUnderLaw* const radius = Find(*punch, "flat_punch", "contact_radius");
  ASSERT_NE(radius, nullptr);
  EXPECT_LT(std::abs(radius->value.value - RadiusOfPunch(1)),
            kErrors * radius->value.standard_error);
  constexpr double kPerNewton = 2e-6;  // [m/N] of a ∝ N: N/σ = G*/(8·a/N)
  const auto rough =
      DescribeLoadSeries(FitOf([](double load) { return kPerNewton * load; }, 0.6), {});
  const QuantityUnderLaw* const length = Find(*rough, "rough", "load_over_stiffness");
  ASSERT_NE(length, nullptr);
  EXPECT_LT(std::abs(length->value.value -
                     contact::TangentialCompliance(kBall, kPlate) / (8 * kPerNewton)),
            kErrors * length->value.standard_error);
}

TEST(LoadLaws, MatchFixedValuesToThreeDigits) {
  Generator generator(5);
  const std::vector<Record> records = Series(RadiusOfBall, 1.0 / 3, generator);
  const FitResult third = FitUnderLoads(records, 0.333);
  EXPECT_FALSE(DeniesHertz(third));
  EXPECT_NE(Find(*DescribeLoadSeries(third, WithoutRadius()), "sphere", "equivalent_radius"),
            nullptr);
  const FitResult other = FitUnderLoads(records, 0.35);
  EXPECT_TRUE(DeniesHertz(other));
  EXPECT_TRUE(DescribeLoadSeries(other, WithoutRadius())->laws.empty());
}

TEST(LoadLaws, AreNoneWhereStiffnessOrExponentIsOpen) {
  for (const char* parameter : {"sigma", "load_exponent"}) {
    FitResult fit = FitOf(RadiusOfBall, 1.0 / 3);
    for (identification::ParameterEstimate& estimate : fit.parameters) {
      if (estimate.name == parameter) {
        estimate.identifiability = identification::Identifiability::kNotIdentifiable;
      }
    }
    EXPECT_TRUE(DescribeLoadSeries(fit, WithoutRadius())->laws.empty()) << parameter;
  }
}

TEST(LoadLaws, InheritIntervalInflationOfTheFit) {
  FitResult fit = FitOf(RadiusOfBall, 1.0 / 3);
  const auto interval_of_radius = [&] {
    return *Find(*DescribeLoadSeries(fit, WithoutRadius()), "sphere", "equivalent_radius")
                ->interval95;
  };
  const identification::Interval narrow = interval_of_radius();
  constexpr double kFarther = 1.05;  // of σ: beyond it ρ is up to 1.05³ times as large
  for (identification::ParameterEstimate& estimate : fit.parameters) {
    if (estimate.name == "sigma") *estimate.upper95 *= kFarther;
  }
  const identification::Interval wide = interval_of_radius();
  EXPECT_NEAR(wide.upper / narrow.upper / std::pow(kFarther, 3), 1, 1e-9);
  EXPECT_NEAR(wide.lower / narrow.lower * std::pow(kFarther, 3), 1, 1e-9);
}

TEST(LoadLaws, CarryTheUncertaintyOfInputs) {
  const FitResult fit = FitOf(RadiusOfBall, 1.0 / 3);
  KnownContact known = WithoutRadius();
  known.normal_load = contact::UncertainValue{kMeanLoad, 0.05 * kMeanLoad};
  const auto series = DescribeLoadSeries(fit, known);
  const QuantityUnderLaw* const radius = Find(*series, "sphere", "equivalent_radius");
  EXPECT_NEAR(radius->value.input_error / radius->value.value, 0.05, 1e-12);  // ρ ∝ 1/N
  EXPECT_EQ(radius->value.largest_input, "normal load");
  EXPECT_GT(std::log(radius->interval95->upper / radius->value.value), 1.9 * 0.05);
}

TEST(LoadLaws, LeaveAModulusOpenWhereARigidBodyWouldDoAsWell) {
  // 1/210 + 1/70 GPa⁻¹ are those of 52.5 GPa against a rigid body.
  const FitResult fit = FitOf(RadiusOfBall, 1.0 / 3);
  KnownContact known = Bodies();
  known.body_2.youngs_modulus.reset();
  const auto modulus_beside = [&](double other) {
    known.body_1.youngs_modulus = other;
    return *Find(*DescribeLoadSeries(fit, known), "sphere", "youngs_modulus");
  };
  const QuantityUnderLaw closed = modulus_beside(210e9);
  EXPECT_LT(closed.interval95->lower, 70e9);
  EXPECT_GT(closed.interval95->upper, 70e9);
  EXPECT_LT(closed.interval95->upper, 80e9);
  const QuantityUnderLaw open = modulus_beside(52.55e9);
  EXPECT_GT(open.interval95->lower, 52.7e9);
  EXPECT_LT(open.interval95->lower, open.value.value);
  EXPECT_TRUE(std::isinf(open.interval95->upper));
}

TEST(LoadLaws, HaveNoIntervalForFixedParameters) {
  Generator generator(5);
  const std::vector<Record> records = Series(RadiusOfBall, 1.0 / 3, generator);
  FitOptions options;
  options.normal_loads = {kLoads.begin(), kLoads.end()};
  options.initial_state = models::InitialState::kVirgin;
  options.fixed["load_exponent"] = 1.0 / 3;
  options.fixed["sigma"] = LawUnder(kMeanLoad, RadiusOfBall, 1.0 / 3).tangential_stiffness;
  const FitResult fit = identification::Fit(records, options, Depth::kIntervals);
  const auto series = DescribeLoadSeries(fit, WithoutRadius());
  EXPECT_FALSE(Find(*series, "sphere", "equivalent_radius")->interval95);
}

Report ReportOf(const Radius& radius, double shape_exponent, const KnownContact& known) {
  Generator generator(5);
  ReportInput input;
  const std::vector<Record> records = Series(radius, shape_exponent, generator);
  for (const Record& record : records) {
    io::RecordFile file;
    file.record = record;
    file.displacement.unit = "m";
    file.force.unit = "N";
    input.files.push_back(std::to_string(input.files.size() + 1) + ".csv");
    input.records.push_back(std::move(file));
  }
  input.fit = FitUnderLoads(records, {}, Depth::kFull);
  input.known = known;
  return MakeReport(std::move(input));
}

TEST(LoadLaws, AreInTextPageAndJson) {
  const Report report = ReportOf(RadiusOfBall, 1.0 / 3, Bodies());
  const std::string text = ToText(report);
  EXPECT_THAT(text, HasSubstr("smooth sphere, Hertz (1/3) assumed at all loads"));
  EXPECT_THAT(text, HasSubstr("from the two radii"));
  EXPECT_THAT(text, Not(HasSubstr("Hertz's law is rejected")));
  EXPECT_THAT(ToPage(report, {}), HasSubstr("assumed at all loads"));
  EXPECT_THAT(ToJson(report), HasSubstr("\"equivalent_radius\""));
}

TEST(LoadLaws, SayEverywhereThatHertzIsDenied) {
  const Report report = ReportOf(RadiusOfCone, 0.5, Bodies());
  const std::string text = ToText(report);
  EXPECT_THAT(text, HasSubstr("Hertz's law is rejected: no radius"));
  EXPECT_THAT(text, HasSubstr("slope of the cone"));
  EXPECT_THAT(text, Not(HasSubstr("ρ = 4E*a³/(3N)")));
  const std::string page = ToPage(report, {});
  EXPECT_THAT(page, HasSubstr("law is rejected: no radius"));
  EXPECT_THAT(page, Not(HasSubstr("ρ = 4E*a³/(3N)")));
  EXPECT_THAT(ToJson(report), HasSubstr("which the load series denies"));
}

TEST(LoadLaws, SayWhyThereIsNone) {
  Report report = ReportOf(RadiusOfBall, 1.0 / 3, Bodies());
  ASSERT_THAT(ToText(report), Not(HasSubstr("no law")));
  report.load_series->laws.clear();
  EXPECT_THAT(ToText(report), HasSubstr("none of these theories is tenable"));
  for (LoadHypothesis& hypothesis : report.load_series->hypotheses) hypothesis.p_value.reset();
  EXPECT_THAT(ToText(report), HasSubstr("no load law is assumed"));
  for (identification::ParameterEstimate& estimate : report.fit.parameters) {
    if (estimate.name != "load_exponent") continue;
    estimate.status = identification::ParameterStatus::kFixed;
    estimate.value = 0.42;
  }
  EXPECT_THAT(ToText(report), HasSubstr("load_exponent is fixed at 0.42, which no theory "
                                        "predicts"));
  for (identification::ParameterEstimate& estimate : report.fit.parameters) {
    if (estimate.name != "sigma") continue;
    estimate.identifiability = identification::Identifiability::kNotIdentifiable;
  }
  EXPECT_THAT(ToText(report), HasSubstr("sigma or load_exponent is not identifiable"));
}

TEST(LoadLaws, SayWhatWouldHaveToBeKnown) {
  const Report report = ReportOf(RadiusOfBall, 1.0 / 3, {.normal_load = kMeanLoad});
  EXPECT_THAT(ToText(report), HasSubstr("the equivalent radius needs"));
}

}  // namespace
}  // namespace mindahl::report::load_laws_test
