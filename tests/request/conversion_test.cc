#include "mindahl/request/conversion.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "mindahl/core/error.h"

namespace mindahl::request::conversion_test {
namespace {

TEST(MakeConversion, RangesToWhereItIsAskedAndElseEndsAtTheAmplitude) {
  ConversionRequest request;
  request.law = {.tangential_stiffness = 4e7, .shape_exponent = 1.0 / 3, .slip_force = 40.0};
  request.to = "lammps";
  request.options.amplitude = 1e-6;
  EXPECT_FALSE(MakeConversion(request).request.options.range);
  request.largest_amplitude = 3e-6;
  const auto above = MakeConversion(request).request.options.range;
  ASSERT_TRUE(above);
  EXPECT_EQ(above->lower, 1e-6);
  EXPECT_EQ(above->upper, 3e-6);
  request.largest_amplitude.reset();
  request.least_amplitude = 2e-7;
  const auto below = MakeConversion(request).request.options.range;
  ASSERT_TRUE(below);
  EXPECT_EQ(below->lower, 2e-7);
  EXPECT_EQ(below->upper, 1e-6);
}

TEST(MakeConversion, OfAContactThatSticksHasNoRelativeErrorOfTheEnergy) {
  ConversionRequest request;
  request.law = {.tangential_stiffness = 4e7, .shape_exponent = 0.0, .slip_force = 40.0};
  request.to = "lugre";
  request.options.amplitude = 5e-7;  // half of what Jenkins' element slips at
  const std::string text = ToText(MakeConversion(request));
  EXPECT_THAT(text, ::testing::HasSubstr("energy lost where the contact loses none\n"));
  EXPECT_THAT(text, ::testing::Not(::testing::HasSubstr("inf")));
}

/// A conversion set by hand, each of whose numbers is another.
ConvertedContact MadeByHand() {
  ConvertedContact made;
  made.request.law = {2.5, 0.75, 1.5};
  made.request.from = "dahl";
  made.request.options = {.amplitude = 3.5, .range = {{3.25, 4.25}}, .tolerance = 0.0625};
  made.target = {convert::Target::kIwan, "iwan", "Jenkins elements in parallel"};
  methods::IwanElements elements;
  elements.stiffness = {5.5, 6.5};
  elements.slip_force = {7.5, 8.5};
  made.conversion.law = elements;
  made.conversion.at_amplitude = {0.125, -0.25};
  made.conversion.largest = {0.375, 0.5};
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
    "to": "iwan", "amplitude": 3.5, "range": [3.25, 4.25], "tolerance": 0.0625,
    "parameters": {"k": {"value": 9.5, "unit": "N/m"}, "n": {"value": 10.5, "unit": "-"}},
    "elements": [{"stiffness": 5.5, "slip_force": 7.5}, {"stiffness": 6.5, "slip_force": 8.5}],
    "error_at_amplitude": {"force": 0.125, "energy": -0.25},
    "largest_error": {"force": 0.375, "energy": 0.5},
    "within": [3.125, 3.75]})"));
  made.request.options.range.reset();
  made.conversion.within.reset();
  made.conversion.largest.energy = HUGE_VAL;
  made.conversion.law = convert::BoucWenLaw{};
  json = nlohmann::json::parse(ToJson(made));
  EXPECT_TRUE(json["range"].is_null() && json["within"].is_null());
  EXPECT_TRUE(json["largest_error"]["energy"].is_null());
  EXPECT_TRUE(json["elements"].empty());
}

TEST(ConvertedContact, TextHasEveryNumberInItsLine) {
  ConvertedContact made = MadeByHand();
  EXPECT_EQ(ToText(made),
            "Jenkins elements in parallel, on the steady loop between ±3.5 m\n\n"
            "k                       9.5 N/m    a stiffness\n"
            "n                      10.5 -      an exponent\n"
            "\nelement  stiffness [N/m]   slip force [N]\n"
            "      1              5.5              7.5\n"
            "      2              6.5              8.5\n"
            "\nerror at the amplitude: force 12.5 % of T*, energy -25 %\n"
            "largest from 3.25 to 4.25 m: force 37.5 % of T*, energy 50 %\n"
            "force and energy within 6.25 % from 3.125 to 3.75 m\n");
  made.conversion.within.reset();
  made.request.options.range.reset();
  made.conversion.at_amplitude = {2e-12, 0.5e-12};  // the second is rounding
  EXPECT_THAT(ToText(made),
              ::testing::EndsWith("\nerror at the amplitude: force 2e-10 % of T*, energy 0 %\n"
                                  "not within 6.25 % at the amplitude\n"));
}

TEST(MakeConversion, IsOfTheLawThatItIsFrom) {
  ConversionRequest request;
  request.law = {.tangential_stiffness = 4e7, .shape_exponent = 0.5, .slip_force = 40.0};
  request.options.amplitude = 1e-6;
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
    ConversionRequest request;
    request.law = {.tangential_stiffness = 4e7, .shape_exponent = 0.5, .slip_force = 40.0};
    request.to = to;
    request.options.amplitude = 1e-6;
    request.normal = normal;
    try {
      MakeConversion(request);
    } catch (const std::exception& error) {
      return error.what();
    }
    return "";
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
