#include "identification/diagnosis/hull.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/extremes.h"
#include "core/probability.h"
#include "identification/solve/search.h"
#include "mindahl/contact/mindlin_dahl_mapping.h"

namespace mindahl::identification {

using contact::kMindlinShapeExponent;

void IncludeLaw(const models::BranchLaw& law, ParameterEstimates& parameters) {
  Include(parameters[kShape], {.lower = law.shape_exponent, .upper = law.shape_exponent});
  for (const auto& [p, value] :
       {std::pair(kStiffness, law.tangential_stiffness), std::pair(kSlipForce, law.slip_force)}) {
    ParameterEstimate& estimate = parameters[p];
    const double ratio = value / estimate.value;
    const bool is_closed = estimate.lower95 && estimate.upper95;
    Include(estimate, {.lower = is_closed ? ratio * *estimate.lower95 : value,
                       .upper = is_closed ? ratio * *estimate.upper95 : value});
  }
}

std::vector<Finding> IncludeCompliantRig(const Estimates& fitted, ParameterEstimates& parameters) {
  const Problem& problem = fitted.problem();
  const Solution& best = fitted.solution();
  const ParameterEstimate& shape = parameters[kShape];
  // If the contact is Mindlin's and the rig is rigid, 1/3 exceeds the upper end of the 95 %
  // interval with a probability of 1/40, and exceeds it by this margin with one of 1/600.
  constexpr double kFurther = 1.5;  // of the distance from the value to the end
  const double degrees = fitted.noise().degrees_of_freedom(problem.parameters.free().size());
  const double to_95 = StudentQuantile(degrees, 0.95) / fitted.quantile();
  // The law of a load that varies or of an imposed force has no rig; a prior says what α is.
  if (problem.data->load_varies || problem.data->is_forced() || problem.parameters.has_rig() ||
      problem.parameters[kShape].has_prior() || !shape.upper95 ||
      !(shape.value + kFurther * to_95 * (*shape.upper95 - shape.value) < kMindlinShapeExponent)) {
    return {};
  }
  constexpr double kStiffer = 0.1;  // of the compliance is the contact's
  FitOptions with_rig = fitted.options();
  with_rig.terms.emplace_back("rig_stiffness");
  with_rig.fixed["alpha"] = kMindlinShapeExponent;
  with_rig.start.clear();
  Candidate sprung{.problem = {*problem.data, with_rig, problem.initial_state}};
  // A rig as stiff as the fitted contact, before one ten times stiffer, with the terms that it has.
  std::vector<double> beside = best.theta;
  beside[kRig] = best.theta[kStiffness] + std::log(1 / (1 - kStiffer));
  beside[kStiffness] -= std::log(kStiffer);
  beside[kShape] = kMindlinShapeExponent;
  sprung.starts.push_back(std::move(beside));
  Descend(sprung, with_rig);
  const Solution& solution = sprung.solution;
  // Both have as many parameters: ΔAICc is 2 ln Λ.
  const double loss = fitted.FStatistic(kShape, solution.sum_of_squares);
  if (!solution.converged || !(loss < fitted.thresholds().indistinguishable)) return {};
  const Parameters& of_rig = sprung.problem.parameters;
  const models::SeriesSpring rig = of_rig.RigAt(solution.theta);
  const models::BranchLaw law = of_rig.LawAt(solution.theta);
  if (law.tangential_stiffness < fitted.thresholds().rigid_beside_rig * rig.stiffness) {
    const Estimates beside_rig(sprung.problem, solution, fitted.noise(), fitted.options(),
                               Response(sprung.problem).LinearizeAt(solution.theta, of_rig.free()));
    ParameterEstimates others = ValuesOf(sprung.problem, solution);
    for (std::size_t k = 0; k < others.size(); ++k) {
      ParameterEstimate& other = others[k];
      const std::size_t p = of_rig.reported()[k];
      const auto same = std::ranges::find(parameters, other.name, &ParameterEstimate::name);
      if (same == parameters.end()) continue;
      beside_rig.Fill(p, other);
      if (of_rig[p].fixed) SetInterval(other, {.lower = other.value, .upper = other.value});
      Include(*same, {.lower = other.lower95, .upper = other.upper95});
    }
  }
  return {{.code = "shape_or_rig", .numbers = {{"rig_stiffness", rig.stiffness}}}};
}

void CoverSteps(const loop::PreparedRecords& records, FitResult& result) {
  double step = 0.0;
  for (const loop::PreparedRecord& record : records.records) {
    step = std::max(step, loop::EncoderStep(record.record.force, /*rests_at_turns=*/true));
  }
  constexpr double kOfShape = 5.0;
  const double of_force = result.rms < step / 2 ? step / 2 / result.PeakForce() : 0.0;
  const double of_stroke = result.EncoderStep() / result.WidestRecord().facts.amplitude;
  const auto cover = [&](std::size_t p, double half) {
    ParameterEstimate& estimate = result.parameters[p];
    Include(estimate,
            {.lower = std::max(estimate.value - half, 0.0), .upper = estimate.value + half});
  };
  cover(kStiffness, std::max(of_force, of_stroke) * result.law.tangential_stiffness);
  cover(kShape, std::max(kOfShape * of_force, of_stroke));
  cover(kSlipForce, of_force * result.law.slip_force);
}

void WidenByOmittedTerms(const Problem& problem, const Solution& solution, const AdequacyTest& test,
                         double quantile, std::span<ParameterEstimate> estimates) {
  constexpr double kFirstOrder = 2.0;
  const auto& reported = problem.parameters.reported();
  const auto& free = problem.parameters.free();
  for (std::size_t k = 0; k < reported.size(); ++k) {
    const std::size_t p = reported[k];
    const Parameter& parameter = problem.parameters[p];
    const Eigen::Index place = std::ranges::find(free, p) - free.begin();
    const auto include = [&](double step, double half) {
      const double from = solution.theta[p] + std::clamp(step, -kFarthestStep, kFarthestStep);
      Include(estimates[k], EndsWithinBounds(parameter, from - half, from + half));
    };
    if (place >= test.step.size()) continue;
    include(test.step[place], kFirstOrder * quantile * std::min(test.error[place], kFarthestStep));
    for (const OmittedTerm& cause : test.causes) {
      if (place < cause.step.size()) include(cause.step[place], 0.0);
    }
  }
}

namespace {

/// Half the width of Student's interval of the half gap of a further cycle, at the records' mean
/// load.
double ScatterOfCycles(const FitResult& result) {
  const RecordFit& widest = result.WidestRecord();
  const auto cycles = static_cast<double>(widest.facts.steady_cycles);
  if (!widest.facts.half_gap_standard_deviation || cycles < 3) return 0.0;
  return StudentQuantile(cycles - 1, result.confidence) *
         *widest.facts.half_gap_standard_deviation * std::sqrt(1 + 1 / cycles) / widest.load_ratio;
}

/// Returns the least and greatest stiffness of the record after its reversals over that of the
/// model: of slopes of least squares, each stroke with an intercept of its own, where the model's
/// force has changed by less than an eighth, a quarter and a half of what it changes by in the
/// stroke; and at the reversal itself, by the parabola through these, and as much again within the
/// narrowest as is seen of it. 1 where the strokes have fewer than two samples there.
Extremes RatiosOfStiffness(const Estimates& estimates) {
  constexpr double kFewestOfAStroke = 2;  // samples, for a chord
  const Eigen::ArrayXd residuals = estimates.linearization().residual;
  const auto array_of = [](const std::vector<double>& values) {
    return Eigen::Map<const Eigen::ArrayXd>(values.data(), std::ssize(values));
  };
  std::vector<double> ratios;
  for (const double window : {0.125, 0.25, 0.5}) {
    double measured = 0.0;
    double model = 0.0;
    double strokes = 0.0;
    double samples = 0.0;
    for (const ScaledRecord& record : estimates.problem().data->records) {
      const auto first_sample = static_cast<Eigen::Index>(record.first);
      const auto displacement = array_of(record.displacement);
      const auto force = array_of(record.force);
      const Eigen::ArrayXd of_model =
          force + residuals.segment(first_sample, force.size()) / array_of(record.root_weight);
      for (const Stroke& stroke : MainStrokes(record, estimates.thresholds())) {
        std::vector<Eigen::Index> near;
        for (std::size_t i = stroke.begin; i < stroke.end; ++i) {
          if (record.root_weight[i] > 0) near.push_back(static_cast<Eigen::Index>(i));
        }
        if (near.empty()) continue;
        const double first = of_model[near.front()];
        const double limit = window * std::abs(of_model[near.back()] - first);
        const auto is_beyond = [&](Eigen::Index i) {
          return std::abs(of_model[i] - first) > limit;
        };
        near.erase(std::ranges::find_if(near, is_beyond), near.end());
        // The motion turned anywhere about its outermost sample.
        std::erase(near, static_cast<Eigen::Index>(stroke.begin));
        ++strokes;
        if (near.empty()) continue;
        const auto at = displacement(near);
        const Eigen::ArrayXd places = at - at.mean();
        measured += (places * force(near)).sum();
        model += (places * of_model(near)).sum();
        samples += static_cast<double>(near.size());
      }
    }
    const double ratio = measured / model;  // of slopes at the same points
    const bool is_known = samples >= kFewestOfAStroke * strokes && std::isfinite(ratio);
    if (is_known && ratio > 0) ratios.push_back(ratio);
  }
  if (ratios.empty()) return {1.0, 1.0};
  const double parabola =
      ratios.size() > 2 ? 8.0 / 3 * ratios[0] - 2 * ratios[1] + ratios[2] / 3 : 0.0;
  ratios.push_back(ratios[0] * ratios[0]);
  if (parabola > 0) ratios.push_back(parabola);
  return ExtremesOf(ratios);
}

}  // namespace

void CoverDiscrepancy(const Estimates& fitted, FitResult& result) {
  ParameterEstimate& stiffness = result.parameters[kStiffness];
  if (stiffness.lower95 && stiffness.upper95 && !fitted.problem().data->is_forced()) {
    const auto [least, greatest] = RatiosOfStiffness(fitted);
    Include(stiffness,
            {.lower = least * *stiffness.lower95, .upper = greatest * *stiffness.upper95});
  }
  for (ParameterEstimate& estimate : result.parameters) {
    estimate.includes_discrepancy = estimate.lower95 && estimate.upper95;
  }
  const RecordFit& widest = result.WidestRecord();
  const std::optional<double> half_gap = result.MeasuredHalfGap();
  ParameterEstimate& slip_force = result.parameters[kSlipForce];
  const bool is_held = slip_force.status == ParameterStatus::kFixed;
  if (is_held || !half_gap || !loop::HasSlipped(widest.facts)) return;
  const double margin = std::hypot(ScatterOfCycles(result), result.adequacy.misfit);
  const double peak_force = widest.facts.peak_force / widest.load_ratio;
  // If the loop slips at its ends alone, the half gap in mid-stroke is below the slip force. If the
  // law also describes the loop, T* replaces the half gap; other forces may be a part of T*.
  const bool is_plateau = loop::Slides(widest.facts) || result.adequacy.use != Use::kQuantitative;
  const double carried = is_plateau ? *half_gap : peak_force;
  // The value itself is no better known than the gap.
  const double least = is_plateau ? std::min(*half_gap, slip_force.value) - margin : 0.0;
  const double most = std::max({carried, peak_force, slip_force.value}) + margin;
  const auto [lower, upper] =
      std::minmax({slip_force.value, carried - margin, carried + margin,
                   std::clamp(slip_force.lower95.value_or(0.0), least, most),
                   std::clamp(slip_force.upper95.value_or(most), least, most)});
  SetInterval(slip_force, {.lower = std::max(lower, 0.0), .upper = upper});
  slip_force.includes_discrepancy = true;
}

void KeepAboveCarriedForce(const Parameters& fitted, FitResult& result) {
  ParameterEstimate& slip_force = result.parameters[kSlipForce];
  if (!slip_force.lower95 || slip_force.upper95 || result.is_scaled_by_load()) return;
  const std::optional<double> half_gap = result.MeasuredHalfGap();
  if (result.depth >= Depth::kIntervals && half_gap &&
      result.adequacy.verdict != AdequacyVerdict::kAdequate) {
    // A force that is not modelled may be a part of T*, but not of the half gap.
    slip_force.lower95 = std::max(*half_gap - ScatterOfCycles(result), 0.0);
    return;
  }
  // A fitted force in addition to the contact's may be a part of T*.
  const bool has_added_force = std::ranges::any_of(
      fitted.free(), [&](std::size_t p) { return fitted[p].term->adds_force(); });
  if (has_added_force) return;
  const bool is_forced = result.response == loop::Channel::kDisplacement;
  // Half the distance between the medians of a few ends is known to about half its white noise.
  const double carried = result.PeakForce() - (is_forced ? 0.0 : std::sqrt(WhiteVariance(result)));
  if (carried < slip_force.value) slip_force.lower95 = std::max(*slip_force.lower95, carried);
}

}  // namespace mindahl::identification
