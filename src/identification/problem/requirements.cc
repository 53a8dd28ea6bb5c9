#include "identification/problem/requirements.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "core/refuse.h"
#include "mindahl/core/error.h"
#include "mindahl/identification/fit.h"
#include "mindahl/identification/terms.h"

namespace mindahl::identification {
void Validate(const FitOptions& options) {
  if (options.model == nullptr) throw InvalidArgument("there is no model to be fitted");
  if (options.force_noise) RequirePositive("force_noise [N]", *options.force_noise);
  if (!(options.confidence > 0 && options.confidence < 1)) {
    ThrowInvalid("confidence [-]", options.confidence, "must be between 0 and 1, as 0.95");
  }
  loop::Validate(options.preparation);
  for (const std::string& name : options.terms) {
    const Term* const term = FindTerm(name, options.response());
    if (term == nullptr || term->of_column || term->presence == Presence::kAlways ||
        term->presence == Presence::kOffsets || term->presence == Presence::kLoadSeries) {
      throw InvalidArgument(fmt::format("'{}' is not a term that can be added", name));
    }
    RequirePlace(*term, options.response());
  }
  if (!options.covariates.empty()) {
    RequirePlace(TermOf(TermId::kCovariate, options.response()), options.response());
  }
  if (options.response() == loop::Channel::kDisplacement && options.force_noise) {
    throw InvalidArgument("noise of the force, which is imposed and taken as exact: leave it out");
  }
  if (options.response_noise())
    RequirePositive("displacement noise [m]", *options.response_noise());
  if (options.model->memory == models::Memory::kNone && HasTerm(options, TermId::kAsymmetry) &&
      HasTerm(options, TermId::kRigStiffness)) {
    throw InvalidArgument(
        fmt::format("asymmetry and rig_stiffness of {}: the rig deflects with the force, which is "
                    "not the state that the law integrates; leave one out, or use --model "
                    "mindlin-dahl, mindlin or jenkins",
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
  const std::optional<double> noise = options.response_noise();
  if (!noise || *noise / data.response_unit() < 1e100) return;
  ThrowInvalid(is_forced ? "displacement noise [m]" : "force_noise [N]", *noise,
               "must be below 1e100 times half the range of the records");
}

void RequireEnoughSamples(const Problem& problem, const loop::PreparedRecords& prepared) {
  const std::size_t free = problem.parameters.free().size();
  const std::size_t counted = problem.data->counted;
  if (counted > free) return;
  const std::size_t left_out = prepared.samples() - counted;
  const std::string without = left_out == 0 ? ""
                                            : fmt::format("; of {} that were read {} are left out",
                                                          prepared.samples(), left_out);
  throw InvalidArgument(
      fmt::format("{} samples are too few for {} free parameters{}: record more or fix some",
                  counted, free, without));
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
  if (rig == options.fixed.end()) return;  // one with a prior is fitted
  for (const loop::PreparedRecord& record : records.records) {
    const double stiffness = record.facts.peak_force / record.facts.amplitude;
    if (!(rig->second > 0) || !(rig->second <= stiffness)) continue;
    ThrowInvalid("rig_stiffness [N/m]", rig->second,
                 fmt::format("must be > {:.4g}, the stiffness of the loop itself from end to end: "
                             "measure the rig again, or fit it",
                             stiffness));
  }
}

}  // namespace mindahl::identification
