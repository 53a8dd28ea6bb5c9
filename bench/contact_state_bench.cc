// Cost of a contact that is moved step by step, per step, beside the same record evaluated at once:
// by the kernel alone (its path found beforehand, as in a fit) and with its path.
//   cmake --preset release && cmake --build --preset release &&
//   build/release/bench/contact_state_bench
#include <benchmark/benchmark.h>

#include <cstddef>
#include <cstdint>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "mindahl/loop/reversals.h"
#include "mindahl/models/contact_state.h"
#include "mindahl/models/excitation.h"
#include "mindahl/models/response.h"

namespace mindahl::models {

using models::FrictionModel;
using models::SeriesSpring;

namespace {

constexpr double kSlipDisplacement = 4.7e-7;  // [m]

models::BranchLaw LawOf(const FrictionModel& model) {
  return {4.8e7, model.shape_exponent.value_or(0.4), 15};
}

/// 50 cycles of 200 samples, into slip: a reversal in a hundred steps.
std::vector<double> Sine() {
  return models::MakeExcitation(
             {.amplitude = 1.2 * kSlipDisplacement, .cycles = 50, .samples_per_cycle = 200})
      .displacement;
}

/// White: two reversals in three steps.
std::vector<double> White() {
  std::mt19937_64 generator(1);
  std::vector<double> displacement(10001);
  for (double& at : displacement) {
    at = kSlipDisplacement * (static_cast<double>(generator() >> 11) * 0x1p-52 - 1);
  }
  return displacement;
}

void ReportPerStep(benchmark::State& state, std::size_t steps) {
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(steps));
}

void Kernel(benchmark::State& state, const FrictionModel& model, const std::vector<double>& x,
            const SeriesSpring& rig) {
  const models::LoadingPath path =
      models::MakeLoadingPath(x, loop::FindReversals(x, 0.0), model.memory, {});
  std::vector<double> force(x.size());
  for (auto _ : state) {
    models::EvaluateForce(model, LawOf(model), path, x, force, rig);
    benchmark::DoNotOptimize(force.data());
  }
  ReportPerStep(state, x.size());
}

void KernelWithPath(benchmark::State& state, const FrictionModel& model,
                    const std::vector<double>& x, const SeriesSpring& rig) {
  std::vector<double> force(x.size());
  for (auto _ : state) {
    const models::LoadingPath path =
        models::MakeLoadingPath(x, loop::FindReversals(x, 0.0), model.memory, {});
    models::EvaluateForce(model, LawOf(model), path, x, force, rig);
    benchmark::DoNotOptimize(force.data());
  }
  ReportPerStep(state, x.size());
}

void Move(benchmark::State& state, const FrictionModel& model, const std::vector<double>& x,
          const SeriesSpring& rig) {
  models::ContactState contact(model, LawOf(model), {.rig = rig});
  std::vector<double> force(x.size());
  for (auto _ : state) {
    contact.Reset();
    for (std::size_t i = 0; i < x.size(); ++i) force[i] = contact.Move(x[i]);
    benchmark::DoNotOptimize(force.data());
  }
  ReportPerStep(state, x.size());
}

/// A trial step before every step, with its stiffness: what an implicit integrator asks for.
void PeekAndMove(benchmark::State& state, const FrictionModel& model, const std::vector<double>& x,
                 const SeriesSpring& rig) {
  models::ContactState contact(model, LawOf(model), {.rig = rig});
  std::vector<double> force(x.size());
  for (auto _ : state) {
    contact.Reset();
    for (std::size_t i = 0; i < x.size(); ++i) {
      force[i] = contact.Peek(x[i]);
      contact.Move(x[i]);
      force[i] += contact.TangentStiffness();
    }
    benchmark::DoNotOptimize(force.data());
  }
  ReportPerStep(state, x.size());
}

[[maybe_unused]] const int kRegistered = [] {
  using Run = void (*)(benchmark::State&, const FrictionModel&, const std::vector<double>&,
                       const SeriesSpring&);
  struct Kind {
    const char* name;
    Run run;
  };
  for (const auto& [excitation, x] : {std::pair{"sine", Sine()}, std::pair{"white", White()}}) {
    for (const FrictionModel& model : models::FrictionModels()) {
      for (const auto& [suffix, rig] :
           {std::pair{"", SeriesSpring{}}, std::pair{"_in_series", SeriesSpring{4.8e7}}}) {
        for (const auto& [name, run] :
             {Kind{"kernel", Kernel}, Kind{"path_and_kernel", KernelWithPath}, Kind{"move", Move},
              Kind{"peek_stiffness_and_move", PeekAndMove}}) {
          const std::string title =
              std::string(excitation) + suffix + '/' + std::string(model.name) + '/' + name;
          benchmark::RegisterBenchmark(
              title.c_str(), [run = run, &model, x = x, rig = rig](benchmark::State& state) {
                run(state, model, x, rig);
              });
        }
      }
    }
  }
  return 0;
}();

}  // namespace
}  // namespace mindahl::models
