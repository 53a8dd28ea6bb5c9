// Cost of every method from displacement to force, per sample of 50 cycles with gross slip, at a
// representative resolution; and beside them the floor: reading a
// displacement and writing a force (memory), and a square root and a division (the least of
// Mindlin's law).
//   cmake --preset release && cmake --build --preset release && build/release/bench/methods_bench
#include <benchmark/benchmark.h>

#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "mindahl/methods/method.h"
#include "mindahl/models/branch_law.h"
#include "mindahl/models/excitation.h"

namespace {

using namespace mindahl;
using namespace mindahl::models;
using namespace mindahl::methods;

constexpr BranchLaw kLaw{
    .tangential_stiffness = 4.8e7, .shape_exponent = 1.0 / 3, .slip_force = 15};

std::vector<double> Displacements() {
  return MakeExcitation({.amplitude = 1.2 * GrossSlipDisplacement(kLaw),
                         .cycles = 50,
                         .samples_per_cycle = 200})
      .displacement;
}

template <typename Evaluate>
void Measure(benchmark::State& state, Evaluate&& evaluate) {
  const std::vector<double> x = Displacements();
  std::vector<double> force(x.size());
  for (auto _ : state) {
    evaluate(x, force);
    benchmark::DoNotOptimize(force.data());
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(x.size()));
}

void FloorMemory(benchmark::State& state) {
  Measure(state, [](const std::vector<double>& x, std::vector<double>& force) {
    for (std::size_t i = 0; i < x.size(); ++i) force[i] = 4.8e7 * x[i];
  });
}

void FloorSquareRoot(benchmark::State& state) {
  Measure(state, [](const std::vector<double>& x, std::vector<double>& force) {
    for (std::size_t i = 0; i < x.size(); ++i) {
      const double z = 1 - std::abs(x[i]) * 1e6;
      force[i] = x[i] / (1 + z * std::sqrt(z));
    }
  });
}

void RegisterMethod(const Method& method, const FrictionModel& model, std::size_t steps) {
  std::string name = std::string(method.name) + "/" + std::string(model.name);
  if (!method.steps.empty()) name += "/" + std::to_string(steps);
  benchmark::RegisterBenchmark(name.c_str(), [&method, &model, steps](benchmark::State& state) {
    const Evaluator evaluate = Prepare(method, model, kLaw, {.steps = steps});
    Measure(state, [&](const std::vector<double>& x, std::vector<double>& force) {
      evaluate({.displacement = x}, force);
    });
  });
}

[[maybe_unused]] const int kRegistered = [] {
  benchmark::RegisterBenchmark("floor/memory", FloorMemory);
  benchmark::RegisterBenchmark("floor/square_root_and_division", FloorSquareRoot);
  for (const Method& method : Methods()) {
    for (const std::string_view model : {"mindlin", "dahl"}) {
      const FrictionModel& served = *FindFrictionModel(model);
      if (method.masing_only && served.memory != Memory::kReturnPoint) continue;
      RegisterMethod(method, served, method.default_steps);
    }
  }
  return 0;
}();

}  // namespace
