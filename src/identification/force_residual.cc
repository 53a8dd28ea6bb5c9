#include "identification/force_residual.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace mindahl::identification {

using models::InitialState;
using models::kGradientColumns;
using models::LoadingPath;

namespace {

/// A record's displacement with its turning points put in beside the outermost sample of each
/// swing.
struct TurnedHistory {
  std::vector<double> displacement;
  std::vector<std::size_t> reversals;
  std::vector<std::size_t> samples;  // positions of the record's own
};

/// The motion turns on that side of the outermost sample on which its neighbour is the nearer one.
TurnedHistory PutInTurningPoints(const ScaledRecord& record, std::span<const double> overshoot) {
  TurnedHistory turned;
  const std::vector<double>& x = record.displacement;
  std::size_t next = 0;
  const auto put_in = [&](std::size_t i, double sense) {
    turned.reversals.push_back(turned.displacement.size());
    turned.displacement.push_back(x[i] + sense * overshoot[next]);
  };
  for (std::size_t i = 0; i < x.size(); ++i) {
    const bool turns = next < record.reversals.size() && record.reversals[next] == i;
    const double before = turns ? x[i - 1] : 0.0;
    const double after = turns ? x[i + 1] : 0.0;
    const double sense = x[i] > before / 2 + after / 2 ? 1.0 : -1.0;
    const bool turns_before = turns && sense * (before - after) > 0;
    if (turns_before) put_in(i, sense);
    turned.samples.push_back(turned.displacement.size());
    turned.displacement.push_back(x[i]);
    if (turns && !turns_before) put_in(i, sense);
    if (turns) ++next;
  }
  return turned;
}

LoadingPath MakePath(const models::FrictionModel& model, InitialState state, std::size_t record,
                     std::span<const double> displacement, std::span<const std::size_t> reversals,
                     const std::vector<double>& theta) {
  return models::MakeLoadingPath(
      displacement, reversals, model.memory,
      {.state = state,
       .unloaded_displacement = theta[ParameterLayout::OfRecord(record, kUnloadedDisplacement)]});
}

}  // namespace

ForceResidual::ForceResidual(const ScaledRecords& data, const models::FrictionModel& model,
                             InitialState state, const ParameterLayout& layout)
    : data_(&data), model_(&model), state_(state), has_rig_(layout.has_rig()) {
  std::size_t position = ParameterLayout::OfRecord(data_->records.size(), 0);
  for (const ScaledRecord& record : data_->records) {
    first_overshoot_.push_back(position);
    position += record.reversals.size();
    if (state_ == InitialState::kVirgin) continue;
    steady_paths_.push_back(models::MakeLoadingPath(
        record.displacement, record.reversals, model_->memory, {.state = InitialState::kSteady}));
  }
}

LoadingPath ForceResidual::PathOf(std::size_t record, const std::vector<double>& theta) const {
  if (state_ == InitialState::kSteady) return steady_paths_[record];
  const ScaledRecord& scaled = data_->records[record];
  return MakePath(*model_, state_, record, scaled.displacement, scaled.reversals, theta);
}

void ForceResidual::Respond(std::size_t r, const std::vector<double>& theta,
                            std::span<double> force, std::vector<double>* gradient) const {
  const models::BranchLaw law = ParameterLayout::ScaledLaw(theta);
  const models::SeriesSpring rig = RigOf(theta);
  const ScaledRecord& record = data_->records[r];
  if (theta.size() <= first_overshoot_.front()) {
    if (gradient == nullptr) {
      models::EvaluateForce(*model_, law, PathOf(r, theta), record.displacement, force, rig);
    } else {
      gradient->resize(force.size() * kGradientColumns);
      models::EvaluateForceAndGradient(*model_, law, PathOf(r, theta), record.displacement, force,
                                       *gradient, rig);
    }
    return;
  }
  const TurnedHistory turned = PutInTurningPoints(
      record, std::span(theta).subspan(first_overshoot_[r], record.reversals.size()));
  const LoadingPath path =
      MakePath(*model_, state_, r, turned.displacement, turned.reversals, theta);
  std::vector<double> all_force(turned.displacement.size());
  std::vector<double> all_gradient;
  if (gradient == nullptr) {
    models::EvaluateForce(*model_, law, path, turned.displacement, all_force, rig);
  } else {
    all_gradient.resize(all_force.size() * kGradientColumns);
    gradient->resize(force.size() * kGradientColumns);
    models::EvaluateForceAndGradient(*model_, law, path, turned.displacement, all_force,
                                     all_gradient, rig);
  }
  for (std::size_t i = 0; i < force.size(); ++i) {
    force[i] = all_force[turned.samples[i]];
    if (gradient == nullptr) continue;
    std::copy_n(&all_gradient[turned.samples[i] * kGradientColumns], kGradientColumns,
                &(*gradient)[i * kGradientColumns]);
  }
}

models::SeriesSpring ForceResidual::RigOf(const std::vector<double>& theta) const {
  if (!has_rig_) return {};
  return {.stiffness = std::exp(theta[kLogRigStiffness])};
}

void ForceResidual::Complete(std::size_t r, const std::vector<double>& theta,
                             std::span<double> force) const {
  const ScaledRecord& record = data_->records[r];
  const double offset = theta[ParameterLayout::OfRecord(r, kForceOffset)];
  const double drift = theta[ParameterLayout::OfRecord(r, kForceDrift)];
  const double slope = theta[kPlateauSlope];
  for (std::size_t i = 0; i < force.size(); ++i) {
    if (!record.load_ratio.empty()) force[i] *= record.load_ratio[i];
    force[i] += offset + drift * record.time[i] + slope * record.displacement[i];
  }
}

void ForceResidual::Predict(const std::vector<double>& theta, std::span<double> force) const {
  std::size_t begin = 0;
  for (std::size_t r = 0; r < data_->records.size(); ++r) {
    const std::span<double> part = force.subspan(begin, data_->records[r].force.size());
    Respond(r, theta, part, nullptr);
    Complete(r, theta, part);
    begin += part.size();
  }
}

void ForceResidual::Evaluate(const std::vector<double>& theta, std::span<double> residual) const {
  Predict(theta, residual);
  std::size_t begin = 0;
  for (const ScaledRecord& record : data_->records) {
    for (std::size_t i = 0; i < record.force.size(); ++i) {
      residual[begin + i] = record.root_weight[i] * (residual[begin + i] - record.force[i]);
    }
    begin += record.force.size();
  }
}

double ForceResidual::SumOfSquares(const std::vector<double>& theta) const {
  std::vector<double> residual(size());
  Evaluate(theta, residual);
  return std::inner_product(residual.begin(), residual.end(), residual.begin(), 0.0);
}

void ForceResidual::Differentiate(const std::vector<double>& theta,
                                  std::span<const std::size_t> free, std::span<double> residual,
                                  std::span<double> jacobian) const {
  std::ranges::fill(jacobian, 0.0);  // a record knows nothing of another's offsets
  std::vector<double> gradient;
  std::vector<double> shifted(theta);
  std::size_t begin = 0;
  for (std::size_t r = 0; r < data_->records.size(); ++r) {
    const ScaledRecord& record = data_->records[r];
    const std::size_t count = record.force.size();
    const std::span<double> part = residual.subspan(begin, count);
    Respond(r, theta, part, &gradient);
    const auto fill = [&](std::size_t column, auto value_of_sample) {
      for (std::size_t i = 0; i < count; ++i) {
        jacobian[(begin + i) * free.size() + column] = record.root_weight[i] * value_of_sample(i);
      }
    };
    const auto load_ratio = [&record](std::size_t i) {
      return record.load_ratio.empty() ? 1.0 : record.load_ratio[i];
    };
    const auto from_model = [&](models::GradientColumn model_column) {
      return [&gradient, &load_ratio, model_column](std::size_t i) {
        return load_ratio(i) * gradient[i * kGradientColumns + model_column];
      };
    };
    const std::size_t last_overshoot = first_overshoot_[r] + record.reversals.size();
    for (std::size_t column = 0; column < free.size(); ++column) {
      const std::size_t parameter = free[column];
      if (parameter == kLogStiffness) {
        fill(column, from_model(models::kPerLogStiffness));
      } else if (parameter == kShapeExponent) {
        fill(column, from_model(models::kPerShapeExponent));
      } else if (parameter == kLogSlipForce) {
        fill(column, from_model(models::kPerLogSlipForce));
      } else if (parameter == kLogRigStiffness) {
        fill(column, from_model(models::kPerLogSeriesStiffness));
      } else if (parameter == kPlateauSlope) {
        fill(column, [&](std::size_t i) { return record.displacement[i]; });
      } else if (parameter == ParameterLayout::OfRecord(r, kForceOffset)) {
        fill(column, [](std::size_t) { return 1.0; });
      } else if (parameter == ParameterLayout::OfRecord(r, kUnloadedDisplacement)) {
        fill(column, from_model(models::kPerUnloadedDisplacement));
      } else if (parameter == ParameterLayout::OfRecord(r, kForceDrift)) {
        fill(column, [&](std::size_t i) { return record.time[i]; });
      } else if (parameter >= first_overshoot_[r] && parameter < last_overshoot) {
        // Which branches a turning point begins and closes changes with it: by central differences,
        // good to 1e-10, which costs the solver no digit of the solution.
        constexpr double kStep = 1e-6;
        std::vector<double> above(count);
        std::vector<double> below(count);
        shifted[parameter] = theta[parameter] + kStep;
        Respond(r, shifted, above, nullptr);
        shifted[parameter] = theta[parameter] - kStep;
        Respond(r, shifted, below, nullptr);
        shifted[parameter] = theta[parameter];
        fill(column,
             [&](std::size_t i) { return load_ratio(i) * (above[i] - below[i]) / (2 * kStep); });
      }
    }
    Complete(r, theta, part);
    for (std::size_t i = 0; i < count; ++i) {
      part[i] = record.root_weight[i] * (part[i] - record.force[i]);
    }
    begin += count;
  }
}

}  // namespace mindahl::identification
