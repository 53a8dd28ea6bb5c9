
#include <nlohmann/json.hpp>

#include "mindahl/report/contact.h"
#include "mindahl/report/report.h"
#include "recovery/recovered.h"
#include "report/made_report.h"
#include "support/prelude.h"

namespace mindahl::report::slip_forces_test {
namespace {

using identification::FitResult;
using identification::ParameterStatus;

constexpr double kRounding = 1e-12;

/// Tc = 40 ± 0.4 N, a = 0.2 ± 0.03, correlated by −0.5.
ReportInput MadeAsymmetricInput() {
  ReportInput input = testing::MadeInput();
  input.fit.parameters.push_back(MadeParameter("asymmetry", "-", 0.2, 0.03));
  input.fit.correlation = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, -0.5, 0, 0, -0.5, 1};
  return input;
}

TEST(SlipForces, AreThoseOfTheMeanAndTheAsymmetryWithTheErrorsOfBoth) {
  const SlipForces forces = DescribeSlipForces(MadeAsymmetricInput().fit).value();
  EXPECT_NEAR(forces.positive.value, 48.0, kRounding);
  EXPECT_NEAR(forces.negative.value, 32.0, kRounding);
  // Tc(1 ± a): the squares of 1.2·0.4 and 40·0.03, and twice −0.5 times them, or +0.5.
  EXPECT_NEAR(forces.positive.standard_error.value(),
              std::sqrt(0.48 * 0.48 + 1.2 * 1.2 - 0.48 * 1.2), kRounding);
  EXPECT_NEAR(forces.negative.standard_error.value(),
              std::sqrt(0.32 * 0.32 + 1.2 * 1.2 + 0.32 * 1.2), kRounding);
}

TEST(SlipForces, HaveIntervalsAsWideAsThoseTheyFollowFrom) {
  ReportInput input = MadeAsymmetricInput();
  const auto of_slip_force = [](double end) { return std::log(end / kSlipForce); };
  const SlipForce narrow = DescribeSlipForces(input.fit)->positive;
  const double up = of_slip_force(40.8);
  constexpr double kOfAsymmetry = 0.06 / 1.2;
  EXPECT_NEAR(narrow.upper95.value(),
              48 * std::exp(std::sqrt(up * up + kOfAsymmetry * kOfAsymmetry - up * kOfAsymmetry)),
              kRounding * 48);
  // What widens the interval of Tc above widens these above, and nothing below.
  input.fit.parameters[2].upper95 = 60.0;
  const SlipForce wide = DescribeSlipForces(input.fit)->positive;
  EXPECT_GT(wide.upper95.value(), 60.0);
  EXPECT_DOUBLE_EQ(wide.lower95.value(), narrow.lower95.value());
  // Of an asymmetry that is open above that of the positive sense is, and below of the other.
  input.fit.parameters[3].upper95.reset();
  EXPECT_FALSE(DescribeSlipForces(input.fit)->positive.upper95.has_value());
  EXPECT_FALSE(DescribeSlipForces(input.fit)->negative.lower95.has_value());
}

TEST(SlipForces, OfAKnownAsymmetryHaveTheRelativeErrorOfTheMean) {
  ReportInput input = MadeAsymmetricInput();
  input.fit.parameters[3].status = ParameterStatus::kFixed;
  const SlipForces forces = DescribeSlipForces(input.fit).value();
  EXPECT_NEAR(forces.positive.standard_error.value(), 0.01 * 48, kRounding);
  EXPECT_NEAR(forces.negative.lower95.value() / 32.0, 39.2 / 40.0, kRounding);
  input.fit.parameters[2].status = ParameterStatus::kFixed;
  EXPECT_FALSE(DescribeSlipForces(input.fit)->positive.standard_error.has_value());
}

TEST(SlipForces, AreNotSaidWhereEitherIsOpen) {
  for (const std::size_t open : {2U, 3U}) {
    ReportInput input = MadeAsymmetricInput();
    input.fit.parameters[open].identifiability = identification::Identifiability::kNotIdentifiable;
    EXPECT_FALSE(DescribeSlipForces(input.fit).has_value());
    const Report report = MakeReport(input);
    EXPECT_THAT(ToText(report), Not(HasSubstr("slip forces:")));
    const auto json = nlohmann::json::parse(ToJson(report));
    EXPECT_TRUE(json["slip_forces"]["positive"]["value"].is_null());
  }
  EXPECT_FALSE(DescribeSlipForces(testing::MadeInput().fit).has_value());
  const auto json = nlohmann::json::parse(ToJson(MakeReport(testing::MadeInput())));
  EXPECT_FALSE(json.contains("slip_forces"));
}

TEST(SlipForces, AreInTheTextAndTheJson) {
  const Report report = MakeReport(MadeAsymmetricInput());
  EXPECT_THAT(ToText(report), HasSubstr("slip forces: 48.0 ± 1.0 N"));
  const auto json = nlohmann::json::parse(ToJson(report));
  EXPECT_NEAR(json["slip_forces"]["positive"]["value"].get<double>(), 48.0, kRounding);
  EXPECT_NEAR(json["slip_forces"]["negative"]["value"].get<double>(), 32.0, kRounding);
}

TEST(SlipForces, HaveIntervalsThatCoverTheTruth) {
  constexpr models::BranchLaw kLaw{5e7, 1.0 / 3, 20.0};
  constexpr double kAsymmetry = 0.2;
  constexpr int kLoops = 200;
  // Of 95 %, three standard deviations of counting 200 loops to either side.
  const double slack = 3 * std::sqrt(0.95 * 0.05 / kLoops);
  const testing::History displacement =
      testing::Cycling(testing::Wave::kSine, 1.2 * GrossSlipDisplacement(kLaw), 2.0, 100);
  const loop::Record clean =
      testing::MakeRecord(displacement, testing::Respond(testing::Model("mindlin-dahl"), kLaw,
                                                         displacement, {.asymmetry = kAsymmetry}));
  identification::FitOptions options;
  options.terms.emplace_back("asymmetry");
  options.initial_state = models::InitialState::kVirgin;
  testing::Generator generator(17);
  double positive = 0.0;
  double negative = 0.0;
  for (int i = 0; i < kLoops; ++i) {
    const loop::Record record = testing::WithForceNoise(clean, 0.2, generator);
    const FitResult fit = identification::Fit({&record, 1}, options);
    const SlipForces forces = DescribeSlipForces(fit).value();
    const auto covers = [](const SlipForce& force, double truth) {
      return *force.lower95 <= truth && truth <= *force.upper95 ? 1.0 / kLoops : 0.0;
    };
    positive += covers(forces.positive, kLaw.slip_force * (1 + kAsymmetry));
    negative += covers(forces.negative, kLaw.slip_force * (1 - kAsymmetry));
  }
  EXPECT_NEAR(positive, 0.95, slack);
  EXPECT_NEAR(negative, 0.95, slack);
}

}  // namespace
}  // namespace mindahl::report::slip_forces_test
