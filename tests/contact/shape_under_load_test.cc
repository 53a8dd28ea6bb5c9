#include "mindahl/contact/shape_under_load.h"

#include "support/prelude.h"

// What a stiffness under a load says of a contact of a known kind of shape: a contact is made
// forward by Hertz and Mindlin, and its parts are taken away one by one.
namespace mindahl::contact::shape_under_load_test {
namespace {

// A power of at most three of a handful of operations, and a root found to the last bits of ln E,
// which is 25 here.
constexpr double kRounding = 100 * std::numeric_limits<double>::epsilon();

constexpr double kLoad = 60.0;  // [N]
constexpr Body kSteelBall{210e9, 0.3, 0.05};
constexpr Body kGlassSeat{70e9, 0.22, -0.2};

/// Everything of two bodies but what a test takes away.
KnownContact Known(const Body& first, const Body& second) {
  return {.normal_load = kLoad,
          .body_1 = {first.youngs_modulus, first.poisson_ratio, first.radius},
          .body_2 = {second.youngs_modulus, second.poisson_ratio, second.radius}};
}

struct Truth {
  double equivalent_radius;
  double effective_modulus;
  double compliance;
  double contact_radius;
  double stiffness;
};

Truth Make(const Body& first, const Body& second) {
  Truth truth{};
  truth.equivalent_radius = EquivalentRadius(first.radius, second.radius);
  truth.effective_modulus = EffectiveModulus(first, second);
  truth.compliance = TangentialCompliance(first, second);
  truth.contact_radius =
      HertzContactRadius(kLoad, truth.equivalent_radius, truth.effective_modulus);
  truth.stiffness = MindlinTangentialStiffness(truth.contact_radius, truth.compliance);
  return truth;
}

void ExpectNear(const std::optional<PropagatedValue>& value, double expected) {
  ASSERT_TRUE(value);
  EXPECT_NEAR(value->value / expected, 1, kRounding);
}

TEST(SphereUnderLoad, HasItsRadiusFromMaterials) {
  const Truth truth = Make(kSteelBall, kGlassSeat);
  KnownContact known = Known(kSteelBall, kGlassSeat);
  known.body_1.radius.reset();
  const ShapeUnderLoad sphere = IdentifyShape(ContactShape::kSphere, truth.stiffness, known);
  ExpectNear(sphere.equivalent_radius, truth.equivalent_radius);
  ExpectNear(sphere.contact_radius, truth.contact_radius);
  EXPECT_FALSE(sphere.tangential_compliance);
  EXPECT_THAT(sphere.unidentified, IsEmpty());
}

TEST(SphereUnderLoad, HasTheModulusOfOneBodyFromRadiiAndTheOther) {
  const Truth truth = Make(kSteelBall, kGlassSeat);
  for (const int body : {1, 2}) {
    KnownContact known = Known(kSteelBall, kGlassSeat);
    (body == 1 ? known.body_1 : known.body_2).youngs_modulus.reset();
    const ShapeUnderLoad sphere = IdentifyShape(ContactShape::kSphere, truth.stiffness, known);
    EXPECT_EQ(sphere.body, body);
    ExpectNear(sphere.youngs_modulus, (body == 1 ? kSteelBall : kGlassSeat).youngs_modulus);
    ExpectNear(sphere.tangential_compliance, truth.compliance);
    ExpectNear(sphere.effective_modulus, truth.effective_modulus);
    ExpectNear(sphere.contact_radius, truth.contact_radius);
    EXPECT_FALSE(sphere.equivalent_radius);
  }
}

TEST(SphereUnderLoad, HasTheModulusOfABodyThatIsAThousandTimesSofterOrStiffer) {
  for (const double modulus : {1e6, 1e9, 1e14}) {
    const Body body{modulus, 0.45, std::numeric_limits<double>::infinity()};
    const Truth truth = Make(kSteelBall, body);
    KnownContact known = Known(kSteelBall, body);
    known.body_2.youngs_modulus.reset();
    const ShapeUnderLoad sphere = IdentifyShape(ContactShape::kSphere, truth.stiffness, known);
    ASSERT_TRUE(sphere.youngs_modulus);
    // σ of a body that is stiffer than the other hardly depends on E: rounding is magnified.
    const double magnified = 1 + modulus / kSteelBall.youngs_modulus;
    EXPECT_NEAR(sphere.youngs_modulus->value / modulus, 1, magnified * kRounding);
  }
}

TEST(SphereUnderLoad, RefusesAStiffnessBeyondThatAgainstARigidBody) {
  constexpr double kBeyondEveryBody = 1e30;
  const Truth rigid = Make(kSteelBall, {kBeyondEveryBody, 0.3, 0.1});
  KnownContact known = Known(kSteelBall, {1, 0.3, 0.1});
  known.body_2.youngs_modulus.reset();
  const ShapeUnderLoad sphere =
      IdentifyShape(ContactShape::kSphere, 1.001 * rigid.stiffness, known);
  EXPECT_FALSE(sphere.youngs_modulus);
  EXPECT_FALSE(sphere.tangential_compliance);
  EXPECT_THAT(sphere.unidentified, HasSubstr("no Young's modulus of body 2"));
}

TEST(SphereUnderLoad, HasItsComplianceFromRadiiAndOnePoissonRatioWhateverTheModuli) {
  for (const double poisson_ratio : {-0.5, 0.0, 0.3, 0.5}) {
    for (const double ratio : {1e-4, 1.0, 30.0}) {
      const Body first{210e9, poisson_ratio, 0.05};
      const Body second{210e9 * ratio, poisson_ratio, 0.3};
      const Truth truth = Make(first, second);
      KnownContact known = Known(first, second);
      known.body_1.youngs_modulus.reset();
      known.body_2.youngs_modulus.reset();
      const ShapeUnderLoad sphere = IdentifyShape(ContactShape::kSphere, truth.stiffness, known);
      ExpectNear(sphere.tangential_compliance, truth.compliance);
      ExpectNear(sphere.effective_modulus, truth.effective_modulus);
      ExpectNear(sphere.contact_radius, truth.contact_radius);
    }
  }
}

TEST(SphereUnderLoad, HasItsEffectiveModulusFromRadiiAndAGivenCompliance) {
  const Truth truth = Make(kSteelBall, kGlassSeat);
  KnownContact known = Known(kSteelBall, kGlassSeat);
  known.body_1.youngs_modulus.reset();
  known.tangential_compliance = truth.compliance;
  const ShapeUnderLoad sphere = IdentifyShape(ContactShape::kSphere, truth.stiffness, known);
  ExpectNear(sphere.effective_modulus, truth.effective_modulus);
  ExpectNear(sphere.contact_radius, truth.contact_radius);
}

TEST(SphereUnderLoad, NamesMissingInputs) {
  const auto missing = [](const KnownContact& known) {
    return IdentifyShape(ContactShape::kSphere, 4e7, known).unidentified;
  };
  EXPECT_EQ(
      missing({.normal_load = kLoad}),
      "the equivalent radius needs E and ν of both bodies; the tangential compliance needs the "
      "radii of both bodies, one Poisson ratio for both bodies (or E of one and ν of both)");
  KnownContact known = Known(kSteelBall, kGlassSeat);  // two Poisson ratios
  known.body_1.youngs_modulus.reset();
  known.body_2.youngs_modulus.reset();
  EXPECT_THAT(missing(known), HasSubstr("the tangential compliance needs one Poisson ratio"));
  EXPECT_THAT(missing({.normal_load = kLoad, .tangential_compliance = 4e-11}),
              HasSubstr("the effective modulus needs the radii of both bodies"));
}

// All that is known of the materials is that both have one ν: the larger of its two errors is
// carried, whichever body has it, as if both changed together.
TEST(ShapeUnderLoad, PropagatesTheLargerErrorOfACommonPoissonRatio) {
  constexpr double kStep = 1e-4;
  constexpr double kTolerance = 1e-6;
  const Truth truth = Make(kSteelBall, kSteelBall);
  KnownContact known = Known(kSteelBall, kSteelBall);
  known.body_1.youngs_modulus.reset();
  known.body_2.youngs_modulus.reset();
  const double nu = known.body_1.poisson_ratio->value;
  const auto with = [&](UncertainValue first, UncertainValue second) {
    known.body_1.poisson_ratio = first;
    known.body_2.poisson_ratio = second;
    return IdentifyShape(ContactShape::kSphere, truth.stiffness, known);
  };
  using Part = std::optional<PropagatedValue> ShapeUnderLoad::*;
  const double more = nu * (1 + kStep);
  const double less = nu * (1 - kStep);
  for (const Part part : {&ShapeUnderLoad::tangential_compliance,
                          &ShapeUnderLoad::effective_modulus, &ShapeUnderLoad::contact_radius}) {
    const double change =
        std::abs(((with(more, more).*part)->value - (with(less, less).*part)->value)) / 2;
    ASSERT_GT(change, 0.0);
    for (const bool first_is_larger : {true, false}) {
      const UncertainValue larger{nu, kStep * nu};
      const UncertainValue smaller{nu, kStep * nu / 3};
      const ShapeUnderLoad shape = first_is_larger ? with(larger, smaller) : with(smaller, larger);
      EXPECT_NEAR((shape.*part)->standard_error / change, 1.0, kTolerance);
    }
  }
}

TEST(ShapeUnderLoad, PropagatesEveryInputAsASmallChangeOfItActs) {
  // A central difference of relative step h is off by h² times a third derivative of order 10, and
  // by rounding over h.
  constexpr double kStep = 1e-4;
  constexpr double kTolerance = 1e-6;
  const Truth truth = Make(kSteelBall, kGlassSeat);
  using Input = std::optional<UncertainValue>* (*)(KnownContact&);
  constexpr std::array<Input, 8> kInputs = {
      [](KnownContact& known) { return &known.normal_load; },
      [](KnownContact& known) { return &known.body_1.youngs_modulus; },
      [](KnownContact& known) { return &known.body_1.poisson_ratio; },
      [](KnownContact& known) { return &known.body_1.radius; },
      [](KnownContact& known) { return &known.body_2.youngs_modulus; },
      [](KnownContact& known) { return &known.body_2.poisson_ratio; },
      [](KnownContact& known) { return &known.body_2.radius; },
      [](KnownContact& known) { return &known.tangential_compliance; },
  };
  using Part = std::optional<PropagatedValue> ShapeUnderLoad::*;
  constexpr std::array<Part, 7> kParts = {
      &ShapeUnderLoad::contact_radius,        &ShapeUnderLoad::equivalent_radius,
      &ShapeUnderLoad::tangential_compliance, &ShapeUnderLoad::effective_modulus,
      &ShapeUnderLoad::youngs_modulus,        &ShapeUnderLoad::slope,
      &ShapeUnderLoad::load_over_stiffness};
  KnownContact no_radius = Known(kSteelBall, kGlassSeat);
  no_radius.body_2.radius.reset();
  KnownContact no_modulus = Known(kSteelBall, kGlassSeat);
  no_modulus.body_2.youngs_modulus.reset();
  KnownContact given_compliance = no_modulus;
  given_compliance.tangential_compliance = truth.compliance;
  for (const ContactShape shape : {ContactShape::kSphere, ContactShape::kCone,
                                   ContactShape::kFlatPunch, ContactShape::kRough}) {
    for (const KnownContact& known : {no_radius, no_modulus, given_compliance}) {
      for (const Input input : kInputs) {
        KnownContact uncertain = known;
        std::optional<UncertainValue>& value = *input(uncertain);
        if (!value) continue;
        const double exact = value->value;
        value->standard_error = kStep * std::abs(exact);
        const ShapeUnderLoad answer = IdentifyShape(shape, truth.stiffness, uncertain);
        value = exact * (1 + kStep);
        const ShapeUnderLoad more = IdentifyShape(shape, truth.stiffness, uncertain);
        value = exact * (1 - kStep);
        const ShapeUnderLoad less = IdentifyShape(shape, truth.stiffness, uncertain);
        for (const Part part : kParts) {
          if (!(answer.*part)) continue;
          const double change = ((more.*part)->value - (less.*part)->value) / 2;
          const PropagatedValue& estimate = *(answer.*part);
          EXPECT_NEAR(estimate.input_error / (kStep * estimate.value),
                      std::abs(change) / (kStep * estimate.value), kTolerance);
          EXPECT_EQ(estimate.fit_error, 0.0);
        }
      }
    }
  }
}

TEST(ShapeUnderLoad, PropagatesTheFit) {
  constexpr double kRelative = 1e-3;
  const Truth truth = Make(kSteelBall, kGlassSeat);
  const UncertainValue stiffness{truth.stiffness, kRelative * truth.stiffness};
  KnownContact known = Known(kSteelBall, kGlassSeat);
  const auto power = [&](const std::optional<PropagatedValue>& value) {
    return value->fit_error / value->value / kRelative;
  };
  EXPECT_NEAR(power(IdentifyShape(ContactShape::kSphere, stiffness, known).equivalent_radius), 3,
              kRounding / kRelative);
  EXPECT_NEAR(power(IdentifyShape(ContactShape::kCone, stiffness, known).slope), 2,
              kRounding / kRelative);
  EXPECT_NEAR(power(IdentifyShape(ContactShape::kRough, stiffness, known).load_over_stiffness), 1,
              kRounding / kRelative);
  known.body_1.youngs_modulus.reset();
  known.body_2.youngs_modulus.reset();
  known.body_2.poisson_ratio = known.body_1.poisson_ratio;
  EXPECT_NEAR(power(IdentifyShape(ContactShape::kSphere, stiffness, known).tangential_compliance),
              1.5, kRounding / kRelative);
}

TEST(ShapeUnderLoad, PropagatesTheFitToTheModulusOfOneBodyAndWhatFollowsFromIt) {
  // ln σ = −ln E*/3 − ln G* + …: with d ln E* = w·e and d ln G* = −v·e, the body's fractions of the
  // compliances 1/E* and G*, one per cent of σ is e = 1/(v − w/3) of E; and a = σG*/8.
  constexpr double kRelative = 1e-3;
  const Truth truth = Make(kSteelBall, kGlassSeat);
  const auto of_normal = [](const Body& body) {
    return (1 - body.poisson_ratio * body.poisson_ratio) / body.youngs_modulus;
  };
  const auto of_tangential = [](const Body& body) {
    return (2 - body.poisson_ratio) / ShearModulus(body);
  };
  const double w = of_normal(kGlassSeat) * truth.effective_modulus;
  const double v = of_tangential(kGlassSeat) / truth.compliance;
  const double e = 1 / (v - w / 3);
  KnownContact known = Known(kSteelBall, kGlassSeat);
  known.body_2.youngs_modulus.reset();
  const ShapeUnderLoad sphere =
      IdentifyShape(ContactShape::kSphere, {truth.stiffness, kRelative * truth.stiffness}, known);
  const auto power = [&](const std::optional<PropagatedValue>& value) {
    return value->fit_error / value->value / kRelative;
  };
  EXPECT_NEAR(power(sphere.youngs_modulus), e, kRounding / kRelative);
  EXPECT_NEAR(power(sphere.tangential_compliance), v * e, kRounding / kRelative);
  EXPECT_NEAR(power(sphere.effective_modulus), w * e, kRounding / kRelative);
  EXPECT_NEAR(power(sphere.contact_radius), std::abs(1 - v * e), kRounding / kRelative);
}

TEST(ShapeUnderLoad, LeavesOpenIntervalsOfTheFitOpen) {
  const KnownContact known = Known(kSteelBall, kGlassSeat);
  const UncertainValue open{4e7, std::numeric_limits<double>::infinity()};
  EXPECT_TRUE(std::isinf(
      IdentifyShape(ContactShape::kSphere, open, known).equivalent_radius->standard_error));
}

TEST(ConeUnderLoad, CarriesSneddonsLoad) {
  // N = (π/2)·E*a²·tan θ
  constexpr double kSlope = 0.02;
  KnownContact known = Known(kSteelBall, kGlassSeat);
  const double effective_modulus = EffectiveModulus(kSteelBall, kGlassSeat);
  const double radius = std::sqrt(kLoad / (M_PI / 2 * effective_modulus * kSlope));
  const double stiffness =
      MindlinTangentialStiffness(radius, TangentialCompliance(kSteelBall, kGlassSeat));
  const ShapeUnderLoad cone = IdentifyShape(ContactShape::kCone, stiffness, known);
  ExpectNear(cone.slope, kSlope);
  ExpectNear(cone.contact_radius, radius);
  known.body_1.poisson_ratio.reset();
  EXPECT_EQ(IdentifyShape(ContactShape::kCone, stiffness, known).unidentified,
            "the slope of the cone needs the Poisson ratio of body 1");
}

TEST(FlatPunchUnderLoad, HasTheRadiusOfItsStiffness) {
  const Truth truth = Make(kSteelBall, kGlassSeat);
  ExpectNear(IdentifyShape(ContactShape::kFlatPunch, truth.stiffness,
                           {.normal_load = kLoad, .tangential_compliance = truth.compliance})
                 .contact_radius,
             truth.contact_radius);
  EXPECT_THAT(
      IdentifyShape(ContactShape::kFlatPunch, truth.stiffness, {.normal_load = kLoad}).unidentified,
      HasSubstr("the radius of the punch needs the tangential compliance"));
}

TEST(RoughSurfacesUnderLoad, HaveALengthAndNoRadius) {
  const ShapeUnderLoad rough =
      IdentifyShape(ContactShape::kRough, 4e7, Known(kSteelBall, kGlassSeat));
  ExpectNear(rough.load_over_stiffness, kLoad / 4e7);
  EXPECT_FALSE(rough.contact_radius);
}

TEST(ShapeUnderLoad, RefusesInvalidStiffnessAndMissingLoad) {
  const auto message = [](double stiffness, const KnownContact& known) {
    return MessageOf([&] { IdentifyShape(ContactShape::kSphere, stiffness, known); });
  };
  EXPECT_THAT(message(-1, {.normal_load = kLoad}), HasSubstr("tangential stiffness [N/m] = -1"));
  EXPECT_THAT(message(4e7, {}), HasSubstr("normal load"));
  EXPECT_THAT(message(4e7, {.normal_load = kLoad, .body_1 = {.poisson_ratio = 0.7}}),
              HasSubstr("Poisson ratio of body 1"));
}

}  // namespace
}  // namespace mindahl::contact::shape_under_load_test
