#include "mindahl/contact/mindlin_dahl_mapping.h"

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
KnownContact Known(const Body& first, const Body& second) {
  return {.friction_coefficient = kFriction,
          .normal_load = kNormalLoad,
          .body_1 = {first.youngs_modulus, first.poisson_ratio, first.radius},
          .body_2 = {second.youngs_modulus, second.poisson_ratio, second.radius}};
}

KnownContact KnowBodies() { return Known(kSteel, kAluminium); }

/// A contact by the functions of hertz.h and cattaneo_mindlin.h, one after the other.
struct ExactContact {
  double effective_modulus = 0.0;
  double tangential_compliance = 0.0;
  double equivalent_radius = 0.0;
  double contact_radius = 0.0;
  double maximum_pressure = 0.0;
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
  contact.dahl.slip_force = GrossSlipForce(kFriction, normal_load);
  contact.dahl = MapMindlinToDahl(contact.Mindlin());
  contact.gross_slip_displacement = GrossSlipDisplacement(contact.Mindlin());
  return contact;
}

ExactContact Truth() { return Solve(kSteel, kAluminium, kNormalLoad); }

using Quantity = ContactQuantity;

double Stiffness(double ratio = 1.0) { return ratio * Truth().dahl.tangential_stiffness; }

/// A quantity of a loop whose stiffness is so many times that of the truth.
std::optional<UncertainValue> Identify(Quantity quantity, const KnownContact& known,
                                       double ratio = 1.0) {
  return IdentifyContact(quantity, Stiffness(ratio), Truth().dahl.slip_force, known);
}

void ExpectValue(const std::optional<UncertainValue>& quantity, double value,
                 double tolerance = kRounding) {
  ASSERT_TRUE(quantity.has_value());
  EXPECT_NEAR(quantity->value / value, 1.0, tolerance);
}

TEST(IdentifyContact, ReturnsTheContactOfTheLoopAndHowFarItsStiffnessIsFromHertz) {
  const ExactContact truth = Truth();
  const KnownContact known = KnowBodies();
  for (const double ratio : {1.0, 0.7}) {  // 0.7: a rough or compliant contact
    const auto expect = [&](Quantity quantity, double value) {
      ExpectValue(Identify(quantity, known, ratio), value);
    };
    expect(Quantity::kFrictionCoefficient, kFriction);
    expect(Quantity::kStiffnessRatio, ratio);
    expect(Quantity::kContactRadius, ratio * truth.contact_radius);
    expect(Quantity::kEquivalentRadius, ratio * ratio * ratio * truth.equivalent_radius);
    expect(Quantity::kMaximumPressure, truth.maximum_pressure / (ratio * ratio));
  }
  EXPECT_EQ(Identify(Quantity::kContactRadius, known)->standard_error, 0.0);
  EXPECT_FALSE(Identify(Quantity::kTangentialCompliance, known));
}

TEST(IdentifyContact, FindsTheRadiusOfABodyFromMaterialsAndLoad) {
  KnownContact known = KnowBodies();
  known.body_1.radius.reset();
  ExpectValue(Identify(Quantity::kEquivalentRadius, known), Truth().equivalent_radius);
  EXPECT_FALSE(Identify(Quantity::kStiffnessRatio, known));
}

TEST(IdentifyContact, FindsTheComplianceFromAGivenRadius) {
  const ExactContact truth = Truth();
  const KnownContact known{.normal_load = kNormalLoad, .contact_radius = truth.contact_radius};
  ExpectValue(Identify(Quantity::kTangentialCompliance, known, 0.9),
              truth.tangential_compliance / 0.9);
  // The pressure follows from the given radius, whatever the stiffness.
  ExpectValue(Identify(Quantity::kMaximumPressure, known, 0.9), truth.maximum_pressure);
  for (const Quantity quantity :
       {Quantity::kContactRadius, Quantity::kEquivalentRadius, Quantity::kStiffnessRatio}) {
    EXPECT_FALSE(Identify(quantity, known));
  }
}

TEST(IdentifyContact, ComparesTheStiffnessWithAGivenRadiusAndCompliance) {
  const ExactContact truth = Truth();
  const KnownContact known{.normal_load = kNormalLoad,
                           .contact_radius = truth.contact_radius,
                           .tangential_compliance = truth.tangential_compliance};
  ExpectValue(Identify(Quantity::kStiffnessRatio, known, 0.9), 0.9);
  // Each from the stiffness and the other.
  ExpectValue(Identify(Quantity::kContactRadius, known, 0.9), 0.9 * truth.contact_radius);
  ExpectValue(Identify(Quantity::kTangentialCompliance, known, 0.9),
              truth.tangential_compliance / 0.9);
}

TEST(TangentialComplianceOfAKnownContact, IsTheGivenOneElseThatOfItsBodies) {
  const ExactContact truth = Truth();
  KnownContact known = KnowBodies();
  ExpectValue(TangentialCompliance(known), truth.tangential_compliance);
  known.tangential_compliance = 1.25 * truth.tangential_compliance;
  EXPECT_EQ(TangentialCompliance(known), 1.25 * truth.tangential_compliance);
  KnownContact one_body = KnowBodies();
  one_body.body_2.poisson_ratio.reset();
  EXPECT_FALSE(TangentialCompliance(one_body));
}

TEST(IdentifyContact, DeterminesNothingIfNothingIsKnown) {
  for (int quantity = 0; quantity <= static_cast<int>(Quantity::kStiffnessRatio); ++quantity) {
    EXPECT_FALSE(Identify(static_cast<Quantity>(quantity), {}));
  }
}

TEST(IdentifyContact, PrefersGivenComplianceToMaterials) {
  const ExactContact truth = Truth();
  KnownContact known = KnowBodies();
  known.tangential_compliance = 1.25 * truth.tangential_compliance;
  ExpectValue(Identify(Quantity::kContactRadius, known), 1.25 * truth.contact_radius);
  ExpectValue(Identify(Quantity::kStiffnessRatio, known), 1.25);
}

TEST(IdentifyContact, KeepsGivenRadiusSeparateFromHertzRadius) {
  const ExactContact truth = Truth();
  KnownContact known = KnowBodies();
  known.contact_radius = 2.0 * truth.contact_radius;
  ExpectValue(Identify(Quantity::kStiffnessRatio, known), 1.0);
  ExpectValue(Identify(Quantity::kMaximumPressure, known), 0.25 * truth.maximum_pressure);
  ExpectValue(Identify(Quantity::kEquivalentRadius, known), 8.0 * truth.equivalent_radius);
}

// --- uncertain inputs

// Relative standard uncertainties of inputs, unequal so that a mix-up shows.
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
  return {.friction_coefficient = Relative(kFriction, kFrictionError),
          .normal_load = Relative(kNormalLoad, kLoadError),
          .body_1 = {Relative(210e9, kModulusError1), UncertainValue(0.3, kPoissonError1),
                     Relative(0.02, kRadiusError1)},
          .body_2 = {Relative(70e9, kModulusError2), UncertainValue(0.33, kPoissonError2),
                     Relative(-0.05, kRadiusError2)}};
}

/// Returns the error of a quantity by a small change of every input, one after the other.
double ErrorByChanges(KnownContact known,
                      const std::function<double(const KnownContact&)>& quantity) {
  constexpr double kChange = 1e-3;  // of a standard error
  double squares = 0.0;
  for (std::optional<UncertainValue>* input :
       {&known.friction_coefficient, &known.normal_load, &known.contact_radius,
        &known.tangential_compliance, &known.body_1.youngs_modulus, &known.body_1.poisson_ratio,
        &known.body_1.radius, &known.body_2.youngs_modulus, &known.body_2.poisson_ratio,
        &known.body_2.radius}) {
    if (!*input) continue;
    const UncertainValue at = **input;
    *input = at.value + kChange * at.standard_error;
    const double more = quantity(known);
    *input = at.value - kChange * at.standard_error;
    const double by_error = (more - quantity(known)) / (2 * kChange);
    *input = at;
    squares += by_error * by_error;
  }
  return std::sqrt(squares);
}

// A change of 1e-5 of an input makes an error of its square and of rounding over it.
constexpr double kByChanges = 1e-8;

void ExpectErrors(const KnownContact& known, std::initializer_list<Quantity> quantities) {
  for (const Quantity quantity : quantities) {
    const double by_changes =
        ErrorByChanges(known, [&](const KnownContact& at) { return *Identify(quantity, at); });
    EXPECT_NEAR(Identify(quantity, known)->standard_error / by_changes, 1.0, kByChanges)
        << static_cast<int>(quantity);
  }
}

TEST(UncertainInputs, ActThroughMaterialsRadiiAndLoad) {
  ExpectErrors(UncertainBodies(), {Quantity::kFrictionCoefficient, Quantity::kContactRadius,
                                   Quantity::kEquivalentRadius, Quantity::kMaximumPressure,
                                   Quantity::kStiffnessRatio});
}

TEST(UncertainInputs, ActThroughGivenRadiusAndCompliance) {
  const ExactContact truth = Truth();
  KnownContact known{.normal_load = Relative(kNormalLoad, kLoadError)};
  known.contact_radius = Relative(truth.contact_radius, 0.015);
  known.tangential_compliance = Relative(truth.tangential_compliance, 0.006);
  ExpectErrors(known, {Quantity::kContactRadius, Quantity::kTangentialCompliance,
                       Quantity::kMaximumPressure, Quantity::kStiffnessRatio});
}

TEST(UncertainInputs, ActOnAPredictedContact) {
  const KnownContact known = UncertainBodies();
  using C = PredictedContact;
  const auto expect = [&](const std::function<UncertainValue(const C&)>& quantity) {
    const double by_changes = ErrorByChanges(
        known, [&](const KnownContact& at) { return quantity(PredictContact(at)).value; });
    const UncertainValue stated = quantity(PredictContact(known));
    EXPECT_NEAR(stated.standard_error / by_changes, 1.0, kByChanges) << stated.value;
  };
  expect([](const C& c) { return *c.effective_modulus; });
  expect([](const C& c) { return *c.equivalent_radius; });
  expect([](const C& c) { return c.tangential_compliance; });
  expect([](const C& c) { return c.contact_radius; });
  expect([](const C& c) { return c.maximum_pressure; });
  expect([](const C& c) { return c.tangential_stiffness; });
  expect([](const C& c) { return c.slip_force; });
  expect([](const C& c) { return c.gross_slip_displacement; });
}

TEST(UncertainInputs, CountAnInputOnceThatEntersTwice) {
  // Like bodies: σ/(8a/G*) with Hertz's a goes as G*·∛E*, and each modulus makes half of either, so
  // E₁ alone counts −1/2 + 1/6 = −1/3; taken for two inputs it would be √(1/4 + 1/36).
  constexpr double kError = 0.03;
  KnownContact known = Known(kSteel, kSteel);
  known.body_1.youngs_modulus = Relative(kSteel.youngs_modulus, kError);
  const UncertainValue ratio = *Identify(Quantity::kStiffnessRatio, known);
  EXPECT_NEAR(ratio.standard_error / ratio.value, kError / 3.0, kError * kByChanges);
}

TEST(UncertainInputs, OfAnIncompressibleBodyAreThoseFromBelow) {
  // 1/E* = 2(1 − ν²)/E: ν changes it by 2ν/(1 − ν²) of its error, of which each body has half.
  KnownContact known = Known({1e6, 0.5, 0.02}, {1e6, 0.5, 0.02});
  known.body_2.poisson_ratio = UncertainValue(0.5, 0.001);
  const UncertainValue modulus = *PredictContact(known).effective_modulus;
  constexpr double kOneSided = 1e-4;
  EXPECT_NEAR(modulus.standard_error / modulus.value, 0.001 * 0.5 / 0.75, 0.001 * kOneSided);
}

TEST(PredictContact, GivesTheValuesOfItsExactCounterparts) {
  const ExactContact truth = Truth();
  const PredictedContact contact = PredictContact(KnowBodies());
  EXPECT_EQ(*contact.effective_modulus, truth.effective_modulus);
  EXPECT_EQ(*contact.equivalent_radius, truth.equivalent_radius);
  EXPECT_EQ(contact.tangential_compliance, truth.tangential_compliance);
  EXPECT_EQ(contact.contact_radius, truth.contact_radius);
  EXPECT_EQ(contact.maximum_pressure, truth.maximum_pressure);
  EXPECT_EQ(contact.tangential_stiffness, truth.dahl.tangential_stiffness);
  EXPECT_EQ(contact.slip_force, truth.dahl.slip_force);
  EXPECT_EQ(contact.gross_slip_displacement, truth.gross_slip_displacement);
  EXPECT_EQ(contact.gross_slip_displacement.standard_error, 0.0);
}

TEST(PredictContact, RefusesWhatDoesNotDescribeAContactOrDoesSoTwice) {
  KnownContact unloaded = KnowBodies();
  unloaded.normal_load = 0.0;
  EXPECT_EQ(MessageOf([&] { PredictContact(unloaded); }),
            "normal load [N] = 0 is invalid: must be finite and > 0");
  KnownContact pulled = KnowBodies();
  pulled.friction_coefficient = -0.4;
  EXPECT_EQ(MessageOf([&] { PredictContact(pulled); }),
            "friction [-] = -0.4 is invalid: must be finite and > 0");
  const KnownBody plane{.youngs_modulus = 1e9, .poisson_ratio = 0.3, .radius = kInfinity};
  const KnownContact planes{.normal_load = 1.0, .body_1 = plane, .body_2 = plane};
  EXPECT_THAT(MessageOf([&] { PredictContact(planes); }), HasSubstr("two planes"));
  const std::string rule =
      "a contact needs --friction, --normal-load and either --contact-radius with --compliance or "
      "--youngs-modulus-1, --poisson-1, --radius-1 and the same of body 2";
  KnownContact twice = KnowBodies();
  twice.contact_radius = 1e-3;
  twice.tangential_compliance = 4e-11;
  EXPECT_EQ(MessageOf<InputError>([&] { PredictContact(twice); }), rule);
  EXPECT_EQ(MessageOf<InputError>([] { PredictContact({.normal_load = 1.0}); }), rule);
  KnownContact frictionless = KnowBodies();
  frictionless.friction_coefficient.reset();
  EXPECT_EQ(MessageOf<InputError>([&] { PredictContact(frictionless); }), rule);
  pulled.friction_coefficient = UncertainValue(0.3, -0.1);
  EXPECT_EQ(MessageOf([&] { PredictContact(pulled); }),
            "standard uncertainty of the friction [-] = -0.1 is invalid: must be finite and >= 0");
}

TEST(IdentifyContactInput, NamesTheEstimateThatIsInvalid) {
  const auto identify = [](double stiffness, double slip_force) {
    return MessageOf([&] { IdentifyContact(Quantity::kContactRadius, stiffness, slip_force, {}); });
  };
  EXPECT_EQ(identify(0.0, 1.0),
            "tangential stiffness [N/m] = 0 is invalid: must be finite and > 0");
  EXPECT_EQ(identify(1.0, kInfinity), "slip force [N] = inf is invalid: must be finite and > 0");
}

TEST(IdentifyContactInput, NamesTheKnowledgeThatIsInvalidEvenWhereItIsNotNeeded) {
  const auto identify = [](const KnownContact& known) {
    return MessageOf([&] { IdentifyContact(Quantity::kFrictionCoefficient, 1.0, 1.0, known); });
  };
  EXPECT_EQ(identify({.normal_load = 0.0}),
            "normal load [N] = 0 is invalid: must be finite and > 0");
  EXPECT_EQ(identify({.body_2 = {.youngs_modulus = -1.0}}),
            "youngs_modulus_2 [Pa] = -1 is invalid: must be finite and > 0");
  EXPECT_EQ(identify({.body_1 = {.poisson_ratio = 0.7}}),
            "poisson_1 [-] = 0.7 is invalid: must be > -1 and <= 0.5");
  EXPECT_EQ(identify({.body_1 = {.radius = 0.0}}),
            "radius_1 [m] = 0 is invalid: must be a number other than 0: infinite for a plane, "
            "negative for a concave seat");
  EXPECT_EQ(identify({.contact_radius = -2.0}),
            "contact radius [m] = -2 is invalid: must be finite and > 0");
  EXPECT_EQ(identify({.tangential_compliance = 0.0}),
            "compliance [1/Pa] = 0 is invalid: must be finite and > 0");
  EXPECT_THAT(identify({.body_1 = {.radius = kInfinity}, .body_2 = {.radius = kInfinity}}),
              HasSubstr("two planes"));
  EXPECT_EQ(identify({.normal_load = UncertainValue(1.0, -1.0)}),
            "standard uncertainty of the normal load [N] = -1 is invalid: must be finite and >= 0");
  EXPECT_EQ(identify({.body_2 = {.poisson_ratio = UncertainValue(0.3, kInfinity)}}),
            "standard uncertainty of the poisson_2 [-] = inf is invalid: must be finite and >= 0");
  EXPECT_EQ(identify({.body_1 = {.radius = UncertainValue(kInfinity, 0.1)}}),
            "standard uncertainty of the radius_1 [m] = 0.1 is invalid: must be 0 for a plane, "
            "which is exact");
}

TEST(IdentifyContact, RefusesAFrictionCoefficientThatNoDoubleHolds) {
  EXPECT_THROW(Identify(Quantity::kFrictionCoefficient, {.normal_load = 1e-320}), InvalidArgument);
}

KnownContact SphereOnPlane() { return Known({210e9, 0.3, 0.05}, {210e9, 0.3, kInfinity}); }

TEST(Doubts, AreNoneOfAnOrdinaryContact) {
  EXPECT_THAT(DoubtsAbout(SphereOnPlane()), IsEmpty());
  EXPECT_THAT(DoubtsAbout({.contact_radius = 2e-4, .tangential_compliance = 4e-11}), IsEmpty());
  EXPECT_THAT(DoubtsAbout({}), IsEmpty());
}

TEST(Doubts, AreOfAModulusThatIsNotInPascalOrStifferThanAnySolid) {
  const auto doubts = [](double modulus_1, double modulus_2) {
    return DoubtsAbout({.body_1 = {.youngs_modulus = modulus_1, .poisson_ratio = 0.3},
                        .body_2 = {.youngs_modulus = modulus_2, .poisson_ratio = 0.3}});
  };
  EXPECT_THAT(doubts(210, 1e6),  // GPa; rubber, at the limit
              ElementsAre(HasSubstr("Young's modulus of body 1 = 210 Pa is below 1 MPa")));
  EXPECT_THAT(doubts(1.2e12, 210e12),  // diamond; in GPa, and then once more
              ElementsAre(HasSubstr("Young's modulus of body 2 = 2.1e+14 Pa is above 2 TPa")));
}

TEST(Doubts, AreOfAComplianceThatIsAModulus) {
  const KnownContact known{.contact_radius = 2e-4, .tangential_compliance = 2.5e10};
  EXPECT_THAT(DoubtsAbout(known), ElementsAre(HasSubstr("give 4e-11 if so")));
}

TEST(Doubts, AreOfAContactAsLargeAsTheSmallerOfItsBodies) {
  KnownContact known = SphereOnPlane();
  known.normal_load = 50e9;
  EXPECT_THAT(DoubtsAbout(known), ElementsAre(HasSubstr("is more than a third")))
      << "by Hertz's radius";
  known.normal_load = std::nullopt;
  known.contact_radius = 0.017;
  EXPECT_THAT(DoubtsAbout(known), ElementsAre(HasSubstr("a = 0.017 m is more than a third")));
  known.contact_radius = 0.016;
  EXPECT_THAT(DoubtsAbout(known), IsEmpty());
  EXPECT_THAT(DoubtsAbout(known, 0.02), ElementsAre(HasSubstr("a = 0.02 m is more")));
  for (const double radius : {0.014, -0.014}) {  // a ball, a seat
    known.body_2.radius = radius;
    EXPECT_THAT(DoubtsAbout(known), ElementsAre(HasSubstr("the radius 0.014 m of a body")));
  }
}

}  // namespace
}  // namespace mindahl::contact::mindlin_dahl_mapping_test
