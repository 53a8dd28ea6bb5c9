#include "mindahl/models/branch_law.h"
#include "support/prelude.h"

namespace mindahl::models::limit_law_test {
namespace {

constexpr BranchLaw kLaw{.tangential_stiffness = 4.0, .slip_force = 3.0};

std::vector<double> Respond(std::string_view name, const std::vector<double>& displacement) {
  std::vector<double> force(displacement.size());
  FindLimitLaw(name)->evaluate_force(kLaw, displacement, force);
  return force;
}

TEST(LimitLaw, SpringIsProportionalAndNotBounded) {
  EXPECT_EQ(Respond("spring", {0, 0.5, -0.25, 100}), (std::vector<double>{0, 2, -1, 400}));
}

TEST(LimitLaw, CoulombOpposesTheMotionAndHoldsAtRest) {
  EXPECT_EQ(Respond("coulomb", {0, 0, 1e-300, 1e-300, 0, 0, -1, -0.5}),
            (std::vector<double>{0, 0, 3, 3, -3, -3, -3, 3}));
}

TEST(LimitLaw, TravelFromReferencePositionToFirstSampleIsAMotion) {
  EXPECT_EQ(Respond("coulomb", {-1, -1}), (std::vector<double>{-3, -3}));
}

TEST(LimitLaw, IsFoundByItsNameOnly) {
  ASSERT_EQ(LimitLaws().size(), 2U);
  for (const LimitLaw& law : LimitLaws()) EXPECT_EQ(FindLimitLaw(law.name), &law);
  EXPECT_EQ(FindLimitLaw("Spring"), nullptr);
  EXPECT_EQ(FindLimitLaw(""), nullptr);
}

TEST(LimitLaw, RefusesWhatItCannotServe) {
  std::vector<double> force(2);
  const std::vector<double> three = {0, 1, 2};
  const std::vector<double> not_finite = {0, std::numeric_limits<double>::infinity()};
  for (const LimitLaw& law : LimitLaws()) {
    EXPECT_THAT(MessageOf([&] { law.evaluate_force(kLaw, three, force); }),
                HasSubstr("displacement"));
    EXPECT_THAT(MessageOf([&] { law.evaluate_force(kLaw, not_finite, force); }),
                HasSubstr("displacement [m] of sample 1"));
    EXPECT_THAT(MessageOf([&] {
                  law.evaluate_force({.tangential_stiffness = 1, .slip_force = -1}, force, force);
                }),
                HasSubstr("slip force [N]"));
  }
  const std::vector<double> far = {0, 1e308};
  const std::vector<double> far_and_back = {1e308, 0};
  EXPECT_THAT(MessageOf([&] { FindLimitLaw("spring")->evaluate_force(kLaw, far_and_back, force); }),
              HasSubstr("exceeds the largest double"));
  EXPECT_THAT(MessageOf([&] { FindLimitLaw("spring")->evaluate_force(kLaw, far, force); }),
              HasSubstr("exceeds the largest double"));
  EXPECT_EQ(MessageOf([&] { FindLimitLaw("coulomb")->evaluate_force(kLaw, far, force); }), "");
}

}  // namespace
}  // namespace mindahl::models::limit_law_test
