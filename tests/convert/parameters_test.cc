

#include "mindahl/convert/conversion.h"
#include "mindahl/models/friction_model.h"
#include "support/prelude.h"

namespace mindahl::convert::parameters_test {
namespace {

Conversion To(Target target) {
  return Convert({models::FindFrictionModel("mindlin-dahl"),
                  {.tangential_stiffness = 4e7, .slip_force = 40.0}},
                 target, {.amplitude = 1.2e-6});
}

TEST(Parameters, OfMasingsLawAreItsOwn) {
  const std::vector<Parameter> parameters = ParametersOf(To(Target::kMasing), Target::kMasing);
  ASSERT_EQ(parameters.size(), 3U);
  EXPECT_EQ(parameters[0].name, "sigma");
  EXPECT_EQ(parameters[0].value, 4e7);
  EXPECT_EQ(parameters[2].value, 40.0);
}

TEST(Parameters, HaveAFrictionCoefficientWhereTheLoadIsKnown) {
  const Conversion conversion = To(Target::kLammps);
  EXPECT_EQ(ParametersOf(conversion, Target::kLammps).size(), 2U);
  const std::vector<Parameter> parameters =
      ParametersOf(conversion, Target::kLammps, {.normal_load = 100.0});
  ASSERT_EQ(parameters.size(), 3U);
  EXPECT_EQ(parameters[2].name, "mu");
  EXPECT_EQ(parameters[2].value, parameters[1].value / 100.0);
}

TEST(Parameters, OfAMujocoActuatorHaveItsKneeWhereStiffnessReachesCoulombsForce) {
  const std::vector<Parameter> parameters = ParametersOf(To(Target::kMujoco), Target::kMujoco);
  ASSERT_GE(parameters.size(), 3U);
  EXPECT_EQ(parameters[2].name, "knee");
  EXPECT_EQ(parameters[2].value, parameters[1].value / parameters[0].value);
}

TEST(Parameters, OfBoucAndWenShareTheExponentsUnitBetweenBetaAndGamma) {
  const Conversion conversion =
      Convert({models::FindFrictionModel("mindlin-dahl"),
               {.tangential_stiffness = 4e7, .shape_exponent = 1.0 / 3, .slip_force = 40.0}},
              Target::kBoucWen, {.amplitude = 1.2e-6, .beta = 0.2});
  const std::vector<Parameter> parameters = ParametersOf(conversion, Target::kBoucWen);
  ASSERT_EQ(parameters.size(), 6U);
  EXPECT_EQ(parameters[3].name, "beta");
  EXPECT_EQ(parameters[4].name, "gamma");
  EXPECT_NEAR(parameters[4].value / parameters[3].value, 4.0, 1e-14 * 4);
}

TEST(InputLines, OfLammpsNeedANormalLoad) {
  const Conversion conversion = To(Target::kLammps);
  EXPECT_THROW(InputLines(conversion, Target::kLammps), InputError);
  EXPECT_EQ(InputLines(conversion, Target::kLammps, {.normal_load = 100.0}).size(), 2U);
}

TEST(InputLines, OfYadeHaveTheAngleOfFriction) {
  const Conversion conversion = To(Target::kYade);
  const std::vector<Parameter> parameters =
      ParametersOf(conversion, Target::kYade, {.normal_load = 100.0});
  ASSERT_EQ(parameters.size(), 4U);
  EXPECT_EQ(parameters[0].name, "ks");
  EXPECT_NEAR(std::tan(parameters[3].value), parameters[1].value / 100.0, 1e-15);
  EXPECT_EQ(InputLines(conversion, Target::kYade, {.normal_load = 100.0}).size(), 2U);
}

TEST(InputLines, OfLiggghtsAreItsPairStyleAndItsProperties) {
  const Conversion conversion = To(Target::kLiggghts);
  EXPECT_THROW(InputLines(conversion, Target::kLiggghts), InputError);
  EXPECT_EQ(InputLines(conversion, Target::kLiggghts, {.normal_load = 100.0}).size(), 5U);
  EXPECT_THROW(Validate({.contact_radius = 1e-4}, Target::kLiggghts), InputError);
}

TEST(InputLines, OfJointsHaveTheirDamping) {
  for (const Target target :
       {Target::kLuGre, Target::kMujoco, Target::kMujocoJoint, Target::kUrdf, Target::kSdf}) {
    const Conversion conversion = To(target);
    EXPECT_NO_THROW(Validate({.viscous = 3.0}, target));
    EXPECT_THROW(Validate({.viscous = -3.0}, target), InvalidArgument);
    double viscous = 0.0;
    for (const Parameter& parameter : ParametersOf(conversion, target, {.viscous = 3.0})) {
      if (parameter.unit == "N s/m") viscous += parameter.value;
    }
    EXPECT_EQ(viscous, 3.0);
    EXPECT_NE(InputLines(conversion, target, {.viscous = 3.0}), InputLines(conversion, target));
  }
  EXPECT_THROW(Validate({.viscous = 3.0}, Target::kIwan), InputError);
}

TEST(NormalContact, IsOfDiscreteElementCodesAlone) {
  EXPECT_THROW(Validate({.normal_load = 100.0}, Target::kDahl), InputError);
  EXPECT_THROW(Validate({.normal_load = -1.0}, Target::kLammps), InvalidArgument);
  EXPECT_NO_THROW(Validate({.normal_load = 100.0, .contact_radius = 1e-4}, Target::kLammps));
}

}  // namespace
}  // namespace mindahl::convert::parameters_test
