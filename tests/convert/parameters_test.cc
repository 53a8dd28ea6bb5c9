#include "mindahl/convert/conversion.h"
#include "mindahl/models/friction_model.h"
#include "support/prelude.h"

namespace mindahl::convert::parameters_test {
namespace {

const TargetRow& Target(std::string_view name) {
  return *std::ranges::find(Targets(), name, &TargetRow::name);
}

Conversion To(const TargetRow& target) {
  return Convert({models::FindFrictionModel("mindlin-dahl"),
                  {.tangential_stiffness = 4e7, .slip_force = 40.0}},
                 target, {.amplitude = 1.2e-6});
}

TEST(Parameters, OfMasingsLawAreItsOwn) {
  const std::vector<Parameter> parameters = ParametersOf(To(Target("masing")), Target("masing"));
  ASSERT_EQ(parameters.size(), 3U);
  EXPECT_EQ(parameters[0].name, "sigma");
  EXPECT_EQ(parameters[0].value, 4e7);
  EXPECT_EQ(parameters[2].value, 40.0);
}

TEST(Parameters, HaveAFrictionCoefficientWhereTheLoadIsKnown) {
  const Conversion conversion = To(Target("lammps"));
  EXPECT_EQ(ParametersOf(conversion, Target("lammps")).size(), 2U);
  const std::vector<Parameter> parameters =
      ParametersOf(conversion, Target("lammps"), {.normal_load = 100.0});
  ASSERT_EQ(parameters.size(), 3U);
  EXPECT_EQ(parameters[2].name, "mu");
  EXPECT_EQ(parameters[2].value, parameters[1].value / 100.0);
}

TEST(Parameters, OfAMujocoActuatorHaveItsKneeWhereStiffnessReachesCoulombsForce) {
  const std::vector<Parameter> parameters = ParametersOf(To(Target("mujoco")), Target("mujoco"));
  ASSERT_GE(parameters.size(), 3U);
  EXPECT_EQ(parameters[2].name, "knee");
  EXPECT_EQ(parameters[2].value, parameters[1].value / parameters[0].value);
}

TEST(Parameters, OfBoucAndWenShareTheExponentsUnitBetweenBetaAndGamma) {
  const Conversion conversion =
      Convert({models::FindFrictionModel("mindlin-dahl"),
               {.tangential_stiffness = 4e7, .shape_exponent = 1.0 / 3, .slip_force = 40.0}},
              Target("bouc-wen"), {.amplitude = 1.2e-6, .beta = 0.2});
  const std::vector<Parameter> parameters = ParametersOf(conversion, Target("bouc-wen"));
  ASSERT_EQ(parameters.size(), 6U);
  EXPECT_EQ(parameters[3].name, "beta");
  EXPECT_EQ(parameters[4].name, "gamma");
  EXPECT_NEAR(parameters[4].value / parameters[3].value, 4.0, 1e-14 * 4);
}

TEST(InputLines, OfLammpsNeedANormalLoad) {
  const Conversion conversion = To(Target("lammps"));
  EXPECT_THROW(InputLines(conversion, Target("lammps")), InputError);
  EXPECT_EQ(InputLines(conversion, Target("lammps"), {.normal_load = 100.0}).size(), 2U);
}

TEST(InputLines, OfYadeHaveTheAngleOfFriction) {
  const Conversion conversion = To(Target("yade"));
  const std::vector<Parameter> parameters =
      ParametersOf(conversion, Target("yade"), {.normal_load = 100.0});
  ASSERT_EQ(parameters.size(), 4U);
  EXPECT_EQ(parameters[0].name, "ks");
  EXPECT_NEAR(std::tan(parameters[3].value), parameters[1].value / 100.0, 1e-15);
  EXPECT_EQ(InputLines(conversion, Target("yade"), {.normal_load = 100.0}).size(), 2U);
}

TEST(InputLines, OfLiggghtsAreItsPairStyleAndItsProperties) {
  const Conversion conversion = To(Target("liggghts"));
  EXPECT_THROW(InputLines(conversion, Target("liggghts")), InputError);
  EXPECT_EQ(InputLines(conversion, Target("liggghts"), {.normal_load = 100.0}).size(), 5U);
  EXPECT_THROW(Validate({.contact_radius = 1e-4}, Target("liggghts")), InputError);
}

TEST(InputLines, OfJointsHaveTheirDamping) {
  for (const char* name : {"lugre", "mujoco", "mujoco-joint", "urdf", "sdf"}) {
    const TargetRow& target = Target(name);
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
  EXPECT_THROW(Validate({.viscous = 3.0}, Target("iwan")), InputError);
}

TEST(InputLines, BeginWithARemarkWhereTheTargetHasComments) {
  for (const TargetRow& target : Targets()) {
    const Conversion conversion = To(target);
    const std::vector<std::string> plain =
        InputLines(conversion, target, {.normal_load = 100.0, .contact_radius = 1e-3});
    const std::vector<std::string> remarked = InputLines(
        conversion, target, {.normal_load = 100.0, .contact_radius = 1e-3}, "off by 5 %");
    if (target.form == Form::kMasing || target.form == Form::kDahl) {
      EXPECT_EQ(remarked, plain) << target.name;  // options of simulate
      continue;
    }
    ASSERT_EQ(remarked.size(), plain.size() + 1) << target.name;
    EXPECT_THAT(remarked[0], ::testing::AnyOf(::testing::StrEq("# off by 5 %"),
                                              ::testing::StrEq("<!-- off by 5 % -->")));
    for (const std::string& line : plain) EXPECT_THAT(line, ::testing::Not(HasSubstr("{")));
  }
}

TEST(NormalContact, IsOfDiscreteElementCodesAlone) {
  EXPECT_THROW(Validate({.normal_load = 100.0}, Target("dahl")), InputError);
  EXPECT_THROW(Validate({.normal_load = -1.0}, Target("lammps")), InvalidArgument);
  EXPECT_NO_THROW(Validate({.normal_load = 100.0, .contact_radius = 1e-4}, Target("lammps")));
}

}  // namespace
}  // namespace mindahl::convert::parameters_test
