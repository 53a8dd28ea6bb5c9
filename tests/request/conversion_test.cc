#include "mindahl/request/conversion.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "io/temporary_directory.h"
#include "mindahl/core/error.h"
#include "mindahl/models/steady_loop.h"

namespace mindahl::request::conversion_test {
namespace {

ConversionRequest Request(double alpha, double amplitude, std::string to) {
  return {.sigma = 4e7,
          .alpha = alpha,
          .slip_force = 40.0,
          .amplitude = amplitude,
          .to = std::move(to)};
}

TEST(MakeConversion, TakesLawAndAmplitudeFromAFit) {
  const TemporaryDirectory directory;
  const auto written = [&](const std::string& text) {
    ConversionRequest request;
    request.to = "lammps";
    request.fit = directory.Write("fit.json", text).string();
    return request;
  };
  const std::string parameters =
      R"("parameters": {"sigma": {"value": 5e7}, "alpha": {"value": 0.5},
                        "slip_force": {"value": 30}, "rig_stiffness": {"value": 1e8}},)";
  const std::string fit = R"({"schema": "mindahl.fit/2", "model": "dahl", )" + parameters +
                          R"("measured": {"amplitude": 2e-6}})";
  const ConvertedContact made = MakeConversion(written(fit));
  EXPECT_EQ(made.from, "dahl");
  EXPECT_EQ(made.law.tangential_stiffness, 5e7);
  EXPECT_EQ(made.law.shape_exponent, 0.5);
  EXPECT_EQ(made.law.slip_force, 30.0);
  // The rest of the amplitude is the rig's: T* of the contact's part is that of the rig.
  const double peak =
      models::SteadyPeakForce(*models::FindFrictionModel("dahl"), made.law, made.options.amplitude);
  EXPECT_NEAR(made.options.amplitude + peak / 1e8, 2e-6, 1e-15);
  ConversionRequest given = written(fit);
  given.sigma = 6e7;
  given.amplitude = 1e-6;
  given.from = "masing";
  EXPECT_EQ(MakeConversion(given).law.tangential_stiffness, 6e7);
  EXPECT_EQ(MakeConversion(given).options.amplitude, 1e-6);
  EXPECT_EQ(MakeConversion(given).from, "masing");
  const auto refusal = [&](const std::string& text) -> std::string {
    return MessageOf<InputError>([&] { MakeConversion(written(text)); });
  };
  EXPECT_THAT(refusal(R"({"schema": "mindahl.fit/2", "parameters": {"sigma": {"value": null}}})"),
              ::testing::HasSubstr("--sigma missing: "));
  EXPECT_THAT(refusal("x,F\n1,2\n"), ::testing::HasSubstr("is not the result of a fit"));
  EXPECT_THAT(refusal("{}"), ::testing::HasSubstr("is not the result of a fit"));
}

TEST(MakeConversion, OfAContactThatSticksHasNoRelativeErrorOfTheEnergy) {
  // Half of what Jenkins' element slips at.
  const std::string text = ToText(MakeConversion(Request(0.0, 5e-7, "lugre")));
  EXPECT_THAT(text, ::testing::HasSubstr("the energy lost where the contact loses none\n"));
  EXPECT_THAT(text, ::testing::Not(::testing::HasSubstr("inf")));
}

/// A conversion set by hand, each of whose numbers is another.
ConvertedContact MadeByHand() {
  ConvertedContact made{};
  made.law = {2.5, 0.75, 1.5};
  made.from = "dahl";
  made.options = {.amplitude = 3.5, .tolerance = 0.0625};
  made.target = *std::ranges::find(convert::Targets(), "iwan", &convert::TargetRow::name);
  methods::IwanElements elements;
  elements.stiffness = {5.5, 6.5};
  elements.slip_force = {7.5, 8.5};
  made.conversion.law = elements;
  made.conversion.at_amplitude = {0.125, -0.25};
  made.conversion.within = {{3.125, 3.75}};
  made.parameters = {{"k", 9.5, "N/m", "a stiffness"}, {"n", 10.5, "-", "an exponent"}};
  return made;
}

TEST(ConvertedContact, JsonHasEveryNumberUnderItsName) {
  ConvertedContact made = MadeByHand();
  auto json = nlohmann::json::parse(ToJson(made));
  json.erase("version");
  EXPECT_EQ(json, nlohmann::json::parse(R"({
    "schema": "mindahl.convert/1",
    "from": {"law": "dahl", "sigma": 2.5, "alpha": 0.75, "slip_force": 1.5},
    "to": "iwan", "amplitude": 3.5, "tolerance": 0.0625,
    "parameters": {"k": {"value": 9.5, "unit": "N/m"}, "n": {"value": 10.5, "unit": "-"}},
    "elements": [{"stiffness": 5.5, "slip_force": 7.5}, {"stiffness": 6.5, "slip_force": 8.5}],
    "error_at_amplitude": {"force": 0.125, "energy": -0.25},
    "within": [3.125, 3.75]})"));
  made.conversion.within.reset();
  made.conversion.at_amplitude.energy = HUGE_VAL;
  made.conversion.law = convert::BoucWenLaw{};
  json = nlohmann::json::parse(ToJson(made));
  EXPECT_TRUE(json["within"].is_null());
  EXPECT_TRUE(json["error_at_amplitude"]["energy"].is_null());
  EXPECT_TRUE(json["elements"].empty());
}

TEST(ConvertedContact, TextHasEveryNumberInItsLine) {
  ConvertedContact made = MadeByHand();
  EXPECT_EQ(
      ToText(made),
      "Jenkins elements in parallel; at 3.5 m the force is within 12.5 % of T*, the energy off by "
      "-25 %\n\n"
      "k                         9.5 N/m    a stiffness\n"
      "n                        10.5 -      an exponent\n"
      "\nelement  stiffness [N/m]   slip force [N]\n"
      "      1              5.5              7.5\n"
      "      2              6.5              8.5\n"
      "\nforce and energy within 6.25 % from 3.125 to 3.75 m\n");
  EXPECT_THAT(InputLines(made)[0], ::testing::StartsWith("# at 3.5 m the force is within 12.5 %"));
  made.conversion.within.reset();
  made.conversion.at_amplitude = {2e-7, 0.5e-12};  // the second is rounding
  EXPECT_THAT(
      ToText(made),
      ::testing::AllOf(::testing::HasSubstr("within 2e-05 % of T*, the energy off by 0 %\n"),
                       ::testing::EndsWith("\nnot within 6.25 % at the amplitude\n")));
}

TEST(MakeConversion, IsOfTheLawThatItIsFrom) {
  ConversionRequest request = Request(0.5, 1e-6, "dahl");
  const auto is_unchanged = [&](const char* from, const char* to) {
    request.from = from;
    request.to = to;
    const convert::Conversion made = MakeConversion(request).conversion;
    EXPECT_LT(made.at_amplitude.force, 1e-10) << "their steady loops are one curve";
    const models::BranchLaw& law = std::get<convert::ModelLaw>(made.law).law;
    return law.tangential_stiffness == 4e7 && law.slip_force == 40.0;
  };
  EXPECT_TRUE(is_unchanged("masing", "masing"));
  EXPECT_FALSE(is_unchanged("masing", "dahl"));
  EXPECT_FALSE(is_unchanged("dahl", "masing"));
  EXPECT_TRUE(is_unchanged("dahl", "dahl"));
  request.from = "oak";
  EXPECT_THROW(MakeConversion(request), InputError);
  request.from = "dahl";
  request.to = "oak";
  EXPECT_THROW(MakeConversion(request), InputError);
}

TEST(MakeConversion, RefusesWhatItsTargetHasNot) {
  const auto refusal = [](const char* to, const convert::NormalContact& normal) -> std::string {
    ConversionRequest request = Request(0.5, 1e-6, to);
    request.normal = normal;
    return MessageOf<std::exception>([&] { MakeConversion(request); });
  };
  for (const convert::TargetRow& row : convert::Targets()) {
    const char* name = row.name.data();
    const std::string_view to = row.name;
    const bool is_code = to == "lammps" || to == "liggghts" || to == "yade";
    const bool moves =
        to == "lugre" || to == "mujoco" || to == "mujoco-joint" || to == "urdf" || to == "sdf";
    EXPECT_EQ(refusal(name, {.normal_load = 10.0}).empty(), is_code) << to;
    EXPECT_EQ(refusal(name, {.contact_radius = 1e-3}).empty(), to == "lammps") << to;
    EXPECT_EQ(refusal(name, {.viscous = 2.0}).empty(), moves) << to;
    EXPECT_EQ(refusal(name, {}), "") << to;
    EXPECT_THAT(refusal(name, {.viscous = -1.0}), ::testing::HasSubstr("--viscous [N s/m]"));
  }
}

}  // namespace
}  // namespace mindahl::request::conversion_test
