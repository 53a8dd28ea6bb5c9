#include "identification/sample_loop.h"
#include "mindahl/identification/terms.h"
#include "support/prelude.h"

// Forces in proportion to other columns of a record: as terms, and as what a fit finds unasked.
namespace mindahl::identification::covariate_test {
namespace {

/// Wanders by ±1 in no step with the motion.
std::vector<double> Wandering(std::size_t samples, double middle, double pace) {
  std::vector<double> values;
  for (std::size_t i = 0; i < samples; ++i) {
    const double at = pace * static_cast<double>(i);
    values.push_back(middle + std::sin(0.031 * at) * std::cos(0.012 * at + 1));
  }
  return values;
}

constexpr double kPerBar = 6.0;      // [N/bar], a tenth of Tc over the column's range
constexpr double kPerKelvin = -4.0;  // [N/K]

/// A loop beside two other forces, which two columns tell.
Record LoopBesideTwo() {
  Record record = Loop();
  record.covariates = {
      {.name = "p", .unit = "bar", .values = Wandering(record.size(), 40.0, 1.0)},
      {.name = "oil temperature", .unit = "", .values = Wandering(record.size(), 300.0, 2.9)}};
  for (std::size_t i = 0; i < record.size(); ++i) {
    record.force[i] +=
        kPerBar * record.covariates[0].values[i] + kPerKelvin * record.covariates[1].values[i];
  }
  return record;
}

TEST(Covariate, OfTwoColumnsIsRecovered) {
  const FitResult fit = FitOne(LoopBesideTwo(), {.covariates = {"p", "oil temperature"}});
  EXPECT_TRUE(Recovers(fit, kLaw, kNoiseFree));
  const ParameterEstimate* pressure = fit.Find("covariate_p");
  const ParameterEstimate* temperature = fit.Find("covariate_oil_temperature");
  ASSERT_TRUE(pressure && temperature);
  EXPECT_NEAR(pressure->value, kPerBar, kNoiseFree * kLaw.slip_force);
  EXPECT_NEAR(temperature->value, kPerKelvin, kNoiseFree * kLaw.slip_force);
  EXPECT_EQ(pressure->unit, "N/bar");
  EXPECT_EQ(temperature->unit, "N/unit");
  EXPECT_EQ(pressure->status, ParameterStatus::kFree);
}

TEST(Covariate, LeavesTheOffsetAsItIsInTheMiddleOfTheColumnsRange) {
  const Record record = LoopBesideTwo();
  FitOptions options{.covariates = {"p", "oil temperature"}};
  const auto middle = [&](std::size_t column) {
    const auto [least, greatest] = std::ranges::minmax(record.covariates[column].values);
    return (least + greatest) / 2;
  };
  const double offset = kPerBar * middle(0) + kPerKelvin * middle(1);
  EXPECT_NEAR(FitOne(record, options).Find("force_offset")->value, offset,
              kNoiseFree * std::abs(offset));
  // Without offsets the force is C times the column as it is.
  options.offsets = false;
  const FitResult literal = FitOne(record, options);
  EXPECT_TRUE(Recovers(literal, kLaw, kNoiseFree));
  EXPECT_NEAR(literal.Find("covariate_p")->value, kPerBar, kNoiseFree * kLaw.slip_force);
}

TEST(Covariate, OfAJointFitIsOneOfAllRecords) {
  const Record first = LoopBesideTwo();
  Record second = first;
  for (double& force : second.force) force += 3.0;
  const std::vector<Record> records = {first, second};
  const FitResult fit = Fit(records, {.covariates = {"p", "oil temperature"}});
  EXPECT_TRUE(Recovers(fit, kLaw, kNoiseFree));
  EXPECT_NEAR(fit.Find("covariate_p")->value, kPerBar, kNoiseFree * kLaw.slip_force);
}

TEST(Covariate, IsRefusedWhereARecordHasNoSuchColumnOrItNeverChanges) {
  const FitOptions options{.covariates = {"p"}};
  EXPECT_THAT(RefusalOf({LoopBesideTwo(), Loop()}, options),
              HasSubstr("record 2 has no covariate 'p'"));
  Record constant = LoopBesideTwo();
  constant.covariates[0].values.assign(constant.size(), 40.0);
  EXPECT_THAT(RefusalOf({constant}, options), HasSubstr("half range of the covariate 'p'"));
  Record shorter = LoopBesideTwo();
  shorter.covariates[0].values.pop_back();
  EXPECT_THAT(RefusalOf({shorter}, options), HasSubstr("p"));
}

TEST(Covariate, OfOneChannelInTwoUnitsAreNotIdentifiable) {
  Record record = LoopBesideTwo();
  record.covariates.push_back(
      {.name = "volts", .unit = "V", .values = record.covariates[0].values});
  for (double& value : record.covariates.back().values) value = 0.5 - 0.02 * value;
  const FitResult fit = Fit({&record, 1}, {.covariates = {"p", "volts"}});
  EXPECT_FALSE(fit.Find("covariate_p")->is_known());
  EXPECT_FALSE(fit.Find("covariate_volts")->is_known());
}

TEST(Covariate, IsRefusedIfItIsTheForce) {
  Record record = LoopBesideTwo();
  record.covariates.push_back({.name = "volts", .unit = "V", .values = record.force});
  EXPECT_THAT(RefusalOf({record}, {.covariates = {"volts"}}),
              HasSubstr("'volts' is a linear function of 'force'"));
}

TEST(Covariate, OfAKnownFactorIsNoPartOfTheLoopThatIsMeasured) {
  const FitResult whole = FitOne(NoisyLoop(3), {});
  Record record = NoisyLoop(3);
  for (double& force : record.force) force /= 2;
  record.covariates = {{.name = "other cell", .unit = "N", .values = record.force}};
  const FitResult fit =
      FitOne(record, {.covariates = {"other cell"}, .fixed = {{"covariate_other_cell", -1.0}}});
  const loop::LoopFacts& facts = fit.records[0].facts;
  const loop::LoopFacts& expected = whole.records[0].facts;
  EXPECT_NEAR(*facts.half_gap, *expected.half_gap, kNoiseFree * kLaw.slip_force);
  EXPECT_NEAR(facts.peak_force, expected.peak_force, kNoiseFree * kLaw.slip_force);
  EXPECT_NEAR(facts.energy_ratio, expected.energy_ratio, kNoiseFree);
  EXPECT_NEAR(fit.law.slip_force, whole.law.slip_force, 1e-6 * kLaw.slip_force);
  // With the force opposite to the motion the sign of a column stays that of the file.
  for (double& force : record.force) force = -force;
  record.covariates[0].values = record.force;
  const FitResult opposite =
      FitOne(record, {.covariates = {"other cell"}, .fixed = {{"covariate_other_cell", -1.0}}});
  EXPECT_NEAR(*opposite.records[0].facts.half_gap, *expected.half_gap,
              kNoiseFree * kLaw.slip_force);
}

TEST(Covariate, HasANameThatNeedsNoQuoting) {
  EXPECT_EQ(NameOfCovariate("6"), "covariate_6");
  EXPECT_EQ(NameOfCovariate("p"), "covariate_p");
  EXPECT_EQ(NameOfCovariate("oil temp. [K]=x:y"), "covariate_oil_temp___K__x_y");
}

}  // namespace
}  // namespace mindahl::identification::covariate_test
