#pragma once

#include <Eigen/Dense>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "identification/inference/estimates.h"
#include "identification/inference/noise.h"
#include "identification/inference/reweighting.h"
#include "identification/problem/problem.h"
#include "identification/problem/scaled_records.h"
#include "identification/solve/search.h"
#include "mindahl/identification/fit.h"
#include "mindahl/loop/preparation.h"
#include "recovery/recovered.h"

/// The stages of a fit, one by one, on records of a test.
namespace mindahl::testing {

class Stages {
 public:
  explicit Stages(std::vector<loop::Record> given, identification::FitOptions fit_options = {},
                  models::InitialState state = models::InitialState::kVirgin)
      : records(std::move(given)),
        options(std::move(fit_options)),
        views(records.begin(), records.end()),
        prepared(loop::Prepare(views, options.preparation)),
        data(identification::Scale(prepared, options)),
        problem(data, options, state) {}
  explicit Stages(loop::Record record, identification::FitOptions fit_options = {},
                  models::InitialState state = models::InitialState::kVirgin)
      : Stages(std::vector<loop::Record>{std::move(record)}, std::move(fit_options), state) {}
  Stages(const Stages&) = delete;
  Stages& operator=(const Stages&) = delete;

  /// The least-squares solution, from starts on the thinned records.
  identification::Solution Solve() {
    const identification::ScaledRecords thin = identification::Thinned(data);
    identification::Candidate candidate{.problem = {data, options, problem.initial_state}};
    identification::FindStartsOf(candidate, thin, options);
    identification::Descend(candidate, options);
    return candidate.solution;
  }

  /// θ of the parameters that a fit reports.
  std::vector<double> ThetaOf(const identification::FitResult& fit) const {
    std::vector<double> theta;
    for (std::size_t p = 0; p < problem.parameters.size(); ++p) {
      const auto* estimate = fit.Find(problem.parameters.NameOf(p));
      theta.push_back(estimate == nullptr ? problem.parameters[p].theta
                                          : problem.parameters[p].ToTheta(estimate->value));
    }
    return theta;
  }

  /// Weighted residuals at θ.
  Eigen::VectorXd ResidualsAt(std::span<const double> theta) {
    const Eigen::VectorXd force = identification::Predict(problem, theta);
    Eigen::VectorXd residual(force.size());
    Eigen::Index k = 0;
    for (const identification::ScaledRecord& record : problem.data->records) {
      for (std::size_t i = 0; i < record.size(); ++i, ++k) {
        residual[k] = record.root_weight[i] * (force[k] - record.response()[i]);
      }
    }
    return residual;
  }

  /// ∂residual/∂θ of the free parameters by central differences.
  Eigen::MatrixXd DifferencesAt(const std::vector<double>& theta, double step = 1e-5) {
    const auto& free = problem.parameters.free();
    Eigen::MatrixXd jacobian(static_cast<Eigen::Index>(problem.size()),
                             static_cast<Eigen::Index>(free.size()));
    for (std::size_t j = 0; j < free.size(); ++j) {
      std::vector<double> above = theta;
      std::vector<double> below = theta;
      above[free[j]] += step;
      below[free[j]] -= step;
      jacobian.col(static_cast<Eigen::Index>(j)) =
          (ResidualsAt(above) - ResidualsAt(below)) / (2 * step);
    }
    return jacobian;
  }

  std::vector<loop::Record> records;
  identification::FitOptions options;
  std::vector<loop::RecordView> views;
  loop::PreparedRecords prepared;
  identification::ScaledRecords data;
  identification::Problem problem;
};

struct WeightedFit {
  identification::Noise noise;
  identification::Solution solution;
};

/// With the weights that the options ask for.
inline WeightedFit FitWeighted(Stages& stages) {
  WeightedFit result;
  result.solution = stages.Solve();
  stages.options.preparation.drawn = loop::DrawReadings(stages.prepared);
  EXPECT_TRUE(identification::FitWithWeights(stages.problem, stages.data, stages.options,
                                             result.solution, result.noise));
  return result;
}

/// The parabola's errors of a solution.
inline identification::Estimates EstimatesOf(Stages& stages,
                                             const identification::Solution& solution,
                                             const identification::Noise& noise) {
  return {stages.problem, solution, noise, stages.options,
          identification::Response(stages.problem)
              .LinearizeAt(solution.theta, stages.problem.parameters.free())};
}

/// White noise of a known variance [units of the data²].
inline identification::Noise KnownNoise(double variance, std::size_t samples) {
  identification::Noise noise;
  noise.variance = variance;
  noise.force = std::sqrt(variance);
  noise.is_known = true;
  noise.samples = samples;
  return noise;
}

/// An autoregressive process of order one.
inline identification::Autocorrelation FirstOrder(double rho) {
  return {.coefficients = {rho}, .correlations = {1.0, rho}, .innovation_share = 1 - rho * rho};
}

/// A result made by hand: σ, α and Tc that are well known, one record. Tc = 10 N.
inline identification::FitResult MadeFit(double peak_force) {
  identification::FitResult result;
  result.law = {1e7, 0.4, 10.0};
  result.residuals.r_squared = 0.99;
  result.degrees_of_freedom = 1e6;
  for (const char* name : {"sigma", "alpha", "slip_force"}) {
    identification::ParameterEstimate& estimate = result.parameters.emplace_back();
    estimate.name = name;
    estimate.value = 2.0;
    estimate.lower95 = 1.9;
    estimate.upper95 = 2.1;
    estimate.status = identification::ParameterStatus::kFree;
  }
  identification::RecordFit& record = result.records.emplace_back();
  record.facts.amplitude = 1e-6;
  record.facts.peak_force = peak_force;
  return result;
}

}  // namespace mindahl::testing
