#include "identification/term_scores.h"

#include "recovery/recovered.h"
#include "support/prelude.h"

// Terms are scored by first-order steps.
namespace mindahl::identification::term_scores_test {
namespace {

TEST(TermScores, PredictWhatAFitWithLinearTermsLeaves) {
  constexpr models::BranchLaw kLaw{4e7, 1.0 / 3, 40.0};
  constexpr double kViscosity = 1e4;  // [N s/m]: 0.6 N at 6e-5 m/s
  constexpr double kDrift = 0.8;      // [N/s]
  const History displacement = Cycling(Wave::kSine, 2e-6, 3.0, 200);
  loop::Record record = Timed(testing::LoopOf(kLaw, displacement), 0.001);
  for (std::size_t i = 0; i < record.size(); ++i) {
    const double rate = 10 * std::numbers::pi;
    record.force[i] +=
        kDrift * record.time[i] + kViscosity * 2e-6 * rate * std::cos(rate * record.time[i]);
  }
  FitOptions options;
  options.preparation.force_sense = 1;
  const FitResult fit = FitOne(record, options);
  const std::vector<TermChoice> choices = {{.terms = {"viscous", "force_drift"}, .covariate = ""}};
  const std::vector<loop::RecordView> views = {record};
  const std::optional<TermScore> score = ScoreTerms(views, fit, options, choices).front();
  ASSERT_TRUE(score);
  FitOptions with = options;
  with.terms = choices[0].terms;
  // The law moves, too, which one step does only to first order.
  EXPECT_NEAR(score->rms, FitOne(record, with).rms, 0.05 * fit.rms);
  EXPECT_GT(score->gain, 0.5);
  EXPECT_LT(score->p_value, 1e-6);
}

}  // namespace
}  // namespace mindahl::identification::term_scores_test
