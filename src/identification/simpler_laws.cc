#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <string_view>
#include <utility>

#include "core/probability.h"
#include "identification/free_parameters.h"
#include "identification/inference/evidence.h"
#include "mindahl/core/error.h"
#include "mindahl/identification/fit.h"
#include "mindahl/identification/model_selection.h"

namespace mindahl::identification {
namespace {

/// A law to fit, simplest first: by what it remembers and what it leaves free.
struct Rung {
  std::string_view model;
  bool exponent_is_one = false;
};
constexpr Rung kFitted[] = {{"jenkins"}, {"dahl", true}, {"dahl"}, {"mindlin"}, {"mindlin-dahl"}};

/// The force of a law without a history, times a factor and plus an offset.
struct Regression {
  double factor = 0.0;
  double sum_of_squares = 0.0;  // [N²]
};

/// Least squares of force = offset + factor·column over the samples that count.
Regression Regress(std::span<const double> column, std::span<const double> force,
                   std::span<const unsigned char> counts, bool offset) {
  double n = 0.0;
  double mean_column = 0.0;
  double mean_force = 0.0;
  for (std::size_t i = 0; i < force.size(); ++i) {
    if (counts[i] == 0) continue;
    ++n;
    mean_column += column[i];
    mean_force += force[i];
  }
  mean_column = offset ? mean_column / n : 0.0;
  mean_force = offset ? mean_force / n : 0.0;
  double squares = 0.0;
  double product = 0.0;
  for (std::size_t i = 0; i < force.size(); ++i) {
    if (counts[i] == 0) continue;
    squares += (column[i] - mean_column) * (column[i] - mean_column);
    product += (column[i] - mean_column) * (force[i] - mean_force);
  }
  Regression regression;
  if (squares > 0) regression.factor = product / squares;
  for (std::size_t i = 0; i < force.size(); ++i) {
    if (counts[i] == 0) continue;
    const double residual = (force[i] - mean_force) - regression.factor * (column[i] - mean_column);
    regression.sum_of_squares += residual * residual;
  }
  return regression;
}

/// ±1, the direction of the motion from one reversal to the next.
std::vector<double> SenseOfMotion(std::span<const double> displacement,
                                  std::span<const std::size_t> reversals) {
  std::vector<double> sense(displacement.size());
  std::size_t begin = 0;
  for (std::size_t stroke = 0; stroke <= reversals.size(); ++stroke) {
    const std::size_t end = stroke < reversals.size() ? reversals[stroke] : displacement.size() - 1;
    const double way = displacement[end] - displacement[begin];
    std::fill(sense.begin() + static_cast<std::ptrdiff_t>(begin),
              sense.begin() + static_cast<std::ptrdiff_t>(end) + 1, std::copysign(1.0, way));
    begin = std::min(end + 1, displacement.size() - 1);
  }
  return sense;
}

}  // namespace

SimplerLaws CompareSimplerLaws(const loop::RecordView& record, const FitOptions& options) {
  if (options.fixed.contains("alpha")) {
    throw InvalidArgument("alpha is fixed: must be free where laws of other alpha are compared");
  }
  SimplerLaws result;
  std::vector<FitResult> fits;
  for (const Rung& rung : kFitted) {
    FitOptions own = options;
    own.model = models::FindFrictionModel(rung.model);
    if (rung.exponent_is_one) own.fixed["alpha"] = 1.0;
    fits.push_back(Fitter(own).Fit(record, Depth::kIntervals));
  }
  const auto rms_of = [](const FitResult& fit) {
    return fit.converged ? fit.rms : std::numeric_limits<double>::infinity();
  };
  const FitResult& nearest = *std::ranges::min_element(fits, {}, rms_of);
  if (!nearest.converged) throw InvalidArgument("no law can be fitted to the record");

  const std::vector<unsigned char>& counts = nearest.records.front().counts;
  result.samples = static_cast<std::size_t>(std::ranges::count(counts, 1));
  result.effective_samples =
      std::min(nearest.residuals.effective_samples, static_cast<double>(result.samples));
  result.peak_force = nearest.PeakForce();
  result.describes_record = nearest.adequacy.verdict != AdequacyVerdict::kInadequate;
  const auto n = static_cast<double>(result.samples);

  std::vector<double> force(record.force.begin(), record.force.end());
  for (double& value : force) value *= nearest.force_sense;
  const auto add_limit = [&](std::string model, std::span<const double> column, bool is_spring) {
    const Regression regression = Regress(column, force, counts, options.offsets);
    LawScore& score = result.scores.emplace_back();
    score.model = std::move(model);
    score.law = nearest.law;
    (is_spring ? score.law.tangential_stiffness : score.law.slip_force) = regression.factor;
    score.free_parameters = options.offsets ? 2 : 1;
    score.converged = regression.factor > 0;
    score.rms = std::sqrt(regression.sum_of_squares / n);
  };
  add_limit("spring", record.displacement, /*is_spring=*/true);
  add_limit("coulomb", SenseOfMotion(record.displacement, nearest.records.front().reversals),
            /*is_spring=*/false);
  for (std::size_t i = 0; i < fits.size(); ++i) {
    LawScore& score = result.scores.emplace_back();
    score.model = kFitted[i].model;
    score.exponent_is_one = kFitted[i].exponent_is_one;
    score.law = fits[i].law;
    score.free_parameters = CountFreeParameters(fits[i]);
    score.converged = fits[i].converged;
    score.rms = fits[i].rms;
  }

  const Evidence evidence(result.samples, result.effective_samples);
  const auto [lowest, highest] = std::ranges::minmax(force);
  const double half_range = highest / 2 - lowest / 2;
  const auto sum_of_squares = [&](const LawScore& score) {
    return n * (score.rms / half_range) * (score.rms / half_range);
  };
  const auto aicc = [&](const LawScore& score) {
    return score.converged ? evidence.Aicc(sum_of_squares(score), score.free_parameters)
                           : std::numeric_limits<double>::infinity();
  };
  result.best = static_cast<std::size_t>(std::ranges::min_element(result.scores, {}, aicc) -
                                         result.scores.begin());
  const LawScore best = result.scores[result.best];
  for (LawScore& score : result.scores) {
    score.delta_aicc = aicc(score) - aicc(best);
    score.told_apart = !(score.delta_aicc < options.thresholds.indistinguishable);
    if (!score.converged) continue;
    score.misfit = std::sqrt(std::max(score.rms * score.rms - best.rms * best.rms, 0.0));
    score.likelihood_ratio =
        std::max(evidence.LikelihoodRatio(sum_of_squares(score), sum_of_squares(best)), 0.0);
    if (score.free_parameters < best.free_parameters) {
      score.p_value =
          PValueOfChiSquared(score.likelihood_ratio,
                             static_cast<double>(best.free_parameters - score.free_parameters));
    }
  }
  return result;
}

}  // namespace mindahl::identification
