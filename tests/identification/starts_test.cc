#include "identification/term_scores.h"
#include "recovery/recovered.h"
#include "support/prelude.h"

// Where the search of a fit begins: looks over the plane of the law, and first-order steps to
// terms.
namespace mindahl::identification::starts_test {
namespace {

using loop::Record;

struct LateRecord {
  double lambda;
  double cycles;
  std::size_t lost;  // samples before the record begins, 200 a cycle
  std::string_view model;
};

TEST(Starts, OfARecordToldToBeVirginLeadToTheLeastMinimum) {
  // The record begins when the contact already slips: where it was unloaded is none of its samples,
  // and looks from elsewhere are lower than those that lead to the minimum.
  constexpr models::BranchLaw kMindlin{4e7, 1.0 / 3, 40.0};
  for (const LateRecord& late :
       {LateRecord{7.8, 1.25, 55, "mindlin"}, LateRecord{3.6, 2.5, 55, "mindlin"},
        LateRecord{6.2, 1.5, 55, "mindlin"}, LateRecord{7.0, 1.25, 55, "mindlin-dahl"},
        LateRecord{8.9, 2.5, 3, "dahl"}}) {
    const double reach = late.lambda * GrossSlipDisplacement(kMindlin);
    const History displacement = Cycling(Wave::kSine, reach, late.cycles, 200);
    Generator generator(7);
    Record record = WithForceNoise(
        MakeRecord(displacement, Respond(Model("mindlin-dahl"), kMindlin, displacement)), 0.05,
        generator);
    record = Shifted(From(std::move(record), late.lost), reach, 0.0);
    FitOptions options;
    options.model = models::FindFrictionModel(late.model);
    options.initial_state = models::InitialState::kVirgin;
    const double rms = FitOne(record, options).residuals.rms;
    options.starts = 30;
    EXPECT_LE(rms, (1 + 1e-6) * FitOne(record, options).residuals.rms)
        << late.lambda << " " << late.model;
  }
}

TEST(TermScores, ValuesOfLinearTermsAreThoseOfTheFitWithThem) {
  constexpr models::BranchLaw kLaw{4e7, 1.0 / 3, 40.0};
  constexpr double kViscosity = 1e4;  // [N s/m]: 0.6 N at 6e-5 m/s
  constexpr double kDrift = 0.8;      // [N/s]
  const History displacement = Cycling(Wave::kSine, 2e-6, 3.0, 200);
  Record record = MakeRecord(displacement, Respond(Model("mindlin-dahl"), kLaw, displacement));
  for (std::size_t i = 0; i < record.size(); ++i) {
    const double time = 0.2 * static_cast<double>(i) / 200;
    record.time.push_back(time);
    record.force[i] += kDrift * time;
    record.force[i] +=
        kViscosity * 2e-6 * 10 * std::numbers::pi * std::cos(10 * std::numbers::pi * time);
  }
  FitOptions options;
  options.preparation.force_sense = 1;
  const FitResult fit = FitOne(record, options);
  FitOptions with = options;
  with.terms = {"viscous", "force_drift"};
  const std::vector<loop::RecordView> views = {record};
  TermScores scores(views, options, with.terms, {});
  scores.StepFrom(fit, options, {}, 0);
  const std::optional<TermScore> score = scores.Of(with);
  ASSERT_TRUE(score);
  // The law moves, too, which one step does only to first order.
  EXPECT_NEAR(score->values.at("viscous") / kViscosity, 1, 0.05);
  EXPECT_NEAR(score->values.at("force_drift") / kDrift, 1, 0.05);
  EXPECT_LT(score->rms, 0.1 * fit.residuals.rms);
}

}  // namespace
}  // namespace mindahl::identification::starts_test
