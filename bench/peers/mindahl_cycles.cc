// Times the fits of a record's cycles, each from where the last one ended, for comparison with
// other programs: bench/peers/campaign.py runs it.
//   mindahl_cycles RECORD.csv REPEATS
#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "mindahl/campaign/cycle_splitter.h"
#include "mindahl/identification/fit.h"
#include "mindahl/io/record_reader.h"
#include "processor_time.h"

namespace {

using namespace mindahl;

using campaign::Cycle;
using identification::Depth;

std::vector<Cycle> CyclesOf(const loop::Record& record, double gate) {
  std::vector<Cycle> cycles;
  const std::vector<std::size_t> lines(record.size(), 1);
  campaign::CycleSplitter(gate).Add(record, lines, cycles);
  return cycles;
}

/// Least mean time of a cycle [µs] of so many runs over all.
double LeastMicroseconds(const std::vector<Cycle>& cycles,
                         const identification::FitOptions& options, Depth depth, int repeats) {
  identification::Fitter fitter(options);
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < repeats; ++i) {
    const double begin = ProcessorTime();
    for (const Cycle& cycle : cycles) fitter.Continue(cycle.record, depth);
    least = std::min(least, ProcessorTime() - begin);
  }
  return 1e6 * least / static_cast<double>(cycles.size());
}

}  // namespace

int main(int argc, char** argv) {
  const int repeats = argc == 3 ? std::atoi(argv[2]) : 0;
  if (repeats < 1) {
    std::cerr << "usage: mindahl_cycles RECORD.csv REPEATS\n";
    return 2;
  }
  const loop::Record record = io::ReadRecord(argv[1]).record;
  // Gate and sense are found once, as `mindahl track` does.
  identification::FitOptions options;
  options.initial_state = models::InitialState::kSteady;
  campaign::ChooseGate(record, options);
  const std::vector<Cycle> cycles = CyclesOf(record, *options.preparation.reversal_gate);
  if (cycles.empty()) {
    std::cerr << argv[1] << ": no cycle from one turning point to the next but one\n";
    return 2;
  }
  nlohmann::json times = {{"cycles", cycles.size()}};
  for (const auto& [name, depth] :
       {std::pair("estimate_us", Depth::kEstimate), std::pair("errors_us", Depth::kErrors)}) {
    times[name] = LeastMicroseconds(cycles, options, depth, repeats);
  }
  std::cout << times << '\n';
}
