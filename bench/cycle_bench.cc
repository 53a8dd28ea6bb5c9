// Cost of one cycle of a campaign: reading it, fitting it from where the last one ended, and the
// whole way from text to a table's row, each beside its floor.
//   build/release/bench/cycle_bench
#include <benchmark/benchmark.h>

#include <charconv>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "identification/problem/problem.h"
#include "identification/problem/scaled_records.h"
#include "identification/solve/search.h"
#include "mindahl/campaign/cycle_fit.h"
#include "mindahl/campaign/cycle_splitter.h"
#include "mindahl/campaign/tracker.h"
#include "mindahl/identification/fit.h"
#include "mindahl/io/record_reader.h"
#include "mindahl/loop/preparation.h"
#include "mindahl/models/contact_state.h"
#include "mindahl/models/excitation.h"

namespace {

using namespace mindahl;

using identification::Depth;
using identification::FitOptions;
using identification::Fitter;

constexpr std::size_t kCycles = 64;
constexpr std::size_t kSamplesPerCycle = 200;
constexpr models::BranchLaw kLaw{
    .tangential_stiffness = 5e7, .shape_exponent = 1.0 / 3, .slip_force = 20};

/// A noisy Mindlin contact at 1.2 times the gross-slip displacement, with time.
const loop::Record& Campaign() {
  static const loop::Record record = [] {
    const models::Excitation motion =
        models::MakeExcitation({.amplitude = 1.2 * models::GrossSlipDisplacement(kLaw),
                                .cycles = static_cast<double>(kCycles) + 1.5,
                                .samples_per_cycle = kSamplesPerCycle});
    loop::Record made;
    made.displacement = motion.displacement;
    models::ContactState contact(*models::FindFrictionModel("mindlin-dahl"), kLaw);
    std::mt19937_64 engine(1);
    std::normal_distribution<double> noise(0.0, 0.01 * kLaw.slip_force);
    for (const double x : made.displacement) {
      made.time.push_back(0.005 * static_cast<double>(made.time.size()));
      made.force.push_back(contact.Move(x) + noise(engine));
    }
    return made;
  }();
  return record;
}

/// Its whole cycles.
const std::vector<campaign::Cycle>& Cycles() {
  static const std::vector<campaign::Cycle> cycles = [] {
    std::vector<campaign::Cycle> split;
    const std::vector<std::size_t> lines(Campaign().size(), 1);
    campaign::CycleSplitter(0.0).Add(Campaign(), lines, split);
    return split;
  }();
  return cycles;
}

/// With the gate and the sense that are found once, as `mindahl track` does.
const FitOptions& OfSteadyCycles() {
  static const FitOptions options = [] {
    FitOptions made;
    made.initial_state = models::InitialState::kSteady;
    campaign::ChooseGate(Campaign(), made);
    return made;
  }();
  return options;
}

void CountCycles(benchmark::State& state, std::size_t cycles) {
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(cycles));
}

/// Each cycle from the last one's minimum.
void Continue(benchmark::State& state) {
  const auto depth = static_cast<Depth>(state.range(0));
  Fitter fitter(OfSteadyCycles());
  fitter.Fit(Cycles().front().record, depth);
  for (auto _ : state) {
    for (const campaign::Cycle& cycle : Cycles()) {
      benchmark::DoNotOptimize(fitter.Continue(cycle.record, depth).rms);
    }
  }
  CountCycles(state, Cycles().size());
}

/// The search alone: what is measured and its Jacobian, freed of what is linear, as often as the
/// minimum takes, of one cycle from the minima of the others.
void Search(benchmark::State& state) {
  const FitOptions& options = OfSteadyCycles();
  Fitter fitter(options);
  const loop::RecordView view(Cycles().front().record);
  loop::PreparedRecords prepared = loop::Prepare({&view, 1}, options.preparation);
  const identification::ScaledRecords data = identification::Scale(prepared, options);
  const identification::Problem problem(data, options, models::InitialState::kSteady);
  identification::ProjectedResidual residual(problem);
  std::vector<std::vector<double>> starts;
  for (const campaign::Cycle& cycle : Cycles()) {
    const models::BranchLaw law = fitter.Continue(cycle.record, Depth::kEstimate).law;
    std::vector<double>& start = starts.emplace_back();
    for (std::size_t p = 0; p < problem.parameters.size(); ++p) {
      start.push_back(problem.parameters[p].theta);
    }
    start[identification::kStiffness] =
        problem.parameters[identification::kStiffness].ToTheta(law.tangential_stiffness);
    start[identification::kShape] = law.shape_exponent;
    start[identification::kSlipForce] =
        problem.parameters[identification::kSlipForce].ToTheta(law.slip_force);
  }
  for (auto _ : state) {
    for (const std::vector<double>& start : starts) {
      benchmark::DoNotOptimize(
          Solve(residual, start, {.max_iterations = options.max_iterations}).sum_of_squares);
    }
  }
  CountCycles(state, starts.size());
}

/// The campaign as a file of three columns of 17 digits, deleted at the end.
class CampaignFile {
 public:
  CampaignFile()
      : path_(std::filesystem::temp_directory_path() /
              ("mindahl_cycle_bench_" + std::to_string(std::random_device()()) + ".csv")) {
    std::ofstream file(path_);
    file.precision(17);
    file << "time [s],displacement [m],force [N]\n";
    const loop::Record& record = Campaign();
    for (std::size_t i = 0; i < record.size(); ++i) {
      file << record.time[i] << ',' << record.displacement[i] << ',' << record.force[i] << '\n';
    }
    if (!file.flush()) throw std::runtime_error("cannot write " + path_.string());
  }
  ~CampaignFile() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  CampaignFile(const CampaignFile&) = delete;
  CampaignFile& operator=(const CampaignFile&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// The numbers' digits alone, from memory.
void ReadDigits(benchmark::State& state) {
  const CampaignFile file;
  std::ifstream stream(file.path(), std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  const std::size_t first = text.find('\n') + 1;
  for (auto _ : state) {
    double sum = 0.0;
    const char* const end = text.data() + text.size();
    for (const char* at = text.data() + first; at < end; ++at) {
      double value = 0.0;
      at = std::from_chars(at, end, value).ptr;
      sum += value;
    }
    benchmark::DoNotOptimize(sum);
  }
  CountCycles(state, Cycles().size());
}

void Read(benchmark::State& state) {
  const CampaignFile file;
  for (auto _ : state) {
    io::RecordStream stream(file.path());
    io::Samples samples;
    while (stream.Next(samples)) benchmark::DoNotOptimize(samples.force.data());
  }
  CountCycles(state, Cycles().size());
}

/// From the text of a file to the rows of a table.
void Track(benchmark::State& state) {
  const CampaignFile file;
  for (auto _ : state) {
    std::size_t characters = 0;
    campaign::Tracker tracker({.fit = OfSteadyCycles()},
                              [&](std::span<const campaign::CycleFit> fits) {
                                for (const campaign::CycleFit& fit : fits) {
                                  characters += campaign::CycleTableRow(fit, 0.0).size();
                                }
                              });
    io::RecordStream stream(file.path());
    io::Samples samples;
    while (stream.Next(samples)) {
      tracker.Add({samples.displacement, samples.force, samples.time}, samples.lines);
    }
    tracker.Finish();
    benchmark::DoNotOptimize(characters);
  }
  CountCycles(state, Cycles().size());
}

BENCHMARK(Search)->Name("floor/search")->Unit(benchmark::kMicrosecond);
BENCHMARK(Continue)
    ->Name("fit/estimate")
    ->Arg(static_cast<int>(Depth::kEstimate))
    ->Unit(benchmark::kMicrosecond);
BENCHMARK(Continue)
    ->Name("fit/errors")
    ->Arg(static_cast<int>(Depth::kErrors))
    ->Unit(benchmark::kMicrosecond);
BENCHMARK(ReadDigits)->Name("floor/digits")->Unit(benchmark::kMicrosecond);
BENCHMARK(Read)->Name("read/text")->Unit(benchmark::kMicrosecond);
BENCHMARK(Track)
    ->Name("track/text_to_rows")
    ->Unit(benchmark::kMicrosecond)
    ->MeasureProcessCPUTime();

}  // namespace
