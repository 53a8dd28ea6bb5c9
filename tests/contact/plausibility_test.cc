

#include "mindahl/contact/mindlin_dahl_mapping.h"
#include "support/prelude.h"

namespace mindahl::contact::plausibility_test {
namespace {

const KnownBody kSteelSphere{.youngs_modulus = 210e9, .poisson_ratio = 0.3, .radius = 0.05};
const KnownBody kSteelPlane{.youngs_modulus = 210e9,
                            .poisson_ratio = 0.3,
                            .radius = std::numeric_limits<double>::infinity()};

KnownContact SteelContact() {
  return {.normal_load = 50, .body_1 = kSteelSphere, .body_2 = kSteelPlane};
}

TEST(Doubts, AreNoneOfAnOrdinaryContact) {
  EXPECT_THAT(DoubtsAbout(SteelContact(), 0.3), IsEmpty());
  EXPECT_THAT(DoubtsAbout({.contact_radius = 2e-4, .tangential_compliance = 4e-11}, 1.2),
              IsEmpty());
  EXPECT_THAT(DoubtsAbout({}, std::nullopt), IsEmpty());
}

TEST(Doubts, AreOfAModulusThatIsNotInPascal) {
  KnownContact known = SteelContact();
  known.body_1.youngs_modulus = 210;  // GPa
  known.body_2.youngs_modulus = 1e6;  // rubber: at the limit
  known.normal_load = std::nullopt;
  EXPECT_THAT(DoubtsAbout(known, 0.3),
              ElementsAre(HasSubstr("Young's modulus of body 1 = 210 Pa is below 1 MPa")));
}

TEST(Doubts, AreOfAModulusStifferThanAnySolid) {
  KnownContact known = SteelContact();
  known.normal_load = std::nullopt;
  known.body_1.youngs_modulus = 210e12;  // in GPa, and then once more
  known.body_2.youngs_modulus = 1.2e12;  // diamond
  EXPECT_THAT(DoubtsAbout(known, 0.3),
              ElementsAre(HasSubstr("Young's modulus of body 1 = 2.1e+14 Pa is above 2 TPa")));
}

TEST(Doubts, AreOfAComplianceThatIsAModulus) {
  const KnownContact known{.contact_radius = 2e-4, .tangential_compliance = 2.5e10};
  EXPECT_THAT(DoubtsAbout(known, 0.3), ElementsAre(HasSubstr("give 4e-11 if so")));
}

TEST(Doubts, AreOfAContactAsLargeAsItsBody) {
  KnownContact known = SteelContact();
  known.normal_load = std::nullopt;
  known.contact_radius = 0.017;
  EXPECT_THAT(DoubtsAbout(known, 0.3), ElementsAre(HasSubstr("a = 0.017 m is more than a third")));
  known.contact_radius = 0.016;
  EXPECT_THAT(DoubtsAbout(known, 0.3), IsEmpty());
  EXPECT_THAT(DoubtsAbout(known, 0.3, 0.02), ElementsAre(HasSubstr("a = 0.02 m is more")));
  known = SteelContact();
  known.normal_load = 50e9;
  EXPECT_THAT(DoubtsAbout(known, 0.3), ElementsAre(HasSubstr("is more than a third")))
      << "by Hertz's radius";
}

TEST(Doubts, AreOfAContactAsLargeAsTheSmallerOfTwoBodies) {
  KnownContact known = SteelContact();
  known.normal_load = std::nullopt;
  known.contact_radius = 0.005;
  known.body_2.radius = 0.014;
  EXPECT_THAT(DoubtsAbout(known, 0.3), ElementsAre(HasSubstr("the radius 0.014 m of a body")));
  known.body_2.radius = -0.014;  // a seat
  EXPECT_THAT(DoubtsAbout(known, 0.3), ElementsAre(HasSubstr("the radius 0.014 m of a body")));
}

TEST(Doubts, AreOfAFrictionBeyondWhatSlides) {
  EXPECT_THAT(DoubtsAbout({}, 5.0), IsEmpty());
  EXPECT_THAT(DoubtsAbout({}, 6.0), ElementsAre(HasSubstr("mu = 6 is above 5")));
}

}  // namespace
}  // namespace mindahl::contact::plausibility_test
