// Cost of friction under a varying load, per sample, beside the exact kernel for a constant one.
//   cmake --preset release && cmake --build --preset release &&
//   build/release/bench/variable_load_bench
#include <benchmark/benchmark.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "mindahl/loop/reversals.h"
#include "mindahl/models/excitation.h"
#include "mindahl/models/response.h"
#include "mindahl/models/variable_load.h"

namespace {

using namespace mindahl;
using namespace mindahl::loop;
using namespace mindahl::models;

constexpr double kCycles = 50;
constexpr std::size_t kSamplesPerCycle = 200;
constexpr double kMeanLoad = 50;  // [N]

LoadDependentLaw Law(double shape_exponent) {
  return {.friction_coefficient = 0.3,
          .reference_load = kMeanLoad,
          .reference_stiffness = 4.8e7,
          .shape_exponent = shape_exponent};
}

std::vector<double> Displacements(const BranchLaw& law) {
  return MakeExcitation({.amplitude = 1.2 * GrossSlipDisplacement(law),
                         .cycles = kCycles,
                         .samples_per_cycle = kSamplesPerCycle})
      .displacement;
}

/// With the path and its reversals found beforehand, as in a fit.
void Constant(benchmark::State& state, double shape_exponent) {
  const BranchLaw law = ReferenceLaw(Law(shape_exponent));
  const std::vector<double> x = Displacements(law);
  const FrictionModel& model = *FindFrictionModel("mindlin-dahl");
  const LoadingPath path = MakeLoadingPath(x, FindReversals(x, 0.0), model.memory, {});
  std::vector<double> force(x.size());
  for (auto _ : state) {
    EvaluateForce(model, law, path, x, force);
    benchmark::DoNotOptimize(force.data());
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(x.size()));
}

/// N = N_mean·(1 + swing·sin 2ωt)
void Varying(benchmark::State& state, double shape_exponent, double swing) {
  const LoadDependentLaw law = Law(shape_exponent);
  const std::vector<double> x = Displacements(ReferenceLaw(law));
  std::vector<double> load;
  for (std::size_t i = 0; i < x.size(); ++i) {
    load.push_back(kMeanLoad * (1 + swing * std::sin(4 * 3.141592653589793 *
                                                     static_cast<double>(i) / kSamplesPerCycle)));
  }
  std::vector<double> force(x.size());
  for (auto _ : state) {
    EvaluateForceUnderLoad(law, x, load, force);
    benchmark::DoNotOptimize(force.data());
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(x.size()));
}

[[maybe_unused]] const int kRegistered = [] {
  struct Shape {
    const char* name;
    double exponent;
  };
  for (const Shape shape : {Shape{"third", 1.0 / 3}, Shape{"0.4", 0.4}}) {
    const std::string alpha = std::string("/alpha_") + shape.name;
    const double exponent = shape.exponent;
    benchmark::RegisterBenchmark(("constant_load_kernel" + alpha).c_str(),
                                 [=](benchmark::State& state) { Constant(state, exponent); });
    benchmark::RegisterBenchmark(("varying_load/swing_0" + alpha).c_str(),
                                 [=](benchmark::State& state) { Varying(state, exponent, 0.0); });
    benchmark::RegisterBenchmark(("varying_load/swing_0.3" + alpha).c_str(),
                                 [=](benchmark::State& state) { Varying(state, exponent, 0.3); });
  }
  return 0;
}();

}  // namespace
