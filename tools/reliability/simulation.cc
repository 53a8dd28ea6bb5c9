#include "simulation.h"

#include <algorithm>
#include <cmath>

#include "mindahl/loop/reversals.h"
#include "mindahl/models/friction_model.h"
#include "mindahl/models/loading_path.h"
#include "mindahl/models/response.h"

namespace mindahl::reliability {

using loop::Record;

Motion Wave(const Truth& truth, const models::ExcitationOptions& options) {
  models::ExcitationOptions complete = options;
  complete.amplitude = Amplitude(truth);
  complete.samples_per_cycle = truth.samples_per_cycle;
  complete.frequency = truth.frequency;
  models::Excitation excitation = models::MakeExcitation(complete);
  return {std::move(excitation.time), std::move(excitation.displacement), 0};
}

Motion Sine(const Truth& truth, Draws& draws) {
  const std::size_t unseen =
      truth.virgin ? 0 : truth.samples_per_cycle + draws.Index(truth.samples_per_cycle);
  // Whole cycles by the row: a record that is not virgin ends where it began.
  const std::size_t rows = unseen + truth.cycles * truth.samples_per_cycle;
  Motion motion = Wave(
      truth, {.cycles = static_cast<double>(rows) / static_cast<double>(truth.samples_per_cycle)});
  motion.unseen = unseen;
  return motion;
}

Contact Masing(const models::BranchLaw& law) {
  return [law](std::span<const double> displacement, std::span<double> force) {
    const models::FrictionModel& model = *models::FindFrictionModel("mindlin-dahl");
    const models::LoadingPath path = models::MakeLoadingPath(
        displacement, loop::FindReversals(displacement, 0.0), model.memory, {});
    models::EvaluateForce(model, law, path, displacement, force);
  };
}

Record Drive(const Motion& motion, const Contact& contact) {
  Record record;
  record.time = motion.time;
  record.displacement = motion.displacement;
  record.force.resize(record.displacement.size());
  contact(record.displacement, record.force);
  return Part(record, motion.unseen, record.size());
}

Record Ideal(const Truth& truth, Draws& draws) {
  return Drive(Sine(truth, draws), Masing(truth.law));
}

void AddNoise(Record& record, const Truth& truth, Draws& draws) {
  for (double& force : record.force) {
    force += truth.noise * truth.law.slip_force * draws.Normal();
  }
}

Record Measured(const Truth& truth, Draws& draws) {
  Record record = Ideal(truth, draws);
  AddNoise(record, truth, draws);
  return record;
}

Record Rows(const Record& record, std::span<const std::size_t> rows) {
  Record kept;
  for (const std::size_t row : rows) {
    kept.displacement.push_back(record.displacement[row]);
    kept.force.push_back(record.force[row]);
    if (!record.time.empty()) kept.time.push_back(record.time[row]);
    if (!record.normal_load.empty()) kept.normal_load.push_back(record.normal_load[row]);
  }
  return kept;
}

Record Part(const Record& record, std::size_t begin, std::size_t end) {
  std::vector<std::size_t> rows;
  for (std::size_t row = begin; row < end; ++row) rows.push_back(row);
  return Rows(record, rows);
}

std::vector<double> Velocity(const Record& record) {
  const std::vector<double>& displacement = record.displacement;
  const std::size_t last = record.size() - 1;
  std::vector<double> velocity(record.size());
  double fastest = 0.0;
  for (std::size_t i = 0; i < record.size(); ++i) {
    const std::size_t before = i == 0 ? 0 : i - 1;
    const std::size_t after = std::min(i + 1, last);
    velocity[i] =
        (displacement[after] - displacement[before]) / static_cast<double>(after - before);
    fastest = std::max(fastest, std::abs(velocity[i]));
  }
  for (double& value : velocity) value /= fastest;
  return velocity;
}

std::vector<std::size_t> Turns(const Record& record) {
  return loop::FindReversals(record.displacement, 0.0);
}

double Progress(const Record& record, std::size_t row) {
  return static_cast<double>(row) / static_cast<double>(record.size() - 1);
}

}  // namespace mindahl::reliability
