#include "identification/diagnosis/discrepancy.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

#include "core/probability.h"
#include "identification/dense.h"
#include "identification/diagnosis/residuals.h"

namespace mindahl::identification {
namespace {

/// Sums Σ(x − x̄)(y − ȳ) of groups of points: of the same x, slopes are in proportion to it.
class CrossProduct {
 public:
  void Add(double x, double y) {
    ++count_;
    const double off = x - mean_x_;
    mean_x_ += off / count_;
    mean_y_ += (y - mean_y_) / count_;
    product_ += off * (y - mean_y_);
  }
  void AddWithin(const CrossProduct& other) { product_ += other.product_; }
  [[nodiscard]] double product() const { return product_; }

 private:
  double count_ = 0.0;
  double mean_x_ = 0.0;
  double mean_y_ = 0.0;
  double product_ = 0.0;
};

/// Includes a closed interval times each of the ratios.
void IncludeRatios(ParameterEstimate& estimate, std::span<const double> ratios) {
  if (estimate.status == ParameterStatus::kFixed || !estimate.lower95 || !estimate.upper95) return;
  const Ends ends{estimate.lower95, estimate.upper95};
  for (const double ratio : ratios) {
    Include(estimate, {.lower = ratio * *ends.lower, .upper = ratio * *ends.upper});
  }
}

/// Half the width of the interval in which a further cycle of the same loop has its half gap:
/// Student's for so few cycles.
double ScatterOfCycles(const loop::LoopFacts& facts, double confidence) {
  const auto cycles = static_cast<double>(facts.steady_cycles);
  if (!facts.half_gap_standard_deviation || cycles < 3) return 0.0;
  return StudentQuantile(cycles - 1, confidence) * *facts.half_gap_standard_deviation *
         std::sqrt(1 + 1 / cycles);
}

/// Standard errors of the free θ from leaving out one after the other of up to twelve parts of the
/// record, whole cycles that follow on each other: √((1 − f)²/f·Σ(θ₋ₖ − θ̄)²/(n − 1)), the jackknife
/// of n parts that have a fraction f of the samples each, each θ₋ₖ by one linear step of all free
/// parameters. What the model misses in the same way in every cycle is not in them.
/// @returns none of fewer than three cycles, or where the rest does not determine them
std::vector<double> ErrorsBetweenCycles(const Problem& problem, const Estimates& estimates,
                                        const Thresholds& thresholds) {
  constexpr std::size_t kFewest = 3;
  constexpr std::size_t kMost = 12;
  struct Rows {
    Eigen::Index begin;
    Eigen::Index count;
  };
  std::vector<Rows> strokes;
  Eigen::Index begin = 0;
  for (const ScaledRecord& record : problem.data->records) {
    for (const Stroke& stroke : MainStrokes(record, thresholds)) {
      strokes.push_back({begin + static_cast<Eigen::Index>(stroke.begin),
                         static_cast<Eigen::Index>(stroke.end - stroke.begin)});
    }
    begin += static_cast<Eigen::Index>(record.size());
  }
  const Eigen::MatrixXd& jacobian = estimates.jacobian();
  const Eigen::Index count = jacobian.cols();
  const std::size_t cycles = strokes.size() / 2;
  if (cycles < kFewest || count == 0) return {};
  const std::size_t parts = std::min(cycles, kMost);
  std::vector<Eigen::MatrixXd> matrices(parts, TransposedProduct(jacobian, jacobian));
  std::vector<Eigen::VectorXd> vectors(parts, -(jacobian.transpose() * estimates.residual()));
  double left_out = 0.0;
  // An odd stroke at the end stays: without it the two directions would weigh unlike.
  for (std::size_t stroke = 0; stroke < 2 * cycles; ++stroke) {
    const auto [first, samples] = strokes[stroke];
    const auto rows = jacobian.middleRows(first, samples);
    const std::size_t part = stroke / 2 * parts / cycles;
    matrices[part] -= TransposedProduct(rows, rows);
    vectors[part] += rows.transpose() * estimates.residual().segment(first, samples);
    left_out += static_cast<double>(samples);
  }
  Eigen::MatrixXd steps(count, static_cast<Eigen::Index>(parts));
  for (std::size_t part = 0; part < parts; ++part) {
    Eigen::Index rank = 0;
    steps.col(static_cast<Eigen::Index>(part)) =
        SolveLeastSquares(matrices[part], vectors[part], &rank);
    if (rank < count) return {};
  }
  steps.colwise() -= steps.rowwise().mean().eval();
  const auto all = static_cast<double>(parts);
  const double fraction = left_out / all / static_cast<double>(jacobian.rows());
  const double factor = (1 - fraction) * (1 - fraction) / (fraction * (all - 1));
  const Eigen::VectorXd errors = std::sqrt(factor) * steps.rowwise().norm();
  return {errors.begin(), errors.end()};
}

/// The stiffness of the record after its reversals over that of the model: slopes of least squares,
/// each stroke with an intercept of its own, over the places where the model's force has changed by
/// less than an eighth, a quarter and a half of what it changes by in the stroke, and, at the
/// reversal itself, the parabola through these and the square of the narrowest window's.
/// @returns those of windows that have two samples a stroke or more
std::vector<double> StiffnessOfWindows(const Problem& problem, const Estimates& estimates,
                                       const Thresholds& thresholds) {
  std::vector<double> ratios;
  if (problem.data->is_forced()) return ratios;
  for (const double window : {0.125, 0.25, 0.5}) {
    CrossProduct measured;
    CrossProduct model;
    double strokes = 0.0;
    double samples = 0.0;
    std::size_t begin = 0;
    for (const ScaledRecord& record : problem.data->records) {
      const auto force_of_model = [&](std::size_t i) {
        return record.force[i] +
               estimates.residual()(static_cast<Eigen::Index>(begin + i)) / record.root_weight[i];
      };
      for (const Stroke& stroke : MainStrokes(record, thresholds)) {
        CrossProduct measured_here;
        CrossProduct model_here;
        std::optional<double> first;
        double last = 0.0;
        for (std::size_t i = stroke.begin; i < stroke.end; ++i) {
          if (!(record.root_weight[i] > 0)) continue;
          if (!first) first = force_of_model(i);
          last = force_of_model(i);
        }
        if (!first) continue;
        // The motion turned anywhere about its outermost sample.
        for (std::size_t i = stroke.begin + 1; i < stroke.end; ++i) {
          if (!(record.root_weight[i] > 0)) continue;
          const double force = force_of_model(i);
          if (std::abs(force - *first) > window * std::abs(last - *first)) break;
          measured_here.Add(record.displacement[i], record.force[i]);
          model_here.Add(record.displacement[i], force);
          ++samples;
        }
        measured.AddWithin(measured_here);
        model.AddWithin(model_here);
        ++strokes;
      }
      begin += record.size();
    }
    constexpr double kFewestOfAStroke = 2;  // samples a stroke, for a chord
    if (samples < kFewestOfAStroke * strokes || model.product() == 0) continue;
    const double ratio = measured.product() / model.product();  // of slopes at the same points
    if (!(ratio > 0) || !std::isfinite(ratio)) continue;
    ratios.push_back(ratio);
  }
  // Each window is twice the one before: the parabola through three, at a window of nothing; and as
  // much again within the narrowest as is seen of it.
  const std::size_t windows = ratios.size();
  if (windows > 0) ratios.push_back(ratios[0] * ratios[0]);
  if (windows > 2) ratios.push_back(8.0 / 3 * ratios[0] - 2 * ratios[1] + ratios[2] / 3);
  std::erase_if(ratios, [](double ratio) { return !(ratio > 0); });
  return ratios;
}

}  // namespace

ParameterEstimates CoverDiscrepancy(const FittedProblem& fitted, const Thresholds& thresholds,
                                    const FitResult& result) {
  ParameterEstimates parameters = result.parameters;
  ParameterEstimate& slip_force = parameters[kSlipForce];
  IncludeRatios(parameters[kStiffness],
                StiffnessOfWindows(fitted.problem, fitted.estimates, thresholds));
  for (ParameterEstimate& estimate : parameters) {
    const bool is_closed = estimate.lower95 && estimate.upper95;
    estimate.includes_discrepancy = estimate.status != ParameterStatus::kFixed && is_closed &&
                                    result.adequacy.use != Use::kNone;
  }
  const loop::LoopFacts& facts = result.WidestRecord().facts;
  const double load_ratio = result.WidestRecord().load_ratio;
  const std::optional<double> half_gap = result.MeasuredHalfGap();
  const bool is_free = slip_force.status != ParameterStatus::kFixed;
  const bool has_slipped = loop::Slides(facts) || loop::ReachesSlip(facts);
  if (!is_free || !half_gap || !has_slipped) return parameters;

  const double margin =
      std::hypot(ScatterOfCycles(facts, result.confidence) / load_ratio, result.adequacy.misfit);
  // The value itself is no better known than the gap.
  const double least = std::min(*half_gap, slip_force.value) - margin;
  const double most =
      std::max({*half_gap, facts.peak_force / load_ratio, slip_force.value}) + margin;
  const auto [lower, upper] =
      std::minmax({slip_force.value, *half_gap - margin, *half_gap + margin,
                   std::clamp(slip_force.lower95.value_or(0.0), least, most),
                   std::clamp(slip_force.upper95.value_or(most), least, most)});
  SetInterval(slip_force, {.lower = lower, .upper = upper});
  slip_force.includes_discrepancy = true;
  return parameters;
}

ParameterEstimates WithRepeatErrors(const FittedProblem& fitted, const Thresholds& thresholds,
                                    const FitResult& result) {
  const auto& [problem, solution, noise, estimates] = fitted;
  ParameterEstimates parameters = result.parameters;
  const bool is_adequate = result.adequacy.verdict == AdequacyVerdict::kAdequate;
  const std::vector<double> errors =
      is_adequate ? std::vector<double>() : ErrorsBetweenCycles(problem, estimates, thresholds);
  for (std::size_t k = 0; k < parameters.size(); ++k) {
    const std::size_t p = problem.parameters.reported()[k];
    const std::size_t place = problem.parameters.PlaceAmongFree(p);
    ParameterEstimate& estimate = parameters[k];
    if (is_adequate) {
      estimate.repeat_error = estimate.standard_error;
    } else if (place < errors.size()) {
      const Parameter& parameter = problem.parameters[p];
      estimate.repeat_error =
          errors[place] * (parameter.term->positive ? estimate.value : std::abs(parameter.scale));
    }
  }
  return parameters;
}

}  // namespace mindahl::identification
