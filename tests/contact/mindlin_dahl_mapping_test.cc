#include "mindahl/contact/mindlin_dahl_mapping.h"

#include <boost/random/mersenne_twister.hpp>
#include <boost/random/normal_distribution.hpp>

#include "support/prelude.h"

namespace mindahl::contact::mindlin_dahl_mapping_test {
namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Chains of fewer than forty roundings, half an ulp each, with cubes of them.
constexpr double kRounding = 64.0 * kEpsilon;

// Two unlike bodies, neither a plane.
const Body kSteel{.youngs_modulus = 210e9, .poisson_ratio = 0.3, .radius = 0.02};
const Body kAluminium{.youngs_modulus = 70e9, .poisson_ratio = 0.33, .radius = 0.05};
constexpr double kNormalLoad = 150.0;
constexpr double kFriction = 0.4;

/// Knowledge of everything but what the loop or Hertz gives.
KnownContact KnowBodies() {
  return {.normal_load = kNormalLoad,
          .body_1 = {kSteel.youngs_modulus, kSteel.poisson_ratio, kSteel.radius},
          .body_2 = {kAluminium.youngs_modulus, kAluminium.poisson_ratio, kAluminium.radius}};
}

/// A contact by the functions of hertz.h and cattaneo_mindlin.h, one after the other.
struct ExactContact {
  double effective_modulus = 0.0;
  double tangential_compliance = 0.0;
  double equivalent_radius = 0.0;
  double contact_radius = 0.0;
  double maximum_pressure = 0.0;
  double approach = 0.0;
  models::BranchLaw dahl;
  double gross_slip_displacement = 0.0;

  [[nodiscard]] MindlinContact Mindlin() const {
    return {contact_radius, tangential_compliance, dahl.slip_force};
  }
};

ExactContact Solve(const Body& body_1, const Body& body_2, double normal_load) {
  ExactContact contact;
  contact.effective_modulus = EffectiveModulus(body_1, body_2);
  contact.tangential_compliance = TangentialCompliance(body_1, body_2);
  contact.equivalent_radius = EquivalentRadius(body_1.radius, body_2.radius);
  contact.contact_radius =
      HertzContactRadius(normal_load, contact.equivalent_radius, contact.effective_modulus);
  contact.maximum_pressure = HertzMaximumPressure(normal_load, contact.contact_radius);
  contact.approach = HertzApproach(contact.contact_radius, contact.equivalent_radius);
  contact.dahl.slip_force = GrossSlipForce(kFriction, normal_load);
  contact.dahl = MapMindlinToDahl(contact.Mindlin());
  contact.gross_slip_displacement = GrossSlipDisplacement(contact.Mindlin());
  return contact;
}

ExactContact Truth() { return Solve(kSteel, kAluminium, kNormalLoad); }

// Relative standard errors of the fit, unequal so that a mix-up shows.
constexpr double kStiffnessError = 0.02;
constexpr double kForceError = 0.003;

UncertainValue FittedStiffness(double ratio = 1.0) {
  const double stiffness = ratio * Truth().dahl.tangential_stiffness;
  return {stiffness, kStiffnessError * stiffness};
}
UncertainValue FittedSlipForce() {
  return {Truth().dahl.slip_force, kForceError * Truth().dahl.slip_force};
}

void ExpectEstimate(const std::optional<UncertainValue>& estimate, double value,
                    double relative_error) {
  ASSERT_TRUE(estimate.has_value());
  EXPECT_NEAR(estimate->value / value, 1.0, kRounding);
  EXPECT_NEAR(estimate->standard_error / value, relative_error, kRounding);
}

TEST(MapMindlinToDahl, GivesThePaperItsParametersForTheUnroundedRadius) {
  const models::BranchLaw dahl = MapMindlinToDahl({.contact_radius = 2.673548e-3,
                                                   .tangential_compliance = 4.42e-11,
                                                   .slip_force = GrossSlipForce(0.3, 100.0)});
  EXPECT_NEAR(dahl.tangential_stiffness, 4.839e8,
              0.0005e8);  // half a unit of the last printed digit
  EXPECT_EQ(dahl.shape_exponent, 1.0 / 3.0);
  EXPECT_DOUBLE_EQ(dahl.slip_force, 30.0);
}

TEST(MapMindlinToDahl, PutsGrossSlipAtOneAndAHalfElasticDisplacements) {
  const ExactContact contact = Truth();
  // δc = Tc/(σ(1 − α)) for any α < 1.
  EXPECT_NEAR(contact.gross_slip_displacement / GrossSlipDisplacement(contact.dahl), 1.0,
              kRounding);
}

TEST(MapMindlinToDahl, SolvesDahlsEquationWithMindlinsVirginCurve) {
  const MindlinContact contact = Truth().Mindlin();
  const models::BranchLaw dahl = MapMindlinToDahl(contact);
  const double reach = 0.9 * GrossSlipDisplacement(contact);
  // Fourth-order Runge-Kutta on dT/dδ = σ(1 − T/Tc)^α: its error over n steps to 0.9·δc is of the
  // order of n⁻⁴·(fifth derivative, below 1e4), 1e-11 of Tc for 5000 steps.
  constexpr int kSteps = 5000;
  constexpr double kRungeKutta = 1e-10;
  const auto slope = [&](double force) {
    return dahl.tangential_stiffness * std::pow(1.0 - force / dahl.slip_force, dahl.shape_exponent);
  };
  const double step = reach / kSteps;
  double force = 0.0;
  for (int index = 0; index < kSteps; ++index) {
    const double slope_1 = slope(force);
    const double slope_2 = slope(force + 0.5 * step * slope_1);
    const double slope_3 = slope(force + 0.5 * step * slope_2);
    const double slope_4 = slope(force + step * slope_3);
    force += step / 6.0 * (slope_1 + 2.0 * slope_2 + 2.0 * slope_3 + slope_4);
  }
  EXPECT_NEAR(force / MindlinVirginForce(contact, reach), 1.0, kRungeKutta);
}

TEST(PredictContact, CarriesAWorkedExampleThroughEveryQuantity) {
  // A 12 mm ball on a plane of the same stuff, ν = 0.25, E = 187.5 GPa: all by hand,
  //   E* = 187.5/(2·0.9375) = 100 GPa,  G = 187.5/2.5 = 75 GPa,  G* = 2·1.75/75e9,  a³ = 9e-12 m³.
  const PredictedContact contact = PredictContact({.normal_load = 100.0,
                                                   .body_1 = {187.5e9, 0.25, 0.012},
                                                   .body_2 = {187.5e9, 0.25, kInfinity}},
                                                  0.5);
  const double radius = std::cbrt(9e-12);
  const double compliance = 3.5 / 75e9;
  EXPECT_NEAR(*contact.effective_modulus / 1e11, 1.0, kRounding);
  EXPECT_NEAR(contact.tangential_compliance / compliance, 1.0, kRounding);
  EXPECT_EQ(*contact.equivalent_radius, 0.012);
  EXPECT_NEAR(contact.contact_radius / radius, 1.0, kRounding);
  EXPECT_NEAR(contact.maximum_pressure * std::numbers::pi * radius * radius, 150.0,
              150.0 * kRounding);
  EXPECT_NEAR(*contact.approach * 0.012 / (radius * radius), 1.0, kRounding);
  EXPECT_NEAR(contact.tangential_stiffness / (8.0 * radius / compliance), 1.0, kRounding);
  EXPECT_EQ(contact.slip_force, 50.0);
  EXPECT_NEAR(contact.gross_slip_displacement / (150.0 * compliance / (16.0 * radius)), 1.0,
              kRounding);
}

TEST(PredictContact, DoesNotDependOnWhichBodyComesFirst) {
  KnownContact swapped = KnowBodies();
  std::swap(swapped.body_1, swapped.body_2);
  const PredictedContact one_way = PredictContact(KnowBodies(), kFriction);
  const PredictedContact other_way = PredictContact(swapped, kFriction);
  EXPECT_NEAR(one_way.contact_radius / other_way.contact_radius, 1.0, kRounding);
  EXPECT_NEAR(one_way.tangential_stiffness / other_way.tangential_stiffness, 1.0, kRounding);
}

TEST(PredictContact, RefusesInvalidContact) {
  KnownContact unloaded = KnowBodies();
  unloaded.normal_load = 0.0;
  EXPECT_EQ(MessageOf([&] { PredictContact(unloaded, kFriction); }),
            "normal load [N] = 0 is invalid: must be finite and > 0");
  EXPECT_EQ(MessageOf([] { PredictContact(KnowBodies(), -0.4); }),
            "friction coefficient [-] = -0.4 is invalid: must be finite and > 0");
  const KnownBody plane{.youngs_modulus = 1e9, .poisson_ratio = 0.3, .radius = kInfinity};
  const KnownContact planes{.normal_load = 1.0, .body_1 = plane, .body_2 = plane};
  EXPECT_NE(MessageOf([&] { PredictContact(planes, kFriction); }).find("two planes"),
            std::string::npos);
}

TEST(IdentifyContact, ReturnsTheContactThatTheLoopWasMadeWith) {
  const ExactContact truth = Truth();
  const IdentifiedContact contact =
      IdentifyContact(FittedStiffness(), FittedSlipForce(), KnowBodies());
  ExpectEstimate(contact.friction_coefficient, kFriction, kForceError);
  ExpectEstimate(contact.contact_radius, truth.contact_radius, kStiffnessError);
  ExpectEstimate(contact.equivalent_radius, truth.equivalent_radius, 3.0 * kStiffnessError);
  ExpectEstimate(contact.maximum_pressure, truth.maximum_pressure, 2.0 * kStiffnessError);
  EXPECT_FALSE(contact.tangential_compliance.has_value());
  EXPECT_FALSE(contact.sigma_over_mindlin.has_value());

  ASSERT_TRUE(contact.hertz.has_value());
  EXPECT_EQ(contact.hertz->effective_modulus, truth.effective_modulus);
  EXPECT_EQ(contact.hertz->equivalent_radius, truth.equivalent_radius);
  EXPECT_EQ(contact.hertz->contact_radius, truth.contact_radius);
  EXPECT_EQ(contact.hertz->maximum_pressure, truth.maximum_pressure);
  EXPECT_EQ(contact.hertz->tangential_stiffness, truth.dahl.tangential_stiffness);
  ExpectEstimate(contact.hertz->gross_slip_displacement, truth.gross_slip_displacement,
                 kForceError);
  ExpectEstimate(contact.hertz->sigma_over_hertz_mindlin, 1.0, kStiffnessError);
  EXPECT_TRUE(contact.unidentified.empty());
  EXPECT_TRUE(contact.redundant.empty());
}

TEST(IdentifyContact, DetectsStiffnessThatContradictsHertz) {
  const ExactContact truth = Truth();
  constexpr double kRatio = 0.7;  // a rough or compliant contact
  const IdentifiedContact contact =
      IdentifyContact(FittedStiffness(kRatio), FittedSlipForce(), KnowBodies());
  ExpectEstimate(contact.hertz->sigma_over_hertz_mindlin, kRatio, kStiffnessError);
  ExpectEstimate(contact.contact_radius, kRatio * truth.contact_radius, kStiffnessError);
  ExpectEstimate(contact.equivalent_radius, kRatio * kRatio * kRatio * truth.equivalent_radius,
                 3.0 * kStiffnessError);
  ExpectEstimate(contact.maximum_pressure, truth.maximum_pressure / (kRatio * kRatio),
                 2.0 * kStiffnessError);
  EXPECT_EQ(contact.hertz->contact_radius, truth.contact_radius);
}

TEST(IdentifyContact, PropagatesErrorsAsTheSlopeOfItsOwnResult) {
  // What linear propagation must equal: the difference that a small change of σ makes.
  constexpr double kChange = 1e-6;
  constexpr double kSecondOrder =
      1e-5;  // the next order, at most 6·kChange, and rounding over kChange
  const UncertainValue stiffness = FittedStiffness();
  const UncertainValue changed{stiffness.value * (1.0 + kChange), 0.0};
  KnownContact known = KnowBodies();
  const IdentifiedContact before = IdentifyContact(stiffness, FittedSlipForce(), known);
  const IdentifiedContact after = IdentifyContact(changed, FittedSlipForce(), known);
  const auto expect_slope = [&](const UncertainValue& one, const UncertainValue& other) {
    const double slope = std::abs(other.value - one.value) / (kChange * stiffness.value);
    EXPECT_NEAR(one.standard_error / (slope * stiffness.standard_error), 1.0, kSecondOrder);
  };
  expect_slope(*before.contact_radius, *after.contact_radius);
  expect_slope(*before.equivalent_radius, *after.equivalent_radius);
  expect_slope(*before.maximum_pressure, *after.maximum_pressure);
  expect_slope(before.hertz->sigma_over_hertz_mindlin, after.hertz->sigma_over_hertz_mindlin);
  known.contact_radius = Truth().contact_radius;
  expect_slope(*IdentifyContact(stiffness, FittedSlipForce(), known).tangential_compliance,
               *IdentifyContact(changed, FittedSlipForce(), known).tangential_compliance);
}

TEST(IdentifyContact, FindsTheRadiusOfABodyFromMaterialsAndLoad) {
  KnownContact known = KnowBodies();
  known.body_1.radius.reset();
  const IdentifiedContact contact = IdentifyContact(FittedStiffness(), FittedSlipForce(), known);
  ExpectEstimate(contact.equivalent_radius, Truth().equivalent_radius, 3.0 * kStiffnessError);
  EXPECT_FALSE(contact.hertz.has_value());
  EXPECT_EQ(
      contact.unidentified,
      std::vector<std::string>{"Hertz prediction of the stiffness needs the radius of body 1"});
}

TEST(IdentifyContact, FindsTheComplianceFromAGivenRadius) {
  const ExactContact truth = Truth();
  const IdentifiedContact contact =
      IdentifyContact(FittedStiffness(), FittedSlipForce(),
                      {.normal_load = kNormalLoad, .contact_radius = truth.contact_radius});
  ExpectEstimate(contact.tangential_compliance, truth.tangential_compliance, kStiffnessError);
  // The given radius is exact, and so is the pressure that follows from it.
  ExpectEstimate(contact.maximum_pressure, truth.maximum_pressure, 0.0);
  EXPECT_FALSE(contact.contact_radius.has_value());
  EXPECT_FALSE(contact.equivalent_radius.has_value());
  EXPECT_FALSE(contact.sigma_over_mindlin.has_value());
  const std::string materials = "E and ν of both bodies";
  EXPECT_EQ(
      contact.unidentified,
      (std::vector<std::string>{
          "equivalent radius needs " + materials,
          "comparison of the stiffness with the given contact radius needs the tangential "
          "compliance (or, to derive it: " +
              materials + ")",
          "Hertz prediction of the stiffness needs " + materials + ", the radii of both bodies"}));
}

TEST(IdentifyContact, FindsTheRadiusFromAGivenCompliance) {
  const ExactContact truth = Truth();
  const IdentifiedContact contact = IdentifyContact(
      FittedStiffness(), FittedSlipForce(), {.tangential_compliance = truth.tangential_compliance});
  ExpectEstimate(contact.contact_radius, truth.contact_radius, kStiffnessError);
  EXPECT_FALSE(contact.maximum_pressure.has_value());
  ASSERT_EQ(contact.unidentified.size(), 4u);
  EXPECT_EQ(contact.unidentified[0], "friction coefficient needs the normal load");
  EXPECT_EQ(contact.unidentified[2], "maximum pressure needs the normal load");
}

TEST(IdentifyContact, ComparesTheStiffnessWithAGivenRadiusAndCompliance) {
  const ExactContact truth = Truth();
  const IdentifiedContact contact =
      IdentifyContact(FittedStiffness(0.9), FittedSlipForce(),
                      {.normal_load = kNormalLoad,
                       .contact_radius = truth.contact_radius,
                       .tangential_compliance = truth.tangential_compliance});
  ExpectEstimate(contact.sigma_over_mindlin, 0.9, kStiffnessError);
  // Each from the stiffness and the other.
  ExpectEstimate(contact.contact_radius, 0.9 * truth.contact_radius, kStiffnessError);
  ExpectEstimate(contact.tangential_compliance, truth.tangential_compliance / 0.9, kStiffnessError);
  ExpectEstimate(contact.maximum_pressure, truth.maximum_pressure, 0.0);
  EXPECT_TRUE(contact.redundant.empty());
}

TEST(IdentifyContact, NamesMissingInputsIfNothingIsKnown) {
  const IdentifiedContact contact = IdentifyContact(FittedStiffness(), FittedSlipForce(), {});
  EXPECT_FALSE(contact.friction_coefficient || contact.contact_radius ||
               contact.tangential_compliance || contact.equivalent_radius ||
               contact.maximum_pressure || contact.sigma_over_mindlin || contact.hertz);
  const std::string materials = "E and ν of both bodies";
  const std::string compliance = "the tangential compliance (or, to derive it: " + materials + ")";
  EXPECT_EQ(contact.unidentified,
            (std::vector<std::string>{
                "friction coefficient needs the normal load", "contact radius needs " + compliance,
                "tangential compliance needs the contact radius",
                "equivalent radius needs the normal load, " + materials,
                "maximum pressure needs the normal load, the contact radius or " + compliance,
                "Hertz prediction of the stiffness needs the normal load, " + materials +
                    ", the radii of both bodies"}));
}

TEST(IdentifyContact, NamesTheOneInputThatIsMissing) {
  KnownContact known = KnowBodies();
  known.body_2.poisson_ratio.reset();
  const IdentifiedContact contact = IdentifyContact(FittedStiffness(), FittedSlipForce(), known);
  ASSERT_FALSE(contact.unidentified.empty());
  EXPECT_EQ(
      contact.unidentified.front(),
      "contact radius needs the tangential compliance (or, to derive it: the Poisson ratio of body "
      "2)");
  EXPECT_EQ(contact.unidentified.back(),
            "Hertz prediction of the stiffness needs the Poisson ratio of body 2");
}

TEST(IdentifyContact, PrefersGivenComplianceToMaterialsWithNote) {
  const ExactContact truth = Truth();
  KnownContact known = KnowBodies();
  known.tangential_compliance = 1.25 * truth.tangential_compliance;
  const IdentifiedContact contact = IdentifyContact(FittedStiffness(), FittedSlipForce(), known);
  ExpectEstimate(contact.contact_radius, 1.25 * truth.contact_radius, kStiffnessError);
  // σ and a predicted by Hertz with the same G*: the ratios of both agree.
  EXPECT_EQ(contact.hertz->contact_radius, truth.contact_radius);
  EXPECT_NEAR(contact.hertz->sigma_over_hertz_mindlin.value, 1.25, 1.25 * kRounding);
  EXPECT_NEAR(contact.contact_radius->value / contact.hertz->contact_radius, 1.25,
              1.25 * kRounding);
  ASSERT_EQ(contact.redundant.size(), 1u);
  EXPECT_NE(contact.redundant[0].find("tangential compliance is given as"), std::string::npos);
  EXPECT_NE(contact.redundant[0].find("(given/derived = 1.25): the given value is used"),
            std::string::npos);
}

TEST(IdentifyContact, KeepsGivenRadiusSeparateFromHertzRadiusWithNote) {
  const ExactContact truth = Truth();
  KnownContact known = KnowBodies();
  known.contact_radius = 2.0 * truth.contact_radius;
  const IdentifiedContact contact = IdentifyContact(FittedStiffness(), FittedSlipForce(), known);
  ExpectEstimate(contact.sigma_over_mindlin, 0.5, kStiffnessError);
  ExpectEstimate(contact.hertz->sigma_over_hertz_mindlin, 1.0, kStiffnessError);
  ExpectEstimate(contact.maximum_pressure, 0.25 * truth.maximum_pressure, 0.0);
  ExpectEstimate(contact.equivalent_radius, 8.0 * truth.equivalent_radius, 0.0);
  EXPECT_EQ(contact.hertz->maximum_pressure, truth.maximum_pressure);
  ASSERT_EQ(contact.redundant.size(), 1u);
  EXPECT_NE(contact.redundant[0].find("contact radius is given as"), std::string::npos);
  EXPECT_NE(contact.redundant[0].find("from Hertz (given/derived = 2)"), std::string::npos);
}

TEST(IdentifyContact, CarriesAnOpenStandardErrorThrough) {
  const IdentifiedContact contact = IdentifyContact({FittedStiffness().value, kInfinity},
                                                    {FittedSlipForce().value, 0.0}, KnowBodies());
  EXPECT_EQ(contact.contact_radius->standard_error, kInfinity);
  EXPECT_EQ(contact.equivalent_radius->standard_error, kInfinity);
  EXPECT_EQ(contact.friction_coefficient->standard_error, 0.0);
  EXPECT_EQ(contact.hertz->gross_slip_displacement.standard_error, 0.0);
}

TEST(IdentifyContact, HoldsFromAtomicToTectonicContacts) {
  for (const double scale : {1e-9, 1.0, 1e6}) {
    const ExactContact truth =
        Solve({210e9, 0.3, 0.02 * scale}, {70e9, 0.33, 0.05 * scale}, kNormalLoad * scale * scale);
    const IdentifiedContact contact =
        IdentifyContact({truth.dahl.tangential_stiffness, 0.0}, {truth.dahl.slip_force, 0.0},
                        {.normal_load = kNormalLoad * scale * scale,
                         .body_1 = {210e9, 0.3, 0.02 * scale},
                         .body_2 = {70e9, 0.33, 0.05 * scale}});
    ExpectEstimate(contact.contact_radius, truth.contact_radius, 0.0);
    ExpectEstimate(contact.equivalent_radius, truth.equivalent_radius, 0.0);
    ExpectEstimate(contact.maximum_pressure, truth.maximum_pressure, 0.0);
  }
}

// Relative standard uncertainties of inputs, unequal so that a mix-up shows, and small: the first
// order is off by about their square.
constexpr double kLoadError = 0.007;
constexpr double kModulusError1 = 0.011;
constexpr double kModulusError2 = 0.008;
constexpr double kPoissonError1 = 0.009;  // absolute
constexpr double kPoissonError2 = 0.006;
constexpr double kRadiusError1 = 0.005;
constexpr double kRadiusError2 = 0.012;
constexpr double kFrictionError = 0.004;

UncertainValue Relative(double value, double relative_error) {
  return {value, std::abs(value) * relative_error};
}

/// A steel ball in an aluminium seat, nothing exact.
KnownContact UncertainBodies() {
  return {.normal_load = Relative(kNormalLoad, kLoadError),
          .body_1 = {Relative(210e9, kModulusError1), UncertainValue(0.3, kPoissonError1),
                     Relative(0.02, kRadiusError1)},
          .body_2 = {Relative(70e9, kModulusError2), UncertainValue(0.33, kPoissonError2),
                     Relative(-0.05, kRadiusError2)}};
}

class Sampler {
 public:
  explicit Sampler(std::uint64_t seed) : engine_(seed) {}

  double Normal() { return normal_(engine_); }
  UncertainValue Draw(const UncertainValue& known) {
    return known.value + known.standard_error * Normal();
  }
  KnownContact Draw(KnownContact known) {
    const auto draw = [&](std::optional<UncertainValue>& one) {
      if (one) one = Draw(*one);
    };
    draw(known.normal_load);
    for (KnownBody* body : {&known.body_1, &known.body_2}) {
      draw(body->youngs_modulus);
      draw(body->poisson_ratio);
      draw(body->radius);
    }
    draw(known.contact_radius);
    draw(known.tangential_compliance);
    return known;
  }

 private:
  boost::random::mt19937_64 engine_;
  boost::random::normal_distribution<double> normal_;
};

/// Mean and standard deviation as draws come in (Welford).
struct Scatter {
  void Add(double value) {
    ++count;
    const double change = value - mean;
    mean += change / count;
    squares += change * (value - mean);
  }
  [[nodiscard]] double Deviation() const { return std::sqrt(squares / (count - 1)); }

  double count = 0.0;
  double mean = 0.0;
  double squares = 0.0;
};

constexpr int kDraws = 20000;
// A standard deviation of n normal draws is known to 1/√(2n); five times that, and for the second
// order the square of the largest relative error of a result, 0.07 for ρ.
const double kScatter = 5.0 / std::sqrt(2.0 * kDraws) + 0.07 * 0.07;

/// Every quantity of a result, in an order of its own; `Contact` is identified or predicted.
template <typename Contact>
using Quantities =
    std::vector<std::pair<const char*, std::function<PropagatedValue(const Contact&)>>>;

template <typename Contact>
void ExpectScatter(const Contact& stated, const Quantities<Contact>& quantities,
                   const std::function<Contact()>& draw) {
  std::vector<Scatter> scatter(quantities.size());
  for (int i = 0; i < kDraws; ++i) {
    const Contact drawn = draw();
    for (std::size_t q = 0; q < quantities.size(); ++q) {
      scatter[q].Add(quantities[q].second(drawn).value);
    }
  }
  for (std::size_t q = 0; q < quantities.size(); ++q) {
    EXPECT_NEAR(quantities[q].second(stated).standard_error / scatter[q].Deviation(), 1.0, kScatter)
        << quantities[q].first;
  }
}

/// σ and Tc with errors of the given correlation.
std::pair<UncertainValue, UncertainValue> DrawFit(Sampler& sampler, const UncertainValue& stiffness,
                                                  const UncertainValue& force, double correlation) {
  const double first = sampler.Normal();
  const double second =
      correlation * first + std::sqrt(1.0 - correlation * correlation) * sampler.Normal();
  return {stiffness.value + stiffness.standard_error * first,
          force.value + force.standard_error * second};
}

constexpr double kCorrelation = -0.6;

TEST(UncertainInputs, ScatterAsStatedThroughMaterialsRadiiAndLoad) {
  const KnownContact known = UncertainBodies();
  const UncertainValue stiffness = FittedStiffness();
  const UncertainValue force = Relative(FittedSlipForce().value, 0.013);
  Sampler sampler(20170117);
  using C = IdentifiedContact;
  ExpectScatter<C>(
      IdentifyContact(stiffness, force, known, kCorrelation),
      {{"μ", [](const C& c) { return *c.friction_coefficient; }},
       {"a", [](const C& c) { return *c.contact_radius; }},
       {"ρ", [](const C& c) { return *c.equivalent_radius; }},
       {"p₀", [](const C& c) { return *c.maximum_pressure; }},
       {"δc", [](const C& c) { return c.gross_slip_displacement; }},
       {"predicted E*", [](const C& c) { return c.hertz->effective_modulus; }},
       {"predicted ρ", [](const C& c) { return c.hertz->equivalent_radius; }},
       {"predicted a", [](const C& c) { return c.hertz->contact_radius; }},
       {"predicted p₀", [](const C& c) { return c.hertz->maximum_pressure; }},
       {"predicted σ", [](const C& c) { return c.hertz->tangential_stiffness; }},
       {"predicted δc", [](const C& c) { return c.hertz->gross_slip_displacement; }},
       {"ratio of σ", [](const C& c) { return c.hertz->sigma_over_hertz_mindlin; }},
       {"ratio of δc", [](const C& c) { return c.hertz->gross_slip_displacement_ratio; }}},
      [&] {
        const auto [drawn_stiffness, drawn_force] =
            DrawFit(sampler, stiffness, force, kCorrelation);
        return IdentifyContact(drawn_stiffness, drawn_force, sampler.Draw(known));
      });
}

TEST(UncertainInputs, ScatterAsStatedThroughGivenRadiusAndCompliance) {
  const ExactContact truth = Truth();
  KnownContact known = UncertainBodies();
  known.contact_radius = Relative(truth.contact_radius, 0.015);
  known.tangential_compliance = Relative(truth.tangential_compliance, 0.006);
  Sampler sampler(20170118);
  using C = IdentifiedContact;
  ExpectScatter<C>(IdentifyContact(FittedStiffness(), FittedSlipForce(), known),
                   {{"a", [](const C& c) { return *c.contact_radius; }},
                    {"G*", [](const C& c) { return *c.tangential_compliance; }},
                    {"ρ", [](const C& c) { return *c.equivalent_radius; }},
                    {"p₀", [](const C& c) { return *c.maximum_pressure; }},
                    {"σ/(8a/G*)", [](const C& c) { return *c.sigma_over_mindlin; }}},
                   [&] {
                     const auto [stiffness, force] =
                         DrawFit(sampler, FittedStiffness(), FittedSlipForce(), 0.0);
                     return IdentifyContact(stiffness, force, sampler.Draw(known));
                   });
}

TEST(UncertainInputs, ScatterAsStatedInAPredictedContact) {
  const KnownContact known = UncertainBodies();
  const UncertainValue friction = Relative(kFriction, kFrictionError);
  Sampler sampler(20170119);
  using C = PredictedContact;
  ExpectScatter<C>(PredictContact(known, friction),
                   {{"E*", [](const C& c) { return *c.effective_modulus; }},
                    {"ρ", [](const C& c) { return *c.equivalent_radius; }},
                    {"approach", [](const C& c) { return *c.approach; }},
                    {"G*", [](const C& c) { return c.tangential_compliance; }},
                    {"a", [](const C& c) { return c.contact_radius; }},
                    {"p₀", [](const C& c) { return c.maximum_pressure; }},
                    {"σ", [](const C& c) { return c.tangential_stiffness; }},
                    {"Tc", [](const C& c) { return c.slip_force; }},
                    {"δc", [](const C& c) { return c.gross_slip_displacement; }}},
                   [&] {
                     const KnownContact drawn = sampler.Draw(known);
                     return PredictContact(drawn, sampler.Draw(friction));
                   });
}

TEST(UncertainInputs, SplitTheVarianceBetweenFitAndInputs) {
  // 3² + 4² = 5²: μ = Tc/N with 0.3 % from Tc and 0.4 % from N.
  const IdentifiedContact contact = IdentifyContact(FittedStiffness(), Relative(60.0, 0.003),
                                                    {.normal_load = Relative(kNormalLoad, 0.004)});
  const PropagatedValue& friction = *contact.friction_coefficient;
  EXPECT_NEAR(friction.fit_error / friction.value, 0.003, kRounding);
  EXPECT_NEAR(friction.input_error / friction.value, 0.004, kRounding);
  EXPECT_NEAR(friction.standard_error / friction.value, 0.005, kRounding);
  EXPECT_NEAR(friction.FitShare(), 0.36, kRounding);
  EXPECT_NEAR(friction.InputShare(), 0.64, kRounding);
  EXPECT_EQ(friction.largest_input, "normal load");
}

TEST(UncertainInputs, NameTheOneToMeasureBetter) {
  KnownContact known = KnowBodies();
  known.normal_load = Relative(kNormalLoad, 0.001);
  known.body_2.radius = Relative(kAluminium.radius, 0.02);
  const IdentifiedContact contact = IdentifyContact(FittedStiffness(), FittedSlipForce(), known);
  EXPECT_EQ(contact.hertz->contact_radius.largest_input, "radius of body 2");
  EXPECT_EQ(contact.equivalent_radius->largest_input, "normal load");
  EXPECT_EQ(contact.contact_radius->largest_input, "") << "G* of exact materials";
}

TEST(UncertainInputs, CountAnInputOnceThatEntersTwice) {
  // Like bodies: σ/(8a/G*) with Hertz's a goes as G*·∛E*, and each modulus makes half of either, so
  // E₁ alone counts −1/2 + 1/6 = −1/3; taken for two inputs it would be √(1/4 + 1/36).
  constexpr double kError = 0.03;
  const KnownBody exact = {kSteel.youngs_modulus, kSteel.poisson_ratio, kSteel.radius};
  KnownBody uncertain = exact;
  uncertain.youngs_modulus = Relative(kSteel.youngs_modulus, kError);
  const IdentifiedContact contact = IdentifyContact(
      {1e8, 0.0}, {50.0, 0.0}, {.normal_load = kNormalLoad, .body_1 = uncertain, .body_2 = exact});
  const PropagatedValue& ratio = contact.hertz->sigma_over_hertz_mindlin;
  EXPECT_NEAR(ratio.standard_error / ratio.value, kError / 3.0, kRounding);
}

TEST(UncertainInputs, TakeTheCorrelationOfTheFitIntoAccount) {
  const auto relative_error = [](double correlation) {
    const PropagatedValue displacement =
        IdentifyContact(FittedStiffness(), FittedSlipForce(), {}, correlation)
            .gross_slip_displacement;
    return displacement.standard_error / displacement.value;
  };
  // δc = 3Tc/(2σ): errors of the same sign cancel.
  EXPECT_NEAR(relative_error(1.0), kStiffnessError - kForceError, kRounding);
  EXPECT_NEAR(relative_error(-1.0), kStiffnessError + kForceError, kRounding);
  EXPECT_NEAR(relative_error(0.0), std::hypot(kStiffnessError, kForceError), kRounding);
  EXPECT_NEAR(relative_error(0.5),
              std::sqrt(kStiffnessError * kStiffnessError + kForceError * kForceError -
                        kStiffnessError * kForceError),
              kRounding);
}

TEST(UncertainInputs, LeaveAnOpenFitOpenWhateverItsCorrelation) {
  const IdentifiedContact contact =
      IdentifyContact({1e8, kInfinity}, {50.0, kInfinity}, UncertainBodies(), 1.0);
  EXPECT_EQ(contact.gross_slip_displacement.standard_error, kInfinity);
  EXPECT_EQ(contact.friction_coefficient->standard_error, kInfinity);
  EXPECT_EQ(contact.friction_coefficient->FitShare(), 1.0);
  EXPECT_EQ(contact.friction_coefficient->InputShare(), 0.0);
  // Tc cancels in the ratio.
  EXPECT_TRUE(std::isfinite(IdentifyContact({1e8, 1e6}, {50.0, kInfinity}, UncertainBodies())
                                .hertz->gross_slip_displacement_ratio.standard_error));
}

TEST(UncertainInputs, BringNothingWhereAllIsExact) {
  const PropagatedValue radius =
      *IdentifyContact({1e8, 0.0}, {50.0, 0.0}, KnowBodies()).contact_radius;
  EXPECT_EQ(radius.standard_error, 0.0);
  EXPECT_EQ(radius.FitShare(), 0.0);
  EXPECT_EQ(radius.InputShare(), 0.0);
}

TEST(PredictContact, GivesTheValuesOfItsExactCounterparts) {
  const ExactContact truth = Truth();
  const PredictedContact contact = PredictContact(KnowBodies(), kFriction);
  EXPECT_EQ(*contact.effective_modulus, truth.effective_modulus);
  EXPECT_EQ(*contact.equivalent_radius, truth.equivalent_radius);
  EXPECT_EQ(*contact.approach, truth.approach);
  EXPECT_EQ(contact.tangential_compliance, truth.tangential_compliance);
  EXPECT_EQ(contact.contact_radius, truth.contact_radius);
  EXPECT_EQ(contact.maximum_pressure, truth.maximum_pressure);
  EXPECT_EQ(contact.tangential_stiffness, truth.dahl.tangential_stiffness);
  EXPECT_EQ(contact.slip_force, truth.dahl.slip_force);
  EXPECT_EQ(contact.gross_slip_displacement, truth.gross_slip_displacement);
  EXPECT_EQ(contact.gross_slip_displacement.standard_error, 0.0);
}

TEST(PredictContact, RefusesWhatDoesNotDescribeAContactOrDoesSoTwice) {
  const std::string rule =
      "contact: must be given by its normal load and either contact radius and tangential "
      "compliance or E, ν and R of both bodies";
  KnownContact twice = KnowBodies();
  twice.contact_radius = 1e-3;
  twice.tangential_compliance = 4e-11;
  EXPECT_EQ(MessageOf([&] { PredictContact(twice, kFriction); }), rule);
  EXPECT_EQ(MessageOf([] { PredictContact({.normal_load = 1.0}, kFriction); }), rule);
  EXPECT_EQ(MessageOf([] {
              PredictContact(KnowBodies(), {0.3, -0.1});
            }),
            "standard uncertainty of the friction coefficient [-] = -0.1 is invalid: must be "
            "finite and >= 0");
}

TEST(IdentifyContactInput, NamesTheUncertaintyThatIsInvalid) {
  const auto identify = [](const KnownContact& known, double correlation = 0.0) {
    return MessageOf([&] { IdentifyContact({1.0, 0.0}, {1.0, 0.0}, known, correlation); });
  };
  EXPECT_EQ(identify({.normal_load = UncertainValue(1.0, -1.0)}),
            "standard uncertainty of the normal load [N] = -1 is invalid: must be finite and >= 0");
  EXPECT_EQ(identify({.body_2 = {.poisson_ratio = UncertainValue(0.3, kInfinity)}}),
            "standard uncertainty of the Poisson ratio of body 2 = inf is invalid: must be finite "
            "and >= 0");
  EXPECT_EQ(identify({.body_1 = {.radius = UncertainValue(kInfinity, 0.1)}}),
            "standard uncertainty of the radius of body 1 [m] = 0.1 is invalid: must be 0 for a "
            "plane, which is exact");
  EXPECT_EQ(identify({}, 1.5),
            "correlation of tangential stiffness and slip force [-] = 1.5 is invalid: must be "
            ">= -1 and <= 1");
  EXPECT_EQ(identify({}, std::nan("")),
            "correlation of tangential stiffness and slip force [-] = nan is invalid: must be "
            ">= -1 and <= 1");
}

TEST(IdentifyContactInput, NamesTheEstimateThatIsInvalid) {
  const auto identify = [](UncertainValue stiffness, UncertainValue slip_force) {
    return MessageOf([&] { IdentifyContact(stiffness, slip_force, {}); });
  };
  EXPECT_EQ(identify({0.0, 0.0}, {1.0, 0.0}),
            "tangential stiffness [N/m] = 0 is invalid: must be finite and > 0");
  EXPECT_EQ(identify({1.0, 0.0}, {kInfinity, 0.0}),
            "slip force [N] = inf is invalid: must be finite and > 0");
  EXPECT_EQ(identify({1.0, -1.0}, {1.0, 0.0}),
            "standard error of the tangential stiffness [N/m] = -1 is invalid: must be >= 0");
  EXPECT_EQ(identify({1.0, 0.0}, {1.0, std::nan("")}),
            "standard error of the slip force [N] = nan is invalid: must be >= 0");
}

TEST(IdentifyContactInput, NamesTheKnowledgeThatIsInvalidEvenWhereItIsNotNeeded) {
  const auto identify = [](const KnownContact& known) {
    return MessageOf([&] { IdentifyContact({1.0, 0.0}, {1.0, 0.0}, known); });
  };
  EXPECT_EQ(identify({.normal_load = 0.0}),
            "normal load [N] = 0 is invalid: must be finite and > 0");
  EXPECT_EQ(identify({.body_2 = {.youngs_modulus = -1.0}}),
            "Young's modulus of body 2 [Pa] = -1 is invalid: must be finite and > 0");
  EXPECT_EQ(identify({.body_1 = {.poisson_ratio = 0.7}}),
            "Poisson ratio of body 1 = 0.7 is invalid: must be > -1 and <= 0.5");
  EXPECT_EQ(identify({.body_1 = {.radius = 0.0}}),
            "radius of body 1 [m] = 0 is invalid: must be a number other than 0: infinite for a "
            "plane, negative for a concave seat");
  EXPECT_EQ(identify({.contact_radius = -2.0}),
            "contact radius [m] = -2 is invalid: must be finite and > 0");
  EXPECT_EQ(identify({.tangential_compliance = 0.0}),
            "tangential compliance [1/Pa] = 0 is invalid: must be finite and > 0");
  EXPECT_NE(identify({.body_1 = {.radius = kInfinity}, .body_2 = {.radius = kInfinity}})
                .find("two planes"),
            std::string::npos);
}

TEST(IdentifyContact, RefusesAFrictionCoefficientThatNoDoubleHolds) {
  KnownContact known;
  known.normal_load = UncertainValue{1e-320, 0.0};
  EXPECT_THROW(IdentifyContact(FittedStiffness(), FittedSlipForce(), known), InvalidArgument);
}

TEST(MissingInputs, NameEachConstantOfEachBodyThatIsNotKnown) {
  const KnownBody whole{.youngs_modulus = UncertainValue{2e11, 0.0},
                        .poisson_ratio = UncertainValue{0.3, 0.0}};
  const auto missing = [](const KnownBody& body_1, const KnownBody& body_2) {
    KnownContact known{.normal_load = UncertainValue{10.0, 0.0}};
    known.body_1 = body_1;
    known.body_2 = body_2;
    return MissingInputs(known, ContactQuantity::kEquivalentRadius);
  };
  using ::testing::ElementsAre;
  EXPECT_THAT(missing(whole, whole), ::testing::IsEmpty());
  KnownBody without_modulus = whole;
  without_modulus.youngs_modulus.reset();
  KnownBody without_ratio = whole;
  without_ratio.poisson_ratio.reset();
  EXPECT_THAT(missing(without_modulus, whole), ElementsAre("Young's modulus of body 1"));
  EXPECT_THAT(missing(whole, without_modulus), ElementsAre("Young's modulus of body 2"));
  EXPECT_THAT(missing(without_ratio, whole), ElementsAre("the Poisson ratio of body 1"));
  EXPECT_THAT(missing(without_modulus, without_ratio),
              ElementsAre("Young's modulus of body 1", "the Poisson ratio of body 2"));
  EXPECT_THAT(missing({}, without_ratio),
              ElementsAre("Young's modulus of body 1", "the Poisson ratio of body 1",
                          "the Poisson ratio of body 2"));
  EXPECT_THAT(missing({}, {}), ElementsAre("E and ν of both bodies"));
  EXPECT_THAT(MissingInputs({}, ContactQuantity::kFrictionCoefficient),
              ElementsAre("the normal load"));
  EXPECT_THAT(MissingInputs({}, ContactQuantity::kTangentialCompliance),
              ElementsAre("the contact radius"));
}

}  // namespace
}  // namespace mindahl::contact::mindlin_dahl_mapping_test
