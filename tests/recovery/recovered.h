#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "mindahl/identification/fit.h"
#include "mindahl/loop/record.h"
#include "mindahl/models/branch_law.h"
#include "support/histories.h"
#include "support/message_of.h"

/// Records of known contacts, and how far a fit is from what made them.
namespace mindahl::testing {

/// What the tool promises for noise-free loops between half and three times gross slip. Rounding
/// errors of the samples, 1e-16, are magnified by at most the condition of the fit, below 1e4
/// there.
inline constexpr double kNoiseFree = 1e-8;

/// Sine or triangle of amplitude 1 and mean 0.
enum class Wave { kSine, kTriangle };

/// `phase` in cycles; 0 at phase 0, then up.
inline double WaveAt(Wave wave, double phase) {
  constexpr double kTwoPi = 6.283185307179586;
  if (wave == Wave::kSine) return std::sin(kTwoPi * phase);
  const double turn = phase - std::floor(phase);
  if (turn <= 0.25) return 4 * turn;
  if (turn <= 0.75) return 2 - 4 * turn;
  return 4 * turn - 4;
}

/// Displacements of `cycles` cycles from zero, samples on the extremes.
inline History Cycling(Wave wave, double amplitude, double cycles, int samples_per_cycle) {
  History history;
  const int last = static_cast<int>(std::lround(cycles * samples_per_cycle));
  for (int i = 0; i <= last; ++i) {
    // Whole samples in a cycle: the extremes repeat to the last bit.
    const double phase = static_cast<double>(i % samples_per_cycle) / samples_per_cycle;
    history.push_back(amplitude * WaveAt(wave, phase));
  }
  return history;
}

inline loop::Record MakeRecord(History displacement, std::vector<double> force) {
  return {.displacement = std::move(displacement), .force = std::move(force)};
}

/// A Masing contact from its unloaded state.
inline loop::Record LoopOf(const models::BranchLaw& law, const History& displacement) {
  return MakeRecord(displacement, Respond(Model("mindlin-dahl"), law, displacement));
}

inline identification::FitOptions OfModel(std::string_view model) {
  return {.model = &Model(model)};
}

inline identification::FitOptions Virgin() {
  return {.initial_state = models::InitialState::kVirgin};
}

/// The samples from `begin` on.
inline loop::Record From(loop::Record record, std::size_t begin) {
  const auto cut = [begin](std::vector<double>& column) {
    if (!column.empty()) column.erase(column.begin(), column.begin() + static_cast<long>(begin));
  };
  cut(record.displacement);
  cut(record.force);
  cut(record.time);
  cut(record.normal_load);
  return record;
}

/// Read every `step` [s].
inline loop::Record Timed(loop::Record record, double step, double start = 0.0) {
  record.time.clear();
  for (std::size_t i = 0; i < record.size(); ++i) {
    record.time.push_back(start + step * static_cast<double>(i));
  }
  return record;
}

inline loop::Record Shifted(loop::Record record, double displacement, double force) {
  for (double& x : record.displacement) x += displacement;
  for (double& f : record.force) f += force;
  return record;
}

inline loop::Record Scaled(loop::Record record, double displacement, double force) {
  for (double& x : record.displacement) x *= displacement;
  for (double& f : record.force) f *= force;
  return record;
}

inline loop::Record WithForceNoise(loop::Record record, double standard_deviation,
                                   Generator& generator) {
  for (double& force : record.force) force += standard_deviation * Normal(generator);
  return record;
}

/// A Masing contact in series with a rig's spring [N/m], moved together to 1.5 times gross slip.
inline loop::Record SprungLoop(const models::BranchLaw& law, double stiffness) {
  const double reach = 1.5 * (GrossSlipDisplacement(law) + law.slip_force / stiffness);
  const History displacement = Cycling(Wave::kSine, reach, 2.0, 200);
  return MakeRecord(displacement,
                    Respond(Model("mindlin-dahl"), law, displacement, {}, {stiffness}));
}

inline identification::FitResult FitOne(const loop::Record& record,
                                        const identification::FitOptions& options = {}) {
  return identification::Fit({&record, 1}, options);
}

/// Message of the InvalidArgument of a fit; empty when it throws none.
inline std::string RefusalOf(const std::vector<loop::Record>& records,
                             const identification::FitOptions& options) {
  return MessageOf([&] { identification::Fit(records, options); });
}

/// True if an interval, open where it has no end, contains the truth.
inline bool Covers(const identification::ParameterEstimate& estimate, double truth) {
  return estimate.lower95.value_or(truth) <= truth && truth <= estimate.upper95.value_or(truth);
}

/// The name and the value of each parameter.
inline std::array<std::pair<const char*, double>, 3> ParametersOf(const models::BranchLaw& law) {
  return {{{"sigma", law.tangential_stiffness},
           {"alpha", law.shape_exponent},
           {"slip_force", law.slip_force}}};
}

/// Largest of the relative errors of σ, α and Tc; of an α below 0.1 that over 0.1.
inline double WorstError(const models::BranchLaw& law, const models::BranchLaw& truth) {
  const double sigma = std::abs(law.tangential_stiffness / truth.tangential_stiffness - 1);
  const double alpha =
      std::abs(law.shape_exponent - truth.shape_exponent) / std::max(truth.shape_exponent, 0.1);
  const double slip_force = std::abs(law.slip_force / truth.slip_force - 1);
  const double worst = std::max({sigma, alpha, slip_force});
  return std::isfinite(sigma + alpha + slip_force) ? worst : HUGE_VAL;
}

inline ::testing::AssertionResult Recovers(const identification::FitResult& fit,
                                           const models::BranchLaw& truth, double tolerance) {
  const double worst = WorstError(fit.law, truth);
  if (fit.converged && worst <= tolerance) return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure()
         << (fit.converged ? "" : "not converged (" + fit.solver.message + "), ")
         << "relative error " << worst << " above " << tolerance << ": sigma "
         << fit.law.tangential_stiffness << " of " << truth.tangential_stiffness << ", alpha "
         << fit.law.shape_exponent << " of " << truth.shape_exponent << ", slip force "
         << fit.law.slip_force << " of " << truth.slip_force << "; rms over Tc "
         << fit.residuals.rms / fit.law.slip_force << ", "
         << (fit.initial_state == models::InitialState::kVirgin ? "virgin" : "steady");
}

}  // namespace mindahl::testing
