#include "identification/sample_loop.h"
#include "mindahl/identification/fit.h"
#include "recovery/recovered.h"
#include "support/prelude.h"

// A model with one term more contains the model without it.
namespace mindahl::identification::nested_models_test {
namespace {

using namespace loop;

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
  FitOptions options;
  options.terms = terms;
  const RecordView view(record);
  Fitter fitter(options);
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
}  // namespace mindahl::identification::nested_models_test
