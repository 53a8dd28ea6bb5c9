// Cost of a whole fit, starts, solver, profile and all, beside its floor: one evaluation of the
// model with its gradient on the same record.
//   build/release/bench/fit_bench
#include <benchmark/benchmark.h>

#include <random>
#include <vector>

#include "gradient_buffers.h"
#include "mindahl/identification/fit.h"
#include "mindahl/loop/reversals.h"
#include "mindahl/models/excitation.h"
#include "models/normalized_response.h"

namespace {

using namespace mindahl;
using namespace mindahl::loop;
using namespace mindahl::models;
using namespace mindahl::identification;

constexpr BranchLaw kLaw{
    .tangential_stiffness = 4.8e7, .shape_exponent = 1.0 / 3, .slip_force = 15};

/// A noisy Mindlin loop: `cycles` of 200 samples at 1.2 times the gross-slip displacement.
Record NoisyLoop(std::int64_t cycles) {
  Record record;
  record.displacement = MakeExcitation({.amplitude = 1.2 * GrossSlipDisplacement(kLaw),
                                        .cycles = static_cast<double>(cycles)})
                            .displacement;
  const FrictionModel& model = *FindFrictionModel("mindlin");
  record.force.resize(record.displacement.size());
  EvaluateForce(model, kLaw,
                MakeLoadingPath(record.displacement, FindReversals(record.displacement, 0.0),
                                model.memory, {}),
                record.displacement, record.force);
  std::mt19937_64 engine(1);
  std::normal_distribution<double> noise(0.0, 0.005 * kLaw.slip_force);
  for (double& force : record.force) force += noise(engine);
  return record;
}

void FitLoop(benchmark::State& state) {
  const Record record = NoisyLoop(state.range(0));
  for (auto _ : state) benchmark::DoNotOptimize(Fit({&record, 1}, {}));
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(record.size()));
}

void OneGradient(benchmark::State& state) {
  const Record record = NoisyLoop(state.range(0));
  const FrictionModel& model = *FindFrictionModel("mindlin-dahl");
  GradientBuffers buffers(record.size());
  const NormalizedLaw normalized{.rate = kLaw.tangential_stiffness / kLaw.slip_force,
                                 .shape_exponent = kLaw.shape_exponent};
  for (auto _ : state) {
    const LoadingPath path = MakeLoadingPath(
        record.displacement, FindReversals(record.displacement, 0.0), model.memory, {});
    EvaluateNormalizedForce(model, normalized, path, record.displacement, buffers.t,
                            buffers.gradient());
    benchmark::DoNotOptimize(buffers.columns.data());
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(record.size()));
}

BENCHMARK(OneGradient)->Name("floor/one_gradient")->Arg(3)->Arg(50)->Unit(benchmark::kMillisecond);
BENCHMARK(FitLoop)->Name("fit/cycles")->Arg(3)->Arg(50)->Unit(benchmark::kMillisecond);

}  // namespace
