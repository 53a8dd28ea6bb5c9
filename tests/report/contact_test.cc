#include "mindahl/report/contact.h"

#include "mindahl/report/report.h"
#include "report/made_report.h"
#include "support/prelude.h"

// From a fit to the contact, by rules that hold for every caller of the library.
namespace mindahl::report::contact_test {
namespace {

using namespace contact;
using namespace loop;
using namespace identification;

using report::IdentifyFittedContact;
using report::MeanNormalLoad;
using report::WhyFrictionIsWithheld;
using testing::kSlipForce;

constexpr double kRounding = 16 * std::numeric_limits<double>::epsilon();
constexpr double kLoad = 100.0;  // [N]

FitResult FitThatLeavesTheSlipForceOpen() {
  FitResult fit = MadeFit({MadeRecord(1e-6)}, 1e-6);
  ParameterEstimate& slip_force = fit.parameters[2];
  slip_force.identifiability = Identifiability::kBoundedBelow;
  slip_force.standard_error.reset();
  slip_force.upper95.reset();
  slip_force.lower95 = 4.0;
  return fit;
}

TEST(FittedContact, GivesTheFrictionCoefficientOfAnIdentifiableSlipForce) {
  const FitResult fit = MadeFit({MadeRecord(1e-6)}, 1e-6);
  const IdentifiedContact contact = IdentifyFittedContact(fit, {.normal_load = kLoad});
  ASSERT_TRUE(contact.friction_coefficient);
  EXPECT_NEAR(contact.friction_coefficient->value / (kSlipForce / kLoad), 1, kRounding);
  EXPECT_FALSE(WhyFrictionIsWithheld(fit, {.normal_load = kLoad}));
}

TEST(FittedContact, WithholdsTheFrictionCoefficientOfASlipForceThatIsOpenThoughTheLoadIsKnown) {
  const FitResult fit = FitThatLeavesTheSlipForceOpen();
  const IdentifiedContact contact = IdentifyFittedContact(fit, {.normal_load = kLoad});
  EXPECT_FALSE(contact.friction_coefficient);
  // μ >= 4 N/100 N
  const char* expected = "needs an identifiable slip force; from this loop it is at least 0.04";
  EXPECT_EQ(WhyFrictionIsWithheld(fit, {.normal_load = kLoad}), expected);
  EXPECT_EQ(contact.unidentified.back(), std::string("friction coefficient ") + expected);
}

TEST(FittedContact, WithholdsItAlsoWhereTheIntervalIsClosedButTooWide) {
  FitResult fit = MadeFit({MadeRecord(1e-6)}, 1e-6);
  fit.parameters[2].identifiability = Identifiability::kNotIdentifiable;
  EXPECT_FALSE(IdentifyFittedContact(fit, {.normal_load = kLoad}).friction_coefficient);
}

TEST(FittedContact, IsWithheldInEveryFormOfTheReport) {
  report::ReportInput input = MadeInput();
  input.fit = FitThatLeavesTheSlipForceOpen();
  input.known.normal_load = kLoad;
  const report::Report report = report::MakeReport(std::move(input));
  EXPECT_FALSE(report.contact.friction_coefficient);
  EXPECT_THAT(report::ToJson(report), HasSubstr("\"friction_coefficient\": null"));
  EXPECT_THAT(report::ToText(report), Not(HasSubstr("μ = Tc/N")));
  EXPECT_THAT(report::ToText(report), HasSubstr("at least"));
}

TEST(FittedContact, TakesTheCorrelationOfTheErrorsAlong) {
  FitResult fit = MadeFit({MadeRecord(1e-6)}, 1e-6);
  // δc = 3Tc/(2σ), errors of 1 % each: √(1 + 1 − 2ρ) %
  for (const double correlation : {0.0, 0.5, 1.0, -1.0}) {
    fit.correlation[2] = fit.correlation[6] = correlation;
    const PropagatedValue slip = IdentifyFittedContact(fit, {}).gross_slip_displacement;
    EXPECT_NEAR(slip.standard_error / slip.value, 0.01 * std::sqrt(2 - 2 * correlation), 1e-15);
  }
  fit.correlation[2] = std::numeric_limits<double>::quiet_NaN();
  const PropagatedValue slip = IdentifyFittedContact(fit, {}).gross_slip_displacement;
  EXPECT_NEAR(slip.standard_error / slip.value, 0.01 * std::sqrt(2.0), 1e-15);
}

TEST(ContactOfAnotherLaw, HasTheRelativeErrorsOfTheFit) {
  const FitResult fit = MadeFit({MadeRecord(1e-6)}, 1e-6);  // of which each is 1 %
  const models::BranchLaw other{2 * kSigma, 0.5, 3 * kSlipForce};
  const IdentifiedContact contact =
      report::IdentifyContactOf(fit, other, {.normal_load = kLoad, .tangential_compliance = 4e-11});
  EXPECT_NEAR(contact.contact_radius->value / (2 * kSigma * 4e-11 / 8), 1, kRounding);
  EXPECT_NEAR(contact.contact_radius->standard_error / contact.contact_radius->value, 0.01, 1e-15);
  EXPECT_NEAR(contact.friction_coefficient->value / (3 * kSlipForce / kLoad), 1, kRounding);
  EXPECT_NEAR(contact.friction_coefficient->standard_error / contact.friction_coefficient->value,
              0.01, 1e-15);
}

TEST(FittedContact, CountsAHeldParameterAsExactAndAnOpenOneAsUnknown) {
  FitResult fit = MadeFit({MadeRecord(1e-6)}, 1e-6);
  fit.parameters[0].standard_error.reset();
  EXPECT_TRUE(std::isinf(
      IdentifyFittedContact(fit, {.tangential_compliance = 4e-11}).contact_radius->standard_error));
  fit.parameters[0].status = ParameterStatus::kFixed;
  const IdentifiedContact contact = IdentifyFittedContact(fit, {.tangential_compliance = 4e-11});
  EXPECT_EQ(contact.contact_radius->standard_error, 0.0);
  EXPECT_NEAR(contact.contact_radius->value / (kSigma * 4e-11 / 8), 1, kRounding);
}

TEST(MeanNormalLoad, IsThatOfTheSamplesInTheWindow) {
  Record first;
  first.normal_load = {1, 2, 3};
  Record second;
  second.normal_load = {10, 4};
  const std::vector<Record> records = {first, second};
  EXPECT_EQ(MeanNormalLoad(records), 4.0);
  EXPECT_EQ(MeanNormalLoad(records, Interval{2, 4}), 3.0);
  EXPECT_FALSE(MeanNormalLoad(records, Interval{5, 6}));
  EXPECT_FALSE(MeanNormalLoad(std::vector<Record>{first, Record{}}));
}

}  // namespace
}  // namespace mindahl::report::contact_test
