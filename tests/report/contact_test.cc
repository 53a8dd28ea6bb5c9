#include "mindahl/report/contact.h"

#include "report/made_report.h"
#include "support/prelude.h"

namespace mindahl::report::contact_test {
namespace {

using testing::kSigma;
using testing::kSlipForce;
using testing::MadeFit;
using testing::MadeRecord;

using testing::kSphereOnPlane;

identification::FitResult Fit() { return MadeFit({MadeRecord(2e-6)}, 2e-6); }

ContactQuantity Of(const std::vector<ContactQuantity>& contact, std::string_view name) {
  return *std::ranges::find(contact, name, &ContactQuantity::name);
}

constexpr double kExact = 1e-12;

TEST(DescribeContact, MapsTheEndsOfTheIntervalOfTheParameter) {
  identification::FitResult fit = Fit();
  fit.parameters[0].lower95 = 0.8 * kSigma;  // an interval that is not symmetric
  fit.parameters[0].upper95 = 1.5 * kSigma;
  fit.parameters[2].lower95 = 0.9 * kSlipForce;
  fit.parameters[2].upper95 = 1.05 * kSlipForce;
  const auto contact = DescribeContact(fit, kSphereOnPlane);
  const auto expect_ends = [&](const char* name, double lower, double upper) {
    const ContactQuantity quantity = Of(contact, name);
    EXPECT_NEAR(*quantity.lower / *quantity.value, lower, kExact) << name;
    EXPECT_NEAR(*quantity.upper / *quantity.value, upper, kExact) << name;
  };
  expect_ends("friction_coefficient", 0.9, 1.05);
  expect_ends("contact_radius", 0.8, 1.5);
  expect_ends("equivalent_radius", std::pow(0.8, 3), std::pow(1.5, 3));   // ρ ∝ a³
  expect_ends("maximum_pressure", std::pow(1.5, -2), std::pow(0.8, -2));  // p₀ ∝ a⁻²
  expect_ends("sigma_over_hertz_mindlin", 0.8, 1.5);
  EXPECT_EQ(*Of(contact, "friction_coefficient").value, kSlipForce / 50);
}

TEST(DescribeContact, AddsTheUncertaintyOfInputsInQuadrature) {
  contact::KnownContact known = kSphereOnPlane;
  known.normal_load = {50.0, 2.5};  // 5 %
  identification::FitResult fit = Fit();
  fit.parameters[2].lower95 = kSlipForce / 1.1;
  fit.parameters[2].upper95 = kSlipForce * 1.1;
  const ContactQuantity friction = Of(DescribeContact(fit, known), "friction_coefficient");
  const double half_width = std::hypot(std::log(1.1), 1.959963984540054 * 0.05);
  EXPECT_NEAR(std::log(*friction.upper / *friction.value), half_width, 1e-9);
  EXPECT_NEAR(std::log(*friction.value / *friction.lower), half_width, 1e-9);
}

TEST(DescribeContact, GivesNoValueOfAParameterThatIsNotIdentifiable) {
  identification::FitResult fit = Fit();
  fit.parameters[0].identifiability = identification::Identifiability::kNotIdentifiable;
  fit.parameters[2].identifiability = identification::Identifiability::kBoundedBelow;
  fit.parameters[2].upper95.reset();
  const auto contact = DescribeContact(fit, kSphereOnPlane);
  for (const ContactQuantity& quantity : contact) {
    EXPECT_EQ(quantity.value.has_value(), quantity.name == "normal_load") << quantity.name;
  }
  EXPECT_NEAR(*Of(contact, "friction_coefficient").lower, 0.98 * kSlipForce / 50, kExact);
}

TEST(DescribeContact, OfAHeldParameterHasTheUncertaintyOfInputsAlone) {
  identification::FitResult fit = Fit();
  fit.parameters[2].status = identification::ParameterStatus::kFixed;
  fit.parameters[2].lower95.reset();
  fit.parameters[2].upper95.reset();
  const ContactQuantity friction = Of(DescribeContact(fit, kSphereOnPlane), "friction_coefficient");
  EXPECT_NEAR(*friction.lower, *friction.value, kExact);
  EXPECT_NEAR(*friction.upper, *friction.value, kExact);
}

TEST(DescribeContact, KeepsAnEndOpenThatTheParameterLeavesOpen) {
  identification::FitResult fit = Fit();
  fit.parameters[0].upper95.reset();
  const auto contact = DescribeContact(fit, kSphereOnPlane);
  EXPECT_FALSE(Of(contact, "contact_radius").upper);
  EXPECT_TRUE(Of(contact, "contact_radius").lower);
  EXPECT_FALSE(Of(contact, "maximum_pressure").lower);
  EXPECT_TRUE(Of(contact, "maximum_pressure").upper);
}

TEST(DescribeContact, GivesGrossSlipOfMindlinsContactAlone) {
  identification::FitResult fit = Fit();
  const ContactQuantity slip = Of(DescribeContact(fit, {}), "gross_slip_displacement");
  EXPECT_NEAR(*slip.value / (1.5 * kSlipForce / kSigma), 1, kExact);
  // Tc and σ are known to ±2 %, uncorrelated.
  const double of_slip_force = std::log(1.02);
  const double of_sigma = std::log(0.98);  // δc falls with σ
  EXPECT_NEAR(std::log(*slip.upper / *slip.value), std::hypot(of_slip_force, of_sigma), 1e-9);
  // σ is the first parameter and Tc the third. Both too large by as much leave their ratio alone.
  fit.correlation[2] = fit.correlation[6] = 0.5;
  EXPECT_NEAR(
      std::log(*Of(DescribeContact(fit, {}), "gross_slip_displacement").upper / *slip.value),
      std::sqrt(of_slip_force * of_slip_force + of_sigma * of_sigma +
                2 * 0.5 * of_slip_force * of_sigma),
      1e-9);
  fit.parameters[1] = testing::MadeParameter("alpha", "-", 0.6, 0.01);
  EXPECT_FALSE(Of(DescribeContact(fit, {}), "gross_slip_displacement").value);
}

TEST(DescribeContact, GivesGrossSlipOfAnExponentThatIsHeld) {
  identification::FitResult fit = Fit();
  fit.parameters[1].status = identification::ParameterStatus::kFixed;
  for (const double alpha : {0.0, 0.6}) {
    fit.parameters[1].value = alpha;
    EXPECT_NEAR(*Of(DescribeContact(fit, {}), "gross_slip_displacement").value /
                    (kSlipForce / (kSigma * (1 - alpha))),
                1, kExact);
  }
  fit.parameters[1].value = 1.0;
  const ContactQuantity none = Of(DescribeContact(fit, {}), "gross_slip_displacement");
  EXPECT_FALSE(none.value);
}

TEST(DescribeContact, NamesTheSlipForcesOfEitherDirection) {
  identification::FitResult fit = Fit();
  testing::AddParameter(fit, "asymmetry", "-", 0.1, 0.005);
  const auto contact = DescribeContact(fit, {});
  EXPECT_NEAR(*Of(contact, "slip_force_positive").value, 1.1 * kSlipForce, 1e-9);
  EXPECT_NEAR(*Of(contact, "slip_force_negative").value, 0.9 * kSlipForce, 1e-9);
  EXPECT_NEAR(std::log(*Of(contact, "slip_force_positive").upper / (1.1 * kSlipForce)),
              std::hypot(std::log(1.02), std::log(1.11 / 1.1)), 1e-9);
}

TEST(DescribeContact, FollowsFromNoBoundThatWasGiven) {
  identification::FitResult fit = Fit();
  identification::ParameterEstimate& slip_force = fit.parameters[2];
  slip_force.status = identification::ParameterStatus::kAtUpperBound;
  contact::KnownContact known;
  known.normal_load = 50.0;
  EXPECT_TRUE(Of(DescribeContact(fit, known), "friction_coefficient").value);
  slip_force.bounds = {0.0, slip_force.value};
  for (const char* name : {"friction_coefficient", "gross_slip_displacement"}) {
    EXPECT_FALSE(Of(DescribeContact(fit, known), name).value) << name;
    EXPECT_FALSE(Of(DescribeContact(fit, known), name).upper) << name;
  }
}

TEST(DescribeContact, GivesNoSlipForceThatThePlateausContradict) {
  identification::FitResult fit = Fit();
  testing::AddParameter(fit, "asymmetry", "-", 0.5, 0.05);
  loop::LoopFacts& facts = fit.records[0].facts;
  facts.closed = true;
  facts.energy_ratio = 0.95;
  facts.half_gap = kSlipForce;
  facts.cycles.resize(1);
  facts.cycles[0].centre_force = 0.07 * kSlipForce;
  EXPECT_FALSE(Of(DescribeContact(fit, {}), "slip_force_positive").value);
  facts.cycles[0].centre_force = 0.5 * kSlipForce;
  EXPECT_TRUE(Of(DescribeContact(fit, {}), "slip_force_positive").value);
  // The plateaus are those of the contact: less the offset of the sensor.
  testing::AddParameter(fit, "force_offset", "N", 3 * kSlipForce, 0.05);
  facts.cycles[0].centre_force = 3.5 * kSlipForce;
  EXPECT_TRUE(Of(DescribeContact(fit, {}), "slip_force_positive").value);
}

TEST(TestAlpha, RejectsAThirdOutsideTheIntervalAlone) {
  identification::FitResult fit = Fit();
  EXPECT_FALSE(*TestAlpha(fit).is_rejected);
  fit.parameters[1].lower95 = 0.34;
  EXPECT_TRUE(*TestAlpha(fit).is_rejected);
  fit.parameters[1].identifiability = identification::Identifiability::kNotIdentifiable;
  EXPECT_FALSE(TestAlpha(fit).is_rejected);
  EXPECT_FALSE(TestAlpha(fit).p_value);
}

TEST(DeniesHertz, WhereTheIntervalOfTheExponentExcludesAThird) {
  identification::FitResult fit = Fit();
  EXPECT_FALSE(DeniesHertz(fit));
  testing::AddParameter(fit, "load_exponent", "-", 0.335, 0.01);
  fit.load_exponent = 0.335;
  EXPECT_FALSE(DeniesHertz(fit));
  fit.parameters.back() = testing::MadeParameter("load_exponent", "-", 0.5, 0.01);
  EXPECT_TRUE(DeniesHertz(fit));
}

}  // namespace
}  // namespace mindahl::report::contact_test
