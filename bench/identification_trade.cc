// What accuracy costs a fit: errors of σ, α and Tc and how often their 95 % intervals cover the
// truth, beside the time that a fit takes, for its depths and for every n-th sample; the table of
// docs/tradeoff.md.
//   build/release/bench/identification_trade [loops]
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <random>
#include <string>
#include <vector>

#include "mindahl/identification/fit.h"
#include "mindahl/loop/reversals.h"
#include "mindahl/models/excitation.h"
#include "mindahl/models/response.h"
#include "processor_time.h"

namespace {

using namespace mindahl;
using identification::Depth;
using identification::FitResult;
using identification::Fitter;
using identification::ParameterEstimate;
using loop::Record;
using models::BranchLaw;

constexpr BranchLaw kLaw{
    .tangential_stiffness = 5e7, .shape_exponent = 1.0 / 3, .slip_force = 20.0};
constexpr double kLambda = 1.2;  // amplitude over the displacement at gross slip
constexpr std::array kNames = {"sigma", "alpha", "slip_force"};
constexpr std::array kTruth = {kLaw.tangential_stiffness, kLaw.shape_exponent, kLaw.slip_force};
constexpr std::size_t kParameters = kNames.size();

/// Three cycles of 200 samples without noise.
Record CleanLoop() {
  Record record;
  record.displacement =
      models::MakeExcitation({.amplitude = kLambda * GrossSlipDisplacement(kLaw), .cycles = 3.0})
          .displacement;
  record.force.resize(record.size());
  const models::FrictionModel& model = *models::FindFrictionModel("mindlin");
  models::EvaluateForce(
      model, kLaw,
      models::MakeLoadingPath(record.displacement, loop::FindReversals(record.displacement, 0.0),
                              model.memory, {}),
      record.displacement, record.force);
  return record;
}

std::vector<Record> NoisyLoops(const Record& clean, double noise, std::size_t loops) {
  std::vector<Record> records;
  for (std::size_t i = 0; i < loops; ++i) {
    std::mt19937_64 engine(i + 1);
    std::normal_distribution<double> normal(0.0, noise * kLaw.slip_force);
    Record& record = records.emplace_back(clean);
    for (double& force : record.force) force += normal(engine);
  }
  return records;
}

/// How the same loops are given to the fit.
struct Way {
  std::string name;
  Depth depth = Depth::kFull;
  std::size_t every = 1;  // sample is kept
};

Record AsGiven(const Record& record, const Way& way) {
  Record given;
  for (std::size_t i = 0; i < record.size(); i += way.every) {
    given.displacement.push_back(record.displacement[i]);
    given.force.push_back(record.force[i]);
  }
  return given;
}

struct Outcome {
  double seconds = 0.0;  // a fit
  std::array<double, kParameters> squares{};
  std::array<std::size_t, kParameters> covered{};
  std::array<std::size_t, kParameters> intervals{};
};

Outcome FitAll(const std::vector<Record>& loops, const Way& way) {
  std::vector<Record> given;
  for (const Record& record : loops) given.push_back(AsGiven(record, way));
  Fitter fitter;
  const loop::RecordView first(given.front());
  fitter.Fit(first, way.depth);  // the workspace
  Outcome outcome;
  for (const Record& record : given) {
    const loop::RecordView view(record);
    const double begin = ProcessorTime();
    const FitResult& fit = fitter.Fit(view, way.depth);
    outcome.seconds += ProcessorTime() - begin;
    for (std::size_t k = 0; k < kParameters; ++k) {
      const ParameterEstimate& estimate = *fit.Find(kNames[k]);
      const double error = estimate.value - kTruth[k];
      outcome.squares[k] += error * error;
      if (!estimate.lower95 && !estimate.upper95) continue;
      ++outcome.intervals[k];
      if ((!estimate.lower95 || *estimate.lower95 <= kTruth[k]) &&
          (!estimate.upper95 || kTruth[k] <= *estimate.upper95)) {
        ++outcome.covered[k];
      }
    }
  }
  outcome.seconds /= static_cast<double>(given.size());
  return outcome;
}

void PrintRow(const Way& way, const Outcome& outcome, std::size_t loops, double full_seconds) {
  fmt::print("| {} |", way.name);
  const auto count = static_cast<double>(loops);
  for (std::size_t k = 0; k < kParameters; ++k) {
    const double error = std::sqrt(outcome.squares[k] / count);
    if (k == 1) {
      fmt::print(" {:.2g} |", error);
    } else {
      fmt::print(" {:.2g} % |", 100 * error / kTruth[k]);
    }
  }
  for (std::size_t k = 0; k < kParameters; ++k) {
    if (outcome.intervals[k] == 0) {
      fmt::print(" – |");
    } else {
      fmt::print(" {:.1f} % |", 100 * static_cast<double>(outcome.covered[k]) /
                                    static_cast<double>(outcome.intervals[k]));
    }
  }
  fmt::print(" {:.2g} |\n", outcome.seconds / full_seconds);
}

}  // namespace

int main(int argc, char** argv) {
  const int asked = argc > 1 ? std::atoi(argv[1]) : 1000;
  if (asked < 1 || argc > 2) {
    fmt::print(stderr, "usage: identification_trade [loops > 0]\n");
    return 2;
  }
  const auto loops = static_cast<std::size_t>(asked);
  const Way full{.name = "full"};
  const std::vector<Way> ways = {{.name = "estimate", .depth = Depth::kEstimate},
                                 {.name = "errors", .depth = Depth::kErrors},
                                 {.name = "intervals", .depth = Depth::kIntervals},
                                 full,
                                 {.name = "full, every 2nd sample", .every = 2},
                                 {.name = "full, every 4th", .every = 4},
                                 {.name = "full, every 8th", .every = 8},
                                 {.name = "full, every 16th", .every = 16}};
  const Record clean = CleanLoop();
  for (const double noise : {1e-2, 1e-4, 1e-8}) {
    fmt::print(
        "\n| noise {:g} of Tc | error of σ | α | Tc | interval covers σ | α | Tc | time, full = 1 "
        "|\n"
        "|---|---|---|---|---|---|---|---|\n",
        noise);
    const std::vector<Record> records = NoisyLoops(clean, noise, loops);
    const double full_seconds = FitAll(records, full).seconds;
    for (const Way& way : ways) PrintRow(way, FitAll(records, way), loops, full_seconds);
  }
}
