
#include <map>
#include <nlohmann/json.hpp>
#include <regex>

#include "mindahl/report/report.h"
#include "report/fields.h"
#include "report/made_report.h"
#include "support/prelude.h"

// A torque against an angle: the same law, in N m and rad, and no contact behind it.
namespace mindahl::report::torque_test {
namespace {

Report TorqueReport() {
  ReportInput input = MadeInput();
  input.records[0].is_torsional = true;
  input.records[0].displacement.unit = "deg";
  input.records[0].force.unit = "N m";
  input.known.normal_load = 100.0;
  input.fit.parameters.push_back(testing::MadeParameter("covariate_3", "N/m", 2.0, 0.1));
  input.fit.correlation.assign(16, 0.0);
  loop::LoopFacts& facts = input.fit.records[0].facts;
  facts.closed = true;
  facts.amplitude = 0.5;
  facts.peak_force = facts.half_gap.emplace(3.0);
  facts.sliding_amplitude = 0.25;
  facts.slope_after_reversal = 12.0;
  facts.plateau_slope = 1.0;
  input.fit.findings = {{.code = "slip_force_bounded_below",
                         .parameters = {"slip_force"},
                         .numbers = {{"peak_force", 3.0}, {"amplitude", 0.5}}}};
  return MakeReport(std::move(input));
}

TEST(Torque, HasItsUnitsInTheJson) {
  const nlohmann::json json = nlohmann::json::parse(ToJson(TorqueReport()));
  EXPECT_EQ(json["parameters"]["sigma"]["unit"], "N m/rad");
  EXPECT_EQ(json["parameters"]["slip_force"]["unit"], "N m");
  EXPECT_EQ(json["parameters"]["alpha"]["unit"], "-");
  EXPECT_EQ(json["parameters"]["covariate_3"]["unit"], "N m/m") << "the column's own metres";
  EXPECT_EQ(json["input"]["units"]["displacement"], "deg");
  EXPECT_EQ(json["input"]["units"]["force"], "N m");
}

TEST(Torque, HasItsUnitsInWhatIsDescribed) {
  const Report report = TorqueReport();
  const std::map<std::string, std::string> units = {
      {"loop.amplitude", "rad"},          {"loop.peak_force", "N m"},
      {"measured.half_gap.value", "N m"}, {"measured.slope_after_reversal", "N m/rad"},
      {"measured.energy_per_cycle", "J"}, {"residuals.rms", "N m"},
      {"residuals.r_squared", "-"}};
  for (const auto& [path, unit] : units) {
    const std::vector<DescribedValue> values = ValuesUnder(report, JsonDocument(report), path);
    ASSERT_EQ(values.size(), 1U) << path;
    EXPECT_EQ(values[0].field.unit, unit) << path;
  }
}

TEST(Torque, HasNoContactAndSaysWhy) {
  const nlohmann::json json = nlohmann::json::parse(ToJson(TorqueReport()));
  for (const char* path :
       {"/contact/friction_coefficient", "/contact/contact_radius", "/contact/compliance",
        "/contact/mindlin_gross_slip_displacement", "/mapping/alpha_minus_third", "/mapping/z",
        "/mapping/likelihood_ratio", "/loop/stick_radius_ratio"}) {
    const nlohmann::json::json_pointer pointer(path);
    ASSERT_TRUE(json.contains(pointer)) << path;
    EXPECT_TRUE(json[pointer].is_null()) << path;
  }
  for (const nlohmann::json& null : json["nulls"]) {
    const auto path = null["path"].get<std::string>();
    if (!path.starts_with("contact.") && !path.starts_with("mapping.")) continue;
    EXPECT_THAT(null["why"].get<std::string>(), StartsWith("of a torque against an angle")) << path;
  }
}

TEST(Torque, IsNowhereANewtonOrAMetreInTheText) {
  const std::string text = ToText(TorqueReport());
  EXPECT_THAT(text, HasSubstr("N m/rad"));
  EXPECT_THAT(text, HasSubstr("no contact: of a torque against an angle"));
  EXPECT_THAT(text, Not(HasSubstr("G*")));
  EXPECT_FALSE(std::regex_search(text, std::regex("[0-9] (N|m|N/m)[ ,;)\n](?!m)"))) << text;
}

TEST(Torque, HasItsUnitsInWarningsTableAndFigure) {
  const Report report = TorqueReport();
  EXPECT_THAT(report.fit_warnings.at(0).message, HasSubstr("T* = 3 N m at X = 500 mrad"));
  EXPECT_THAT(ResidualsCsv(report), HasSubstr("displacement [rad],force [N m],fitted_force [N m]"));
  const io::Plot plot = ToPlot(report);
  EXPECT_THAT(plot.subtitle, HasSubstr("N m/rad"));
  EXPECT_EQ(plot.panels.at(0).y_label, "torque [N m]");
  EXPECT_THAT(plot.panels.at(1).x_label, HasSubstr("rad]"));
}

}  // namespace
}  // namespace mindahl::report::torque_test
