#include "mindahl/models/branch_law.h"

#include "mindahl/models/friction_model.h"
#include "mindahl/models/simplified_law.h"
#include "support/prelude.h"

namespace mindahl::models::branch_law_test {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// A handful of roundings in the test's own closed form.
constexpr double kClosedForm = 1e-15;

TEST(BranchLaw, WithOneIsExponential) {
  const BranchLaw law{2.0, 1.0, 3.0};
  const double remaining = std::exp(-0.8);
  EXPECT_NEAR(BackboneRemaining(law, 1.2), remaining, kClosedForm);
  EXPECT_NEAR(BackboneForce(law, 1.2), 3.0 * (1 - remaining), 3 * kClosedForm);
}

TEST(BranchLaw, ForceIsOdd) {
  const BranchLaw law{4.839e8, 0.4, 30.0};
  EXPECT_EQ(BackboneForce(law, -3e-8), -BackboneForce(law, 3e-8));
}

TEST(BranchLaw, IsExactAtAndBeyondSlip) {
  const BranchLaw law{1.0, 0.5, 1.0};  // δc = 2
  EXPECT_EQ(GrossSlipDisplacement(law), 2.0);
  for (const double x : {2.0, std::nextafter(2.0, 3.0), 5.0, 1e300, kInfinity}) {
    EXPECT_EQ(BackboneForce(law, x), 1.0) << x;
    EXPECT_EQ(BackboneRemaining(law, x), 0.0) << x;
  }
  // An ulp below, z = 2⁻⁵³ and u = z² — not what 1 − f would give.
  EXPECT_EQ(BackboneRemaining(law, std::nextafter(2.0, 0.0)), 0x1p-106);
}

TEST(BranchLaw, NeverSlipsFullyFromOneOn) {
  EXPECT_EQ(GrossSlipDisplacement({1.0, 1.0, 1.0}), kInfinity);
  EXPECT_EQ(GrossSlipDisplacement({1.0, 3.0, 1.0}), kInfinity);
  EXPECT_GT(BackboneRemaining({1.0, 3.0, 1.0}, 1e12), 0.0);
}

TEST(BranchLaw, ValidationNamesParameterUnitValueAndRule) {
  const auto message = [](const BranchLaw& law) -> std::string {
    return MessageOf([&] { Validate(law); });
  };
  EXPECT_EQ(message({1.0, 0.5, 1.0}), "");
  EXPECT_EQ(message({0.0, 0.5, 1.0}),
            "tangential stiffness [N/m] = 0 is invalid: must be finite and > 0");
  EXPECT_EQ(message({1.0, 0.5, -3.0}), "slip force [N] = -3 is invalid: must be finite and > 0");
  EXPECT_EQ(message({1.0, -0.1, 1.0}),
            "shape exponent [-] = -0.1 is invalid: must be finite and >= 0");
  EXPECT_EQ(message({1.0, 101, 1.0}), "shape exponent [-] = 101 is invalid: must be <= 100");
  EXPECT_THAT(message({1e300, 0.5, 1e-300}), HasSubstr("stiffness over slip force [1/m]"));
  EXPECT_NE(message({1.0, std::nan(""), 1.0}), "");
}

constexpr BranchLaw kLaw{.tangential_stiffness = 4.0, .slip_force = 3.0};

std::vector<double> Simplified(const std::vector<double>& displacement,
                               const std::vector<double>& envelope = {}) {
  std::vector<double> force(displacement.size());
  EvaluateSimplifiedDahl(kLaw, displacement, envelope, force);
  return force;
}

TEST(SimplifiedLaw, FollowsAnEnvelopeAsItFollowsTheLargestDisplacement) {
  // Eq. 27 step by step and by the closed form of a branch: equal to a rounding a step.
  const std::vector<double> history = {0.2, 0.7, 1.1, 0.4, -0.9, -1.1, 0.1, 0.8, 1.1, -0.3};
  const std::vector<double> constant(history.size(), 1.1);
  const std::vector<double> stepped = Simplified(history, constant);
  const std::vector<double> whole = Simplified(history);
  for (std::size_t i = 0; i < history.size(); ++i) {
    EXPECT_NEAR(stepped[i], whole[i], 1e-14 * kLaw.slip_force) << i;
  }
  std::vector<double> growing = constant;
  for (double& amplitude : growing) amplitude *= 2;
  EXPECT_LT(Simplified(history, growing)[0],
            whole[0]);  // the branch of a wider loop is softer at T = 0
}

TEST(SimplifiedLaw, RefusesWhatItCannotServe) {
  std::vector<double> force(2);
  const std::vector<double> three = {0, 1, 2};
  const std::vector<double> not_finite = {0, std::numeric_limits<double>::infinity()};
  const auto refusal = [&](const BranchLaw& law, const std::vector<double>& displacement) {
    return MessageOf([&] { EvaluateSimplifiedDahl(law, displacement, {}, force); });
  };
  EXPECT_THAT(refusal(kLaw, three), HasSubstr("displacement"));
  EXPECT_THAT(refusal(kLaw, not_finite), HasSubstr("displacement [m] of sample 1"));
  EXPECT_THAT(refusal({.tangential_stiffness = 1, .slip_force = -1}, {0, 1}),
              HasSubstr("slip force [N]"));
}

// ---

TEST(FrictionModels, AreFoundByTheNamesOfTheCommandLine) {
  for (const std::string_view name : {"mindlin-dahl", "mindlin", "jenkins", "dahl"}) {
    const FrictionModel* model = FindFrictionModel(name);
    ASSERT_NE(model, nullptr) << name;
    EXPECT_EQ(model->name, name);
  }
  EXPECT_EQ(FindFrictionModel("Mindlin"), nullptr);
  EXPECT_EQ(FindFrictionModel(""), nullptr);
}

TEST(FrictionModels, PrescribeTheShapeExponentWhereTheNameDoes) {
  EXPECT_EQ(FindFrictionModel("mindlin")->shape_exponent, 1.0 / 3.0);
  EXPECT_EQ(FindFrictionModel("jenkins")->shape_exponent, 0.0);
  EXPECT_FALSE(FindFrictionModel("mindlin-dahl")->shape_exponent.has_value());
  EXPECT_FALSE(FindFrictionModel("dahl")->shape_exponent.has_value());
}

}  // namespace
}  // namespace mindahl::models::branch_law_test
