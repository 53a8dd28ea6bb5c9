#include "mindahl/identification/fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/distributions/fisher_f.hpp>
#include <cmath>
#include <optional>
#include <utility>

#include "identification/branch_shapes.h"
#include "identification/candidate.h"
#include "identification/displacement_errors.h"
#include "identification/estimator.h"
#include "identification/misfit.h"
#include "identification/noise_model.h"
#include "identification/sample_weights.h"
#include "identification/scaled_records.h"
#include "identification/slip_force_profile.h"
#include "identification/turning_points.h"
#include "identification/verdicts.h"
#include "mindahl/core/error.h"
#include "mindahl/loop/displacement_noise.h"
#include "mindahl/loop/reversals.h"

namespace mindahl::identification {

using loop::Record;

namespace {

/// Degrees of freedom of a variance that is known: as good as infinite.
constexpr double kKnownVariance = 1e6;

void RequireOptions(std::span<const Record> records, const FitOptions& options) {
  if (records.empty()) throw InvalidArgument("there is no record: a fit needs at least one");
  if (options.model == nullptr || options.model->scaled_by_peak) {
    throw InvalidArgument("the model cannot be fitted: it must be told the amplitude");
  }
  if (options.force_sense && *options.force_sense != 1 && *options.force_sense != -1) {
    ThrowInvalid("force sense [-]", *options.force_sense, "must be +1 or -1");
  }
  if (options.force_noise) RequirePositive("force noise [N]", *options.force_noise);
  if (options.displacement_noise) {
    RequireNonNegative("displacement noise [m]", *options.displacement_noise);
  }
  if (options.reversal_gate) RequireNonNegative("reversal gate [m]", *options.reversal_gate);
  if (options.max_iterations < 1) {
    ThrowInvalid("maximum iterations [-]", options.max_iterations, "must be >= 1");
  }
  if (options.starts < 1) ThrowInvalid("starts [-]", 0, "must be >= 1");
  for (const Record& record : records) Validate(record);
}

/// Fitted forces and residuals as the file has them, of every sample.
void FillRecords(FitResult& result, std::span<const Record> records, const ScaledRecords& data,
                 const Candidate& best) {
  std::vector<double> force(best.residual.size());
  best.residual.Predict(best.solution.theta, force);
  const std::vector<std::vector<double>> parts = SplitByRecord(data, force);
  for (std::size_t r = 0; r < records.size(); ++r) {
    RecordFit& fit = result.records[r];
    for (std::size_t i = 0; i < parts[r].size(); ++i) {
      // The difference in units of the data: offsets of the file would cost its digits.
      const double residual = parts[r][i] - data.records[r].force[i];
      fit.residual.push_back(data.sense * data.force * residual);
      fit.fitted_force.push_back(records[r].force[i] + fit.residual.back());
    }
  }
}

/// Statistics of the residuals that count, as the file has them.
void DescribeFit(FitResult& result, std::span<const Record> records,
                 std::span<const std::vector<double>> weighted, const ScaledRecords& data,
                 const Candidate& best) {
  std::vector<std::vector<double>> residuals;
  std::vector<std::vector<double>> forces;
  for (std::size_t r = 0; r < records.size(); ++r) {
    residuals.emplace_back();
    forces.emplace_back();
    for (std::size_t i = 0; i < weighted[r].size(); ++i) {
      if (!(data.records[r].root_weight[i] > 0)) continue;
      residuals.back().push_back(result.records[r].residual[i]);
      forces.back().push_back(records[r].force[i]);
    }
  }
  result.residuals =
      DescribeResiduals(residuals, forces, result.law.slip_force, best.layout.free().size());
}

/// The load of each sample over the mean of those that there are.
void FollowLoad(ScaledRecords& data, std::span<const Record> records) {
  double sum = 0.0;
  double count = 0.0;
  for (const Record& record : records) {
    if (record.normal_load.empty()) {
      throw InvalidArgument("following the load needs a normal load in every record");
    }
    for (const double load : record.normal_load) sum += load;
    count += static_cast<double>(record.size());
  }
  const double mean = sum / count;
  RequirePositive("mean normal load [N]", mean);
  for (std::size_t r = 0; r < records.size(); ++r) {
    for (const double load : records[r].normal_load) {
      data.records[r].load_ratio.push_back(load / mean);
    }
  }
}

/// How far noise that is known spreads [m]: normal noise of n samples reaches √(2 ln n) standard
/// deviations to either side, and must not make a reversal.
double ReachOfNoise(const Record& record, const FitOptions& options) {
  const double deviations = std::sqrt(2 * std::log(static_cast<double>(record.size())));
  return 2 * deviations * options.displacement_noise.value_or(0.0);
}

/// Reversals and the force's sense: what depends on no model.
int PrepareRecords(std::span<const Record> records, const FitOptions& options, FitResult& result) {
  int votes = 0;
  for (const Record& record : records) {
    RecordFit& fit = result.records.emplace_back();
    fit.reversal_gate = options.reversal_gate.value_or(
        std::max(loop::EstimateReversalGate(record.displacement), ReachOfNoise(record, options)));
    fit.reversals = loop::FindReversals(record.displacement, fit.reversal_gate);
    votes += loop::ForceSense(record, fit.reversals);
  }
  const int sense = options.force_sense.value_or(votes < 0 ? -1 : 1);
  for (std::size_t r = 0; r < records.size(); ++r) {
    Record oriented = records[r];
    for (double& force : oriented.force) force *= sense;
    result.records[r].measures = loop::MeasureLoop(oriented, result.records[r].reversals);
  }
  return sense;
}

/// Frees the turning points where the record was sampled too coarsely to show them.
void RefineTurningPoints(Candidate& best, const ScaledRecords& data, const FitOptions& options,
                         FitResult& result) {
  if (!best.solution.converged) return;
  // A gate means noise in the displacement: its outermost samples are the noisiest, and say nothing
  // of where the motion turned.
  if (std::ranges::any_of(result.records,
                          [](const RecordFit& fit) { return fit.reversal_gate > 0; })) {
    return;
  }
  // Residuals of rounding size have nothing left to explain.
  const double rms = std::sqrt(best.solution.sum_of_squares / static_cast<double>(data.samples()));
  if (rms < kRoundingRms) return;
  std::optional<TurningPointFit> refined =
      FitTurningPoints(data, best.residual, best.layout, best.solution, options);
  if (!refined) return;
  best.layout = std::move(refined->layout);
  best.solution = std::move(refined->solution);
  std::size_t position = best.layout.reported();
  double largest = 0.0;
  for (std::size_t r = 0; r < data.records.size(); ++r) {
    for (std::size_t j = 0; j < data.records[r].reversals.size(); ++j, ++position) {
      const double overshoot =
          best.layout.parameters()[position].ToValue(best.solution.theta[position]);
      result.records[r].overshoot.push_back(overshoot);
      largest = std::max(largest, overshoot);
    }
  }
  Warn(result, "turning_points_between_samples",
       fmt::format("the motion turns between samples, up to {:.3g} m beyond the outermost: the "
                   "turning points were fitted too; sample more densely",
                   largest));
}

std::vector<std::vector<std::size_t>> ReversalsOf(const FitResult& result) {
  std::vector<std::vector<std::size_t>> reversals;
  for (const RecordFit& fit : result.records) reversals.push_back(fit.reversals);
  return reversals;
}

/// Standard deviation [m] of a displacement's noise where the record has to be treated as noisy.
double DisplacementNoise(const Record& record, double gate, double encoder_step,
                         const FitOptions& options) {
  // The rounding of a file, or of a fine encoder, is not worth it.
  constexpr double kCoarse = 1e-3;
  if (options.displacement_noise) return *options.displacement_noise;
  const auto [lowest, highest] = std::ranges::minmax(record.displacement);
  const bool is_coarse = encoder_step > kCoarse * (highest / 2 - lowest / 2);
  return gate > 0 || is_coarse ? loop::EstimateDisplacementNoise(record.displacement) : 0.0;
}

/// The records as they are fitted: without the noise that smoothing can take away, which would bend
/// the response, and with the turning points where they then are.
std::vector<Record> SettleRecords(std::span<const Record> records, const FitOptions& options,
                                  FitResult& result, std::vector<DisplacementReading>& readings) {
  std::vector<Record> settled(records.begin(), records.end());
  for (std::size_t r = 0; r < settled.size(); ++r) {
    RecordFit& fit = result.records[r];
    std::vector<double>& displacement = settled[r].displacement;
    const double encoder_step = loop::EncoderStep(displacement);
    fit.displacement_noise =
        DisplacementNoise(records[r], fit.reversal_gate, encoder_step, options);
    DisplacementReading& reading = readings.emplace_back(
        DisplacementReading{loop::DisplacementSmoother(displacement, fit.displacement_noise),
                            fit.displacement_noise,
                            encoder_step,
                            {}});
    reading.repeats.assign(displacement.size(), false);
    for (std::size_t i = 1; i < displacement.size(); ++i) {
      reading.repeats[i] = displacement[i] == displacement[i - 1];
    }
    if (!(fit.displacement_noise > 0)) continue;
    displacement = reading.smoother.Smooth(displacement);
    fit.reversals = loop::MoveReversals(displacement, fit.reversals);
  }
  return settled;
}

/// Residuals in the order of the samples, weighted as they were fitted, one series a record.
std::vector<std::vector<double>> WeightedResiduals(const Candidate& best,
                                                   const ScaledRecords& data) {
  std::vector<double> residual(best.residual.size());
  best.residual.Evaluate(best.solution.theta, residual);
  return SplitByRecord(data, residual);
}

/// Residuals of the samples that tell of the force's noise: where most is the displacement's, they
/// hang together as its errors do, and their draws know that already.
std::vector<std::vector<double>> ForceResiduals(std::vector<std::vector<double>> residuals,
                                                std::span<const double> force_share) {
  constexpr double kLeast = 0.8;  // of the variance
  if (force_share.empty()) return residuals;
  std::size_t i = 0;
  for (std::vector<double>& series : residuals) {
    for (double& residual : series) {
      if (force_share[i] * force_share[i] < kLeast) residual = 0.0;  // does not count
      ++i;
    }
  }
  return residuals;
}

/// By how much the variance of estimates exceeds what the noise makes: a misfit that comes back in
/// every stroke is not averaged away by more of them.
double DescribeStructures(FitResult& result, const ScaledRecords& data,
                          std::span<const std::vector<double>> residuals) {
  double inflation = 1.0;
  for (std::size_t r = 0; r < result.records.size(); ++r) {
    RecordFit& fit = result.records[r];
    std::vector<double> residual = residuals[r];
    for (double& value : residual) value *= data.force;
    fit.structure = DescribeStructure(data.records[r].displacement, fit.reversals, residual);
    const auto repeats = static_cast<double>(std::max<std::size_t>(fit.structure.strokes, 1));
    inflation = std::max(inflation, 1 + fit.structure.repeatable_share * (repeats - 1));
  }
  return inflation;
}

/// What errors of the displacement do to the weighted residuals.
/// @param variance  of those
DisplacementEffect EffectOf(const DisplacementErrors& errors, const Candidate& best,
                            const ScaledRecords& data, const WeightedNoise& noise,
                            double variance) {
  if (!errors.any()) return {};
  DisplacementEffect effect{errors.ForceErrors(best), variance, noise.force_share};
  Eigen::Index row = 0;
  for (const ScaledRecord& record : data.records) {
    for (const double weight : record.root_weight) effect.residuals.row(row++) *= weight;
  }
  return effect;
}

/// The likelihood ratio keeps to the valley along which α and Tc run away together, where a
/// standard error of α means little.
std::optional<MindlinTest> TestMindlin(const Candidate& best, const FitOptions& options,
                                       double variance, const Estimator& estimator,
                                       double degrees_of_freedom) {
  if (best.layout.parameters()[kShapeExponent].fixed) return std::nullopt;
  const double share = estimator.WhiteShare(kShapeExponent, variance);
  const Solution held = Solve(best.residual, best.layout.WithFixed(kShapeExponent, 1.0 / 3),
                              best.solution.theta, options);
  const double gain = held.sum_of_squares - best.solution.sum_of_squares;
  MindlinTest test;
  test.likelihood_ratio = std::max(gain, 0.0) * share / variance;
  const boost::math::fisher_f distribution(1.0, degrees_of_freedom);
  test.p_value = boost::math::cdf(boost::math::complement(distribution, test.likelihood_ratio));
  return test;
}

/// A rig makes a loop more angular, as a smaller α does: where α = 1/3 is rejected for a rigid rig,
/// one that gives way may bring it back.
void TryRig(FitResult& result, const ScaledRecords& data, const Candidate& best,
            const FitOptions& options, double share_over_variance) {
  constexpr double kSignificance = 0.05;
  constexpr double kAlike = 4.0;  // ΔAICc with as many parameters: an evidence of e² to 1
  const bool wanted = result.mindlin_test && result.mindlin_test->p_value < kSignificance &&
                      result.law.shape_exponent < 1.0 / 3 && !best.layout.has_rig();
  if (!wanted) return;
  FitOptions with_rig = options;
  with_rig.fit_rig_stiffness = true;
  with_rig.fixed["alpha"] = 1.0 / 3;
  with_rig.start.clear();
  with_rig.initial_state = best.state;
  const Candidate sprung = FitBestState(data, with_rig);
  const double loss = sprung.solution.sum_of_squares - best.solution.sum_of_squares;
  if (!sprung.solution.converged || !(loss * share_over_variance < kAlike)) return;
  const double stiffness = sprung.layout.Rig(sprung.solution.theta).stiffness;
  result.mindlin_test->rig_stiffness = stiffness;
  // A rigid contact in a rig is Jenkins' element again: the same curve, and no other α.
  constexpr double kRigid = 30.0;  // σ over k_r
  const double contact = sprung.layout.Law(sprung.solution.theta).tangential_stiffness;
  if (contact < kRigid * stiffness) {
    const auto alpha = std::ranges::find(result.parameters, "alpha", &ParameterEstimate::name);
    alpha->identifiability = Identifiability::kNotIdentifiable;
  }
  Warn(result, "shape_or_rig",
       fmt::format("alpha: a rig of {:.4g} N/m in series and Mindlin's alpha = 1/3 fit as well as "
                   "alpha = {:.3g} on a rigid rig: the record does not tell which, and sigma is "
                   "that of both together; measure the rig's stiffness and give --rig-stiffness",
                   stiffness, result.law.shape_exponent));
}

}  // namespace

const ParameterEstimate* FitResult::Find(std::string_view name) const {
  const auto found = std::ranges::find(parameters, name, &ParameterEstimate::name);
  return found == parameters.end() ? nullptr : &*found;
}

const RecordFit& FitResult::WidestRecord() const {
  return *std::ranges::max_element(records, {},
                                   [](const RecordFit& fit) { return fit.measures.amplitude; });
}

FitResult Fit(std::span<const Record> records, const FitOptions& options) {
  RequireOptions(records, options);
  FitResult result;
  result.model = options.model;
  result.force_sense = PrepareRecords(records, options, result);
  std::vector<DisplacementReading> readings;
  const std::vector<Record> settled = SettleRecords(records, options, result, readings);
  const std::vector<std::vector<std::size_t>> reversals = ReversalsOf(result);
  ScaledRecords data = Scale(settled, reversals, result.force_sense);
  if (options.follow_load) FollowLoad(data, records);
  const std::vector<std::size_t> left_out = LeaveOut(data, records, reversals, options);
  for (std::size_t r = 0; r < records.size(); ++r) result.records[r].left_out = left_out[r];
  for (DisplacementReading& reading : readings) {
    reading.noise /= data.length;
    reading.encoder_step /= data.length;
  }
  const DisplacementErrors displacement_errors(data, readings);
  const bool is_weighted = options.loss != Loss::kNone || displacement_errors.any();

  Candidate best = FitBestState(data, options);
  WeightedNoise noise;
  if (is_weighted && std::isfinite(best.solution.sum_of_squares)) {
    noise = FitWithWeights(best, data, options, displacement_errors);
    // Outliers may have hidden the past and the valley: once more from all starts, as weighted.
    if (options.loss != Loss::kNone) {
      best = FitBestState(data, options);
      noise = FitWithWeights(best, data, options, displacement_errors);
    }
  } else if (std::isfinite(best.solution.sum_of_squares)) {
    RefineTurningPoints(best, data, options, result);
    noise = PlainNoise(best, data, options);
  }
  result.initial_state = best.state;
  result.starts = best.starts;
  result.termination = best.solution.termination;
  result.iterations = best.solution.iterations;
  result.converged = best.solution.converged;
  if (!std::isfinite(best.solution.sum_of_squares)) {
    result.converged = false;
    return result;
  }
  if (!noise.converged) {
    result.converged = false;
    result.termination = "The weights of the samples did not settle.";
  }
  result.law = best.layout.Law(best.solution.theta);
  result.rig = best.layout.Rig(best.solution.theta);
  result.force_noise = noise.force_noise * data.force;
  result.outliers = noise.outliers;

  FillRecords(result, records, data, best);
  const std::vector<std::vector<double>> weighted = WeightedResiduals(best, data);
  DescribeFit(result, records, weighted, data, best);

  // Rounding errors hang together as they like: nothing is to be learnt from them.
  const double rms =
      std::sqrt(best.solution.sum_of_squares / static_cast<double>(data.weighted_samples()));
  const bool only_rounding = rms < 10 * kRoundingRms;
  const NoiseModel correlation =
      only_rounding ? NoiseModel{} : EstimateNoise(ForceResiduals(weighted, noise.force_share));
  const double structure_inflation = DescribeStructures(result, data, weighted);
  const double inflation = only_rounding ? 1.0 : structure_inflation;
  std::vector<std::size_t> rows;
  for (const Record& record : records) rows.push_back(record.size());
  const double variance = std::max(noise.variance, kRoundingRms * kRoundingRms);
  const auto free_parameters = static_cast<double>(best.layout.free().size());
  result.residuals.degrees_of_freedom =
      std::max(static_cast<double>(data.weighted_samples()) / correlation.SquaredCorrelations() -
                   free_parameters,
               1.0);
  const double degrees = options.force_noise ? kKnownVariance : result.residuals.degrees_of_freedom;
  const DisplacementEffect displacement =
      EffectOf(displacement_errors, best, data, noise, variance * inflation);
  const Estimator estimator(best, variance * inflation, correlation, rows, degrees, displacement,
                            options.force_noise ? 0 : data.weighted_samples());
  const std::vector<std::size_t> reported = best.layout.Reported();
  for (const std::size_t i : reported) {
    result.parameters.push_back(estimator.Estimate(i));
    for (const std::size_t j : reported) {
      result.correlation.push_back(estimator.Correlation(i, j));
    }
  }
  result.branch_shapes = FitBranchShapes(best, data, correlation, rows, variance * inflation);
  JudgeNullDirections(result, best, estimator.local());
  const double critical = estimator.quantile() * estimator.quantile();  // of F(1, ν), χ²₁ as ν → ∞
  JudgeProfile(result, best.layout,
               ProfileSlipForce(best.residual, best.layout, best.solution, variance,
                                estimator.WhiteShare(kLogSlipForce, variance), critical, options),
               estimator.quantile());
  JudgeStiffness(result, StiffnessIsOpenAbove(best.residual, best.layout, best.solution, variance,
                                              estimator.WhiteShare(kLogStiffness, variance),
                                              critical, options));
  JudgeIntervals(result);
  JudgeMisfit(result);
  result.mindlin_test = TestMindlin(best, options, variance, estimator, degrees);
  TryRig(result, data, best, options, estimator.WhiteShare(kShapeExponent, variance) / variance);
  return result;
}

}  // namespace mindahl::identification
