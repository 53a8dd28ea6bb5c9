#include "identification/problem/requirements.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "identification/problem/scaled_records.h"
#include "mindahl/core/error.h"
#include "mindahl/identification/fit.h"
#include "mindahl/identification/terms.h"

namespace mindahl::identification {
namespace {

/// Refuses terms of the force in a fit of the displacement, and terms of the displacement in a fit
/// of the force.
void RequireTermsOfResponse(const FitOptions& options) {
  const bool fits_force = options.response() == loop::Channel::kForce;
  const auto refuse = [&](std::string_view what) {
    throw InvalidArgument(
        fmt::format("{} has no place in a fit of the {}: leave it out, or fit the {}", what,
                    fits_force ? "force" : "displacement", fits_force ? "displacement" : "force"));
  };
  const auto require = [&](const std::string& name) {
    const Term* term = FindTerm(TermNameOf(name), options.response());
    if (term != nullptr && term->presence == Presence::kNever) refuse(name);
  };
  for (const std::string& name : options.terms) require(name);
  for (const auto& [name, value] : options.fixed) require(name);
  if (fits_force) return;
  if (!options.covariates.empty()) refuse("a covariate");
  if (options.force_noise) refuse("noise of the force, which is imposed and taken as exact,");
  if (options.response_noise()) {
    RequirePositive("displacement noise [m]", *options.response_noise());
  }
}

/// Says how many samples do not count: "; of 12 that were read 8 are left out, 2 of them glitches".
std::string WhatIsLeftOut(const loop::PreparedRecords& prepared) {
  const std::size_t left_out = prepared.samples() - prepared.counted();
  if (left_out == 0) return "";
  std::size_t glitches = 0;
  for (const loop::PreparedRecord& record : prepared.records) glitches += record.glitches.total;
  return fmt::format("; of {} that were read {} are left out, {} of them glitches",
                     prepared.samples(), left_out, glitches);
}

constexpr std::size_t kChords = 10;

/// Stiffness [N/m] of a record's chords, as documented; 0 where it has no whole stroke.
double StiffnessOfLoop(const loop::PreparedRecord& record, double sense, double main_stroke) {
  const std::span<const double> displacement = record.displacement();
  const std::span<const double> force = record.record.force;
  std::vector<double> rise(kChords, 0.0);
  std::vector<double> way(kChords, 0.0);
  for (std::size_t k = 0; k + 1 < record.reversals.size(); ++k) {
    const std::size_t begin = record.reversals[k];
    const std::size_t end = record.reversals[k + 1];
    const double stroke = displacement[end] - displacement[begin];
    if (!(std::abs(stroke) >= main_stroke * 2 * record.facts.amplitude)) continue;
    std::size_t chord = 0;
    for (std::size_t i = begin + 1; i <= end && chord < kChords; ++i) {
      const double share = (displacement[i] - displacement[begin]) / stroke;
      if (share * kChords < static_cast<double>(chord + 1)) continue;
      const double direction = std::copysign(1.0, stroke);
      rise[chord] += direction * sense * (force[i] - force[begin]);
      way[chord] += direction * (displacement[i] - displacement[begin]);
      ++chord;
    }
  }
  double stiffness = 0.0;
  for (std::size_t chord = 0; chord < kChords; ++chord) {
    if (way[chord] > 0) stiffness = std::max(stiffness, rise[chord] / way[chord]);
  }
  return stiffness;
}

}  // namespace

void Validate(const FitOptions& options) {
  if (options.model == nullptr) throw InvalidArgument("there is no model to be fitted");
  if (options.force_noise) RequirePositive("force_noise [N]", *options.force_noise);
  if (!(options.confidence > 0 && options.confidence < 1)) {
    ThrowInvalid("confidence [-]", options.confidence, "must be between 0 and 1, as 0.95");
  }
  loop::Validate(options.preparation);
  RequireTermsOfResponse(options);
  if (options.model->memory == models::Memory::kNone && HasTerm(options, TermId::kAsymmetry) &&
      HasTerm(options, TermId::kRigStiffness)) {
    throw InvalidArgument(fmt::format(
        "asymmetry and rig_stiffness of {}: the rig deflects with the force, which is not the "
        "state that the law integrates; leave one out, or use --model mindlin-dahl, mindlin or "
        "jenkins",
        options.model->name));
  }
  if (options.max_iterations < 1) {
    ThrowInvalid("maximum iterations [-]", options.max_iterations, "must be >= 1");
  }
}

void RequireRecords(const FitOptions& options, const ScaledRecords& data) {
  const std::size_t states = options.initial_states.size();
  if (states > 1 && states != data.records.size()) {
    throw InvalidArgument(
        fmt::format("{} initial states for {} records: give one for all, or one a record", states,
                    data.records.size()));
  }
  const bool is_forced = data.is_forced();
  const bool varies = std::ranges::any_of(
      data.records, [](const ScaledRecord& record) { return !record.load_change.empty(); });
  if (is_forced && (data.is_load_series || data.load_varies || varies)) {
    throw InvalidArgument(
        "the normal load differs or varies, which a fit of the displacement does not model: fit "
        "the records of one load, or fit the force");
  }
  constexpr double kLargest = 1e100;  // in half ranges of the force
  const std::optional<double> noise = options.response_noise();
  if (!noise || *noise / data.response_unit() < kLargest) return;
  ThrowInvalid(is_forced ? "displacement noise [m]" : "force_noise [N]", *noise,
               fmt::format("must be below 1e100 times half the range of the {}, {:.4g} {}",
                           is_forced ? "displacement" : "force", data.response_unit(),
                           is_forced ? "m" : "N"));
}

void RequireEnoughSamples(const Problem& problem, const loop::PreparedRecords& prepared) {
  const std::size_t free = problem.parameters.free().size();
  if (problem.data->counted >= free) return;
  throw TooFewSamples(
      fmt::format("{} samples are too few for {} free parameters{}: record more or fix some",
                  problem.data->counted, free, WhatIsLeftOut(prepared)));
}

void RequireToldAsymmetry(const Problem& problem) {
  if (!problem.parameters[RowOf(TermId::kAsymmetry)].confounded) return;
  throw InvalidArgument(
      "asymmetry cannot be distinguished from force_offset: the contact had slipped before the "
      "fitted samples, so both are a constant force; give the force's zero if it is known, --fix "
      "force_offset=0, or fit a record that includes the first loading of the unloaded contact, "
      "with --initial-state virgin");
}

void RequireRigStifferThanLoop(const FitOptions& options, const loop::PreparedRecords& records) {
  const auto rig = options.fixed.find("rig_stiffness");
  if (rig == options.fixed.end() || !(rig->second > 0)) return;  // one with a prior is fitted
  for (const loop::PreparedRecord& record : records.records) {
    const double stiffness =
        StiffnessOfLoop(record, records.force_sense, options.thresholds.main_stroke);
    if (rig->second > stiffness) continue;
    ThrowInvalid("rig_stiffness [N/m]", rig->second,
                 fmt::format("must be > {:.4g}, the stiffness that the loop itself has after its "
                             "reversals: with a softer rig the contact would move backwards; "
                             "measure the rig again, or fit it",
                             stiffness));
  }
}

}  // namespace mindahl::identification
