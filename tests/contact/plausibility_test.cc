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

TEST(Doubts, AreOfAModulusThatIsNotInPascalOrStifferThanAnySolid) {
  const auto doubts = [](double modulus_1, double modulus_2) {
    return DoubtsAbout({.body_1 = {.youngs_modulus = modulus_1, .poisson_ratio = 0.3},
                        .body_2 = {.youngs_modulus = modulus_2, .poisson_ratio = 0.3}},
                       0.3);
  };
  EXPECT_THAT(doubts(210, 1e6),  // GPa; rubber, at the limit
              ElementsAre(HasSubstr("Young's modulus of body 1 = 210 Pa is below 1 MPa")));
  EXPECT_THAT(doubts(1.2e12, 210e12),  // diamond; in GPa, and then once more
              ElementsAre(HasSubstr("Young's modulus of body 2 = 2.1e+14 Pa is above 2 TPa")));
}

TEST(Doubts, AreOfAComplianceThatIsAModulus) {
  const KnownContact known{.contact_radius = 2e-4, .tangential_compliance = 2.5e10};
  EXPECT_THAT(DoubtsAbout(known, 0.3), ElementsAre(HasSubstr("give 4e-11 if so")));
}

TEST(Doubts, AreOfAContactAsLargeAsTheSmallerOfItsBodies) {
  KnownContact known = SteelContact();
  known.normal_load = 50e9;
  EXPECT_THAT(DoubtsAbout(known, 0.3), ElementsAre(HasSubstr("is more than a third")))
      << "by Hertz's radius";
  known.normal_load = std::nullopt;
  known.contact_radius = 0.017;
  EXPECT_THAT(DoubtsAbout(known, 0.3), ElementsAre(HasSubstr("a = 0.017 m is more than a third")));
  known.contact_radius = 0.016;
  EXPECT_THAT(DoubtsAbout(known, 0.3), IsEmpty());
  EXPECT_THAT(DoubtsAbout(known, 0.3, 0.02), ElementsAre(HasSubstr("a = 0.02 m is more")));
  for (const double radius : {0.014, -0.014}) {  // a ball, a seat
    known.body_2.radius = radius;
    EXPECT_THAT(DoubtsAbout(known, 0.3), ElementsAre(HasSubstr("the radius 0.014 m of a body")));
  }
}

TEST(Doubts, AreOfAFrictionBeyondWhatSlides) {
  EXPECT_THAT(DoubtsAbout({}, 5.0), IsEmpty());
  EXPECT_THAT(DoubtsAbout({}, 6.0), ElementsAre(HasSubstr("mu = 6 is above 5")));
}

}  // namespace
}  // namespace mindahl::contact::plausibility_test
