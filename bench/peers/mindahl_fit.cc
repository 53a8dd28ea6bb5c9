// Times fits of one record, for comparison with other programs: bench/peers/compare.py runs it.
//   mindahl_fit RECORD.csv REPEATS
#include <algorithm>
#include <cstdlib>
#include <functional>
#include <iostream>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "gradient_buffers.h"
#include "mindahl/core/version.h"
#include "mindahl/identification/fit.h"
#include "mindahl/io/record_reader.h"
#include "mindahl/loop/reversals.h"
#include "models/normalized_response.h"
#include "processor_time.h"

namespace {

using namespace mindahl;
using nlohmann::json;

using namespace mindahl::identification;
using namespace mindahl::loop;
using namespace mindahl::models;

/// How much of the answer is asked for, of a fitter that has fitted before.
const std::vector<std::pair<const char*, Depth>> kDepths = {
    {"estimate", Depth::kEstimate}, {"intervals", Depth::kIntervals}, {"full", Depth::kFull}};

double MedianMilliseconds(int repeats, const std::function<void()>& call) {
  std::vector<double> times;
  for (int i = 0; i < repeats; ++i) {
    const double begin = ProcessorTime();
    call();
    times.push_back(1e3 * (ProcessorTime() - begin));
  }
  std::ranges::sort(times);
  const std::size_t middle = times.size() / 2;
  return times.size() % 2 == 1 ? times[middle] : (times[middle - 1] + times[middle]) / 2;
}

/// The floor of any fit: reversals, branches, forces and their derivatives once.
double OneGradientMilliseconds(int repeats, const Record& record, const BranchLaw& law) {
  const FrictionModel& model = *FindFrictionModel("mindlin-dahl");
  GradientBuffers buffers(record.size());
  const NormalizedLaw normalized{.rate = law.tangential_stiffness / law.slip_force,
                                 .shape_exponent = law.shape_exponent};
  return MedianMilliseconds(repeats, [&] {
    const LoadingPath path = MakeLoadingPath(
        record.displacement, FindReversals(record.displacement, 0.0), model.memory, {});
    EvaluateNormalizedForce(model, normalized, path, record.displacement, buffers.t,
                            buffers.gradient());
  });
}

json Parameters(const FitResult& fit) {
  json parameters;
  for (const char* name : {"sigma", "alpha", "slip_force"}) {
    const ParameterEstimate* estimate = fit.Find(name);
    parameters[name] = {{"value", estimate->value}, {"standard_error", nullptr}};
    if (estimate->standard_error) parameters[name]["standard_error"] = *estimate->standard_error;
  }
  return parameters;
}

}  // namespace

int main(int argc, char** argv) {
  const int repeats = argc == 3 ? std::atoi(argv[2]) : 0;
  if (repeats < 1) {
    std::cerr << "usage: mindahl_fit RECORD.csv REPEATS\n";
    return 2;
  }
  const Record record = io::ReadRecord(argv[1]).record;
  json depths;
  Fitter fitter;
  for (const auto& [name, depth] : kDepths) {
    const FitResult fit = fitter.Fit(record, depth);
    depths[name] = {{"converged", fit.converged},
                    {"parameters", Parameters(fit)},
                    {"median_ms", MedianMilliseconds(repeats, [&] { fitter.Fit(record, depth); })}};
  }
  const BranchLaw law = fitter.Fit(record).law;
  std::cout << json{{"program", "mindahl " + std::string(Version())},
                    {"depths", depths},
                    {"one_gradient_ms", OneGradientMilliseconds(100 * repeats, record, law)}}
            << '\n';
}
