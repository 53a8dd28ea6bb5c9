#include "identification/problem/problem.h"

#include <algorithm>
#include <cmath>

namespace mindahl::identification {

LawPoint PointAt(const Problem& problem, std::span<const double> theta) {
  return {.log_rate = theta[kStiffness] - theta[kSlipForce],
          .shape = theta[kShape],
          .log_travel = problem.parameters.has_rig() ? theta[kSlipForce] - theta[kRig] : 0.0,
          .theta = theta};
}

void Response::Bind(const Problem& problem) {
  problem_ = &problem;
  const std::size_t records = problem.data->records.size();
  if (paths_.size() < records) paths_.resize(records);
  for (CachedPath& cached : paths_) cached.valid = false;
  unloaded_.resize(records);
  for (std::size_t r = 0; r < records; ++r) {
    unloaded_[r] = problem.parameters.PositionOf("displacement_offset", r);
  }
}

const models::LoadingPath& Response::PathOf(std::size_t r, std::span<const double> theta) {
  CachedPath& cached = paths_[r];
  const bool virgin = problem_->state == models::InitialState::kVirgin;
  const double unloaded = virgin ? theta[unloaded_[r]] : 0.0;
  if (!cached.valid || unloaded != cached.unloaded) {
    const ScaledRecord& record = problem_->data->records[r];
    models::MakeLoadingPath(record.displacement, record.reversals, problem_->model->memory,
                            {.state = problem_->state, .unloaded_displacement = unloaded},
                            cached.path);
    cached.unloaded = unloaded;
    cached.valid = true;
  }
  return cached.path;
}

void Response::Evaluate(const LawPoint& at, std::span<double> t) { Differentiate(at, t, {}); }

models::NormalizedLaw Response::LawAt(const LawPoint& at) const {
  return {.rate = std::exp(at.log_rate),
          .shape_exponent = at.shape,
          .spring_travel = problem_->parameters.has_rig() ? std::exp(at.log_travel) : 0.0};
}

void Response::DifferentiateByOrigins(const LawPoint& at, std::size_t r,
                                      models::OriginSensitivity& sensitivity) {
  response_.DifferentiateByOrigins(*problem_->model, LawAt(at), PathOf(r, at.theta),
                                   problem_->data->records[r].displacement, sensitivity);
}

void Response::Differentiate(const LawPoint& at, std::span<double> t,
                             const ResponseColumns& columns) {
  const models::NormalizedLaw law = LawAt(at);
  std::size_t begin = 0;
  for (std::size_t r = 0; r < problem_->data->records.size(); ++r) {
    const ScaledRecord& record = problem_->data->records[r];
    const std::size_t count = record.size();
    const auto part = [&](std::span<double> column) {
      return column.empty() ? column : column.subspan(begin, count);
    };
    const ResponseColumns parts{.log_rate = part(columns.log_rate),
                                .shape_exponent = part(columns.shape_exponent),
                                .unloaded_displacement = part(columns.unloaded_displacement),
                                .log_spring_travel = part(columns.log_spring_travel)};
    const std::span<double> values = t.subspan(begin, count);
    const bool wants_any = !parts.log_rate.empty() || !parts.shape_exponent.empty() ||
                           !parts.unloaded_displacement.empty() || !parts.log_spring_travel.empty();
    if (wants_any) {
      response_.Differentiate(*problem_->model, law, PathOf(r, at.theta), record.displacement,
                              values, parts);
    } else {
      response_.Evaluate(*problem_->model, law, PathOf(r, at.theta), record.displacement, values);
    }
    if (!record.load_ratio.empty()) {
      for (const std::span<double> column :
           {values, parts.log_rate, parts.shape_exponent, parts.unloaded_displacement,
            parts.log_spring_travel}) {
        for (std::size_t i = 0; i < column.size(); ++i) column[i] *= record.load_ratio[i];
      }
    }
    begin += count;
  }
}

double ColumnAt(const Problem& problem, std::size_t parameter, std::size_t r, std::size_t sample) {
  const Parameter& linear = problem.parameters[parameter];
  if (linear.term->scope == Scope::kRecord && linear.record != r) return 0.0;
  return linear.term->column(problem.data->records[r].SampleAt(sample));
}

namespace {

/// Adds what is linear in its parameters to Tc·t.
void Complete(const Problem& problem, std::span<const double> theta, std::span<double> force) {
  const double slip_force = std::exp(theta[kSlipForce]);
  for (double& value : force) value *= slip_force;
  for (std::size_t p = 0; p < problem.parameters.size(); ++p) {
    const Parameter& parameter = problem.parameters[p];
    if (parameter.term->column == nullptr || theta[p] == 0) continue;
    std::size_t begin = 0;
    for (std::size_t r = 0; r < problem.data->records.size(); ++r) {
      const std::size_t count = problem.data->records[r].size();
      if (parameter.term->scope == Scope::kContact || parameter.record == r) {
        for (std::size_t i = 0; i < count; ++i) {
          force[begin + i] += theta[p] * ColumnAt(problem, p, r, i);
        }
      }
      begin += count;
    }
  }
}

/// Weighted residuals in the place of the forces of the model.
void TakeOffMeasured(const Problem& problem, std::span<double> force) {
  std::size_t k = 0;
  for (const ScaledRecord& record : problem.data->records) {
    for (std::size_t i = 0; i < record.size(); ++i, ++k) {
      force[k] = record.root_weight[i] * (force[k] - record.force[i]);
    }
  }
}

}  // namespace

void Predict(const Problem& problem, std::span<const double> theta, Response& response,
             std::span<double> force) {
  response.Evaluate(PointAt(problem, theta), force);
  Complete(problem, theta, force);
}

void EvaluateResidual(const Problem& problem, std::span<const double> theta, Response& response,
                      std::span<double> residual) {
  response.Bind(problem);
  Predict(problem, theta, response, residual);
  TakeOffMeasured(problem, residual);
}

void Differentiate(const Problem& problem, std::span<const double> theta, Response& response,
                   std::span<const std::size_t> columns, std::span<double> residual,
                   std::span<double> jacobian) {
  const std::size_t samples = problem.size();
  std::vector<double> derivatives(samples * 4);
  const auto part = [&](std::size_t k) {
    return std::span(derivatives).subspan(k * samples, samples);
  };
  const ResponseColumns gradient{.log_rate = part(0),
                                 .shape_exponent = part(1),
                                 .unloaded_displacement = part(2),
                                 .log_spring_travel = part(3)};
  response.Differentiate(PointAt(problem, theta), residual, gradient);
  const double slip_force = std::exp(theta[kSlipForce]);
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const std::size_t p = columns[c];
    const Parameter& parameter = problem.parameters[p];
    const bool is_unloaded = parameter.term->name == "displacement_offset";
    std::size_t k = 0;
    for (std::size_t r = 0; r < problem.data->records.size(); ++r) {
      const ScaledRecord& record = problem.data->records[r];
      const bool elsewhere = parameter.term->scope == Scope::kRecord && parameter.record != r;
      for (std::size_t i = 0; i < record.size(); ++i, ++k) {
        double value = 0.0;
        if (elsewhere) {
        } else if (parameter.term->column != nullptr) {
          value = ColumnAt(problem, p, r, i);
        } else if (p == kStiffness) {
          value = slip_force * gradient.log_rate[k];
        } else if (p == kShape) {
          value = slip_force * gradient.shape_exponent[k];
        } else if (p == kSlipForce) {
          value = slip_force * (residual[k] - gradient.log_rate[k] + gradient.log_spring_travel[k]);
        } else if (p == kRig) {
          value = -slip_force * gradient.log_spring_travel[k];
        } else if (is_unloaded) {
          value = slip_force * gradient.unloaded_displacement[k];
        }
        jacobian[c * samples + k] = record.root_weight[i] * value;
      }
    }
  }
  Complete(problem, theta, residual);
  TakeOffMeasured(problem, residual);
}

}  // namespace mindahl::identification
