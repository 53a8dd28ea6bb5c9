// Cost of a model along a loading path, per sample, beside the floor: reading a displacement and
// writing a force (memory), and the least arithmetic of Mindlin's law (a square root and a
// division).
//   cmake --preset release && cmake --build --preset release && build/release/bench/response_bench
#include <benchmark/benchmark.h>

#include <cmath>
#include <string>
#include <vector>

#include "gradient_buffers.h"
#include "mindahl/loop/reversals.h"
#include "mindahl/models/excitation.h"
#include "mindahl/models/response.h"
#include "models/normalized_response.h"

namespace {

using namespace mindahl;
using namespace mindahl::loop;
using namespace mindahl::models;

constexpr BranchLaw kLaw{
    .tangential_stiffness = 4.8e7, .shape_exponent = 1.0 / 3, .slip_force = 15};
constexpr std::size_t kSamplesPerCycle = 200;

std::vector<double> Displacements(double cycles) {
  return MakeExcitation(
             {.amplitude = 1.2 * 4.7e-7, .cycles = cycles, .samples_per_cycle = kSamplesPerCycle})
      .displacement;
}

void ReportPerSample(benchmark::State& state, std::size_t samples) {
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(samples));
}

void FloorMemory(benchmark::State& state) {
  const std::vector<double> x = Displacements(50);
  std::vector<double> force(x.size());
  for (auto _ : state) {
    for (std::size_t i = 0; i < x.size(); ++i) force[i] = 4.8e7 * x[i];
    benchmark::DoNotOptimize(force.data());
    benchmark::ClobberMemory();
  }
  ReportPerSample(state, x.size());
}

void FloorSquareRoot(benchmark::State& state) {
  const std::vector<double> x = Displacements(50);
  std::vector<double> force(x.size());
  for (auto _ : state) {
    for (std::size_t i = 0; i < x.size(); ++i) {
      const double z = 1 - std::abs(x[i]) * 1e6;
      force[i] = x[i] / (1 + z * std::sqrt(z));
    }
    benchmark::DoNotOptimize(force.data());
    benchmark::ClobberMemory();
  }
  ReportPerSample(state, x.size());
}

/// As stiff as the contact: neither gives way alone.
constexpr SeriesSpring kRig{.stiffness = kLaw.tangential_stiffness};

void Force(benchmark::State& state, const FrictionModel& model, double shape_exponent,
           const SeriesSpring& rig) {
  const std::vector<double> x = Displacements(50);
  const LoadingPath path = MakeLoadingPath(x, FindReversals(x, 0.0), model.memory, {});
  BranchLaw law = kLaw;
  law.shape_exponent = shape_exponent;
  std::vector<double> force(x.size());
  for (auto _ : state) {
    EvaluateForce(model, law, path, x, force, rig);
    benchmark::DoNotOptimize(force.data());
  }
  ReportPerSample(state, x.size());
}

void Gradient(benchmark::State& state, const FrictionModel& model, const SeriesSpring& rig) {
  const std::vector<double> x = Displacements(50);
  const LoadingPath path = MakeLoadingPath(x, FindReversals(x, 0.0), model.memory, {});
  GradientBuffers buffers(x.size());
  const NormalizedLaw law{.rate = kLaw.tangential_stiffness / kLaw.slip_force,
                          .shape_exponent = kLaw.shape_exponent,
                          .spring_travel = kLaw.slip_force / rig.stiffness};
  for (auto _ : state) {
    EvaluateNormalizedForce(model, law, path, x, buffers.t, buffers.gradient());
    benchmark::DoNotOptimize(buffers.columns.data());
  }
  ReportPerSample(state, x.size());
}

void Path(benchmark::State& state) {
  const std::vector<double> x = Displacements(50);
  for (auto _ : state) {
    const std::vector<std::size_t> reversals = FindReversals(x, 0.0);
    benchmark::DoNotOptimize(MakeLoadingPath(x, reversals, Memory::kReturnPoint, {}));
  }
  ReportPerSample(state, x.size());
}

[[maybe_unused]] const int kRegistered = [] {
  benchmark::RegisterBenchmark("floor/memory", FloorMemory);
  benchmark::RegisterBenchmark("floor/square_root_and_division", FloorSquareRoot);
  benchmark::RegisterBenchmark("path/reversals_and_branches", Path);
  for (const FrictionModel& model : FrictionModels()) {
    const double shape_exponent = model.shape_exponent.value_or(0.4);
    const auto add = [&](const std::string& suffix, const SeriesSpring& rig) {
      benchmark::RegisterBenchmark(("force" + suffix).c_str(),
                                   [&model, shape_exponent, rig](benchmark::State& state) {
                                     Force(state, model, shape_exponent, rig);
                                   });
      benchmark::RegisterBenchmark(
          ("gradient" + suffix).c_str(),
          [&model, rig](benchmark::State& state) { Gradient(state, model, rig); });
    };
    add("/" + std::string(model.name), {});
    add("_in_series/" + std::string(model.name), kRig);
  }
  return 0;
}();

}  // namespace
