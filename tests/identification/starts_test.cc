#include <array>
#include <tuple>

#include "identification/sample_loop.h"
#include "mindahl/identification/fit.h"
#include "recovery/recovered.h"
#include "support/prelude.h"

// The search of a fit begins where looks over the plane of the law are lowest.
namespace mindahl::identification::starts_test {
namespace {

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
    Record record = WithForceNoise(testing::LoopOf(kMindlin, displacement), 0.05, generator);
    record = Shifted(From(std::move(record), late.lost), reach, 0.0);
    FitOptions options{.model = &Model(late.model), .initial_state = models::InitialState::kVirgin};
    const double rms = FitOne(record, options).residuals.rms;
    const auto truth = ParametersOf(kMindlin);
    options.start = {truth.begin(), truth.end()};
    options.start["displacement_offset"] = reach;
    EXPECT_LE(rms, (1 + 1e-6) * FitOne(record, options).residuals.rms)
        << late.lambda << " " << late.model;
  }
}

TEST(Starts, OfStrokesAHundredTimesAsWideAsTheKneeLeadToTheContact) {
  for (const double alpha : {0.7, 1.0}) {
    const models::BranchLaw law{2500.0, alpha, 3.0};
    Record record = MakeRecord(Cycling(Wave::kTriangle, 0.12, 3.0, 200), {});
    record.force = Respond(Model("dahl"), law, record.displacement);
    Generator generator(7);
    record = WithForceNoise(record, 0.015, generator);
    const FitResult fit = FitOne(record, testing::OfModel("dahl"));
    EXPECT_LT(fit.residuals.rms, 0.017) << alpha;
    EXPECT_NEAR(fit.law.shape_exponent, alpha, 0.1);
  }
}

TEST(Starts, OfFewSamplesInPartialSlipLeadToASmoothLaw) {
  // Under a sharper law all but one of them have slipped, and none shows a way back.
  for (const auto& [alpha, lambda, samples] :
       {std::tuple(0.6, 80.0, 400), {0.7, 60.0, 400}, {0.85, 30.0, 200}}) {
    const models::BranchLaw law{1e7, alpha, 10.0};
    const double reach = lambda * GrossSlipDisplacement(law);
    const History displacement = Cycling(Wave::kTriangle, reach, 3.25, samples);
    Generator generator(7);
    const Record record = WithForceNoise(testing::LoopOf(law, displacement), 0.02, generator);
    EXPECT_LT(FitOne(record).residuals.rms, 0.022) << alpha;
  }
}

TEST(Starts, OfManyTriangularCyclesBeyondSlipLeadToTheContact) {
  constexpr models::BranchLaw kMindlin{3e7, 1.0 / 3, 100.0};
  for (const double cycles : {8.25, 10.25, 20.75}) {
    const History displacement =
        Cycling(Wave::kTriangle, 5 * GrossSlipDisplacement(kMindlin), cycles, 60);
    Generator generator(7);
    const Record record = WithForceNoise(testing::LoopOf(kMindlin, displacement), 0.3, generator);
    const FitResult fit = FitOne(record);
    EXPECT_LT(fit.residuals.rms, 0.33) << cycles;
    EXPECT_LE(WorstError(fit.law, kMindlin), 0.02) << cycles;
  }
}

TEST(Starts, OfAnExponentThatIsGivenAreLookedForAtIt) {
  const models::BranchLaw law{4e7, 0.9, 40.0};
  Record record = MakeRecord(Cycling(Wave::kTriangle, 2e-5, 2.5, 20), {});
  record.force = Respond(Model("dahl"), law, record.displacement);
  Generator generator(7);
  record = WithForceNoise(record, 0.04, generator);
  FitOptions options = testing::OfModel("dahl");
  options.start = {{"alpha", law.shape_exponent}};
  EXPECT_LT(FitOne(record, options).residuals.rms, 0.06);
}

TEST(Starts, ThatAreGivenDoNotDecideOnTheInitialState) {
  const auto truth = ParametersOf(kLaw);
  EXPECT_EQ(FitOne(NoisyLoop(3), {.start = {truth.begin(), truth.end()}}).initial_state,
            models::InitialState::kVirgin);
}

TEST(Starts, OfTheFirstBranchAloneAreThoseOfAVirginContact) {
  EXPECT_EQ(
      FitOne(NoisyLoop(3), {.preparation = {.samples = loop::CountRange{.first = 2, .last = 26}}})
          .initial_state,
      models::InitialState::kVirgin);
}

TEST(InitialState, ThatTheRecordDoesNotDecideIsInTheInterval) {
  // A load from rest into slip, and two small strokes there: half the slip force, of a contact that
  // had moved, fits as well.
  constexpr models::BranchLaw kMindlin{2e6, 1.0 / 3, 10.0};
  History displacement;
  const std::array<double, 4> turns = {0.0, 2.6, 2.2, 2.4};
  for (std::size_t leg = 0; leg + 1 < turns.size(); ++leg) {
    for (int i = 0; i < 100; ++i) {
      displacement.push_back(5e-6 * std::lerp(turns[leg], turns[leg + 1], i / 100.0));
    }
  }
  int covering = 0;
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U, 5U, 6U}) {
    Generator generator(seed);
    const Record record = WithForceNoise(testing::LoopOf(kMindlin, displacement), 0.3, generator);
    const FitResult fit = FitOne(record);
    const ParameterEstimate& slip_force = *fit.Find("slip_force");
    covering += slip_force.upper95.value_or(kMindlin.slip_force) > 0.85 * kMindlin.slip_force;
  }
  EXPECT_GE(covering, 5);  // of six: the other has a valley of its own
}

// ---
// A model with one term more contains the model without it.

/// A loop whose knee is rounded by a force that a square root of the speed makes, which neither a
/// lag nor a viscous term describes: the likelihood of a lag has several minima.
Record RoundedByTheSpeed(std::uint64_t seed, double strength) {
  Generator generator(seed);
  Record record = Timed(WithForceNoise(Loop(3.0), 0.005 * kLaw.slip_force, generator), 0.01);
  const double fastest = std::abs(record.displacement[1] - record.displacement[0]) / 0.01;
  for (std::size_t i = 1; i + 1 < record.size(); ++i) {
    const double speed = (record.displacement[i + 1] - record.displacement[i - 1]) / 0.02 / fastest;
    record.force[i] +=
        strength * kLaw.slip_force * std::copysign(std::sqrt(std::abs(speed)), speed);
  }
  return record;
}

double RmsWith(const Record& record, const std::vector<std::string>& terms) {
  const RecordView view(record);
  Fitter fitter({.terms = terms});
  const FitResult& fit = fitter.Fit(view, Depth::kEstimate);
  EXPECT_TRUE(fit.converged) << fit.solver.message;
  return fit.rms;
}

TEST(NestedModels, NeverFitWorseThanTheModelsThatTheyContain) {
  // The search stops where a step gains 1e-10 of the cost.
  constexpr double kSame = 1 + 1e-8;
  for (const std::uint64_t seed : {1U, 3U, 6U}) {
    const Record record = RoundedByTheSpeed(seed, 0.1 * static_cast<double>(seed));
    const double alone = RmsWith(record, {});
    const double viscous = RmsWith(record, {"viscous"});
    const double lag = RmsWith(record, {"lag"});
    const double both = RmsWith(record, {"viscous", "lag"});
    const double all = RmsWith(record, {"viscous", "lag", "plateau_slope"});
    EXPECT_LE(viscous, kSame * alone) << seed;
    EXPECT_LE(both, kSame * viscous) << seed;
    EXPECT_LE(both, kSame * lag) << seed;
    EXPECT_LE(all, kSame * both) << seed;
  }
}

}  // namespace
}  // namespace mindahl::identification::starts_test
