#include "mindahl/identification/fit_result.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/probability.h"
#include "mindahl/identification/terms.h"
#include "mindahl/models/steady_loop.h"

namespace mindahl::identification {

const ParameterEstimate* FindEstimate(const std::vector<ParameterEstimate>& parameters,
                                      std::string_view name) {
  const auto found = std::ranges::find(parameters, name, &ParameterEstimate::name);
  return found == parameters.end() ? nullptr : &*found;
}

const ParameterEstimate* FitResult::FindOf(const RecordFit& record, std::string_view name) const {
  const auto place = &record - records.data();
  return records.size() == 1 ? Find(name) : Find(fmt::format("{}_{}", name, place + 1));
}

const Finding* FitResult::FindFinding(FindingCode code, std::string_view kind) const {
  const auto found = std::ranges::find_if(findings, [&](const Finding& finding) {
    return finding.code == std::string_view(code) && (kind.empty() || finding.kind == kind);
  });
  return found == findings.end() ? nullptr : &*found;
}

const RecordFit& FitResult::WidestRecord() const {
  return *std::ranges::max_element(records, {}, [this](const RecordFit& fit) {
    return fit.facts.amplitude * std::pow(fit.load_ratio, load_exponent - 1);
  });
}

double FitResult::EncoderStep() const {
  double step = 0.0;
  for (const RecordFit& record : records) step = std::max(step, record.encoder_step);
  return step;
}

double FitResult::PeakForce() const {
  const RecordFit& widest = WidestRecord();
  // The force of a joint follows its load: under the mean one it is that of the law's steady loop.
  if (is_scaled_by_load()) return models::SteadyPeakForce(*model, law, widest.facts.amplitude);
  return widest.facts.peak_force / widest.load_ratio;
}

bool FitResult::is_scaled_by_load() const {
  return !records.empty() && WidestRecord().load_varies && model->memory == models::Memory::kNone;
}

std::optional<double> FitResult::MeasuredHalfGap() const {
  if (is_scaled_by_load() || response != loop::Channel::kForce) return std::nullopt;
  const RecordFit& widest = WidestRecord();
  if (!(widest.facts.half_gap > 0.0)) return std::nullopt;
  return *widest.facts.half_gap / widest.load_ratio;
}

double FitResult::MisfitScale() const {
  const RecordFit& widest = WidestRecord();
  if (response == loop::Channel::kDisplacement) return widest.facts.amplitude;
  const std::optional<double> half_gap = MeasuredHalfGap();
  return half_gap && loop::HasSlipped(widest.facts) ? *half_gap : PeakForce();
}

std::size_t FitResult::CountFreeParameters() const {
  const auto held =
      std::ranges::count(parameters, ParameterStatus::kFixed, &ParameterEstimate::status);
  return parameters.size() - static_cast<std::size_t>(held);
}

double ContactAmplitude(const FitResult& fit, const models::BranchLaw& law, double amplitude) {
  const ParameterEstimate* const gap = fit.Find("backlash");
  if (gap != nullptr) amplitude = std::max(amplitude - gap->value / 2, 0.0);
  return models::ContactAmplitude(*fit.model, law, fit.rig, amplitude);
}

constexpr double kUnbounded = std::numeric_limits<double>::infinity();

double FitResult::ErrorOf(const ParameterEstimate& estimate) const {
  return std::max(ErrorTowards(estimate, -kUnbounded), ErrorTowards(estimate, kUnbounded));
}

double FitResult::ErrorTowards(const ParameterEstimate& estimate, double value) const {
  if (estimate.status == ParameterStatus::kFixed) return 0.0;
  const std::optional<double>& end = value < estimate.value ? estimate.lower95 : estimate.upper95;
  const bool is_positive = TermOfParameter(estimate.name)->positive;
  const bool has_error = estimate.standard_error || estimate.includes_discrepancy;
  if (!has_error || !end || (is_positive && !(*end > 0))) return kUnbounded;
  const double way = is_positive ? estimate.value * std::abs(std::log(*end / estimate.value))
                                 : std::abs(*end - estimate.value);
  const double error = way / StudentQuantile(degrees_of_freedom, confidence);
  // The standard error itself where the interval is that of the parabola, but for rounding.
  constexpr double kRounding = 1e-9;
  const double standard = estimate.standard_error.value_or(0.0);
  return error > standard * (1 + kRounding) ? error : standard;
}

}  // namespace mindahl::identification
