#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "identification/problem/problem.h"
#include "mindahl/models/friction_model.h"
#include "mindahl/models/loading_path.h"
#include "models/normalized_response.h"

/// Columns of forces that arise along the branches of a response, to first order: what one is at a
/// sample is what it is where the sample's branch starts, and what was added on the branch since.
namespace mindahl::identification {

/// A sample, or the origin of a branch on the one before, in units of the data; forces are the
/// contact's over the slip force.
template <typename Place>
concept OnBranch = std::default_initializable<Place> && requires(Place at) {
  { at.displacement } -> std::convertible_to<double>;
  { at.response } -> std::convertible_to<double>;
  { at.slope } -> std::convertible_to<double>;            // ∂response/∂displacement
  { at.gain } -> std::convertible_to<double>;             // by the response at the branch's origin
  { at.direction } -> std::convertible_to<double>;        // of the branch
  { at.sets_out } -> std::convertible_to<bool>;           // on the virgin curve, as first run
  { at.virgin } -> std::convertible_to<bool>;             // on the virgin curve
  { at.reach } -> std::convertible_to<double>;            // of the response, from origin to slip
  { at.origin } -> std::convertible_to<double>;           // displacement where the branch starts
  { at.origin_response } -> std::convertible_to<double>;  // likewise
};

/// Sets what a place has of a branch that starts at `origin`.
template <OnBranch Place>
void PutOn(const models::Branch& branch, const Place& origin, const models::FrictionModel& model,
           Place& at) {
  at.virgin = models::IsVirgin(branch.start);
  at.direction = at.virgin ? std::copysign(1.0, at.displacement - branch.origin)
                           : static_cast<double>(branch.direction);
  at.sets_out = at.virgin && at.direction * branch.direction > 0;
  const models::BranchScale scale = model.scale(at.direction * origin.response, 0.0, at.virgin);
  at.reach = scale.span * scale.remaining;
  at.origin = branch.origin;
  at.origin_response = origin.response;
}

/// Gives each sample its branch, and returns the place of each branch's origin on its parent.
template <OnBranch Place>
std::vector<Place> FollowBranches(const models::FrictionModel& model,
                                  const models::LoadingPath& path,
                                  const models::OriginSensitivity& sensitivity,
                                  std::span<Place> places) {
  const std::size_t count = path.branches.size();
  std::vector<Place> origins(count);
  for (std::size_t b = 0; b < count; ++b) {
    const models::Branch& branch = path.branches[b];
    Place& origin = origins[b];
    if (branch.start != models::BranchStart::kUnloaded) {
      origin.response = sensitivity.origin_force[b];
    }
    origin.displacement = branch.origin;
    origin.slope = sensitivity.slope[b];
    origin.gain = sensitivity.gain[b];
    if (branch.parent < 0) continue;
    const auto parent = static_cast<std::size_t>(branch.parent);
    PutOn(path.branches[parent], origins[parent], model, origin);
    origin.reach *= models::VirginLimit(path, path.branches[parent]);
  }
  for (const models::BranchRun& run : path.runs) {
    const auto b = static_cast<std::size_t>(run.branch);
    for (std::size_t i = run.begin; i < run.end; ++i) {
      PutOn(path.branches[b], origins[b], model, places[i]);
      places[i].reach *= models::VirginLimit(path, path.branches[b]);
    }
  }
  return origins;
}

/// The upper extreme of the steady loop, on the branch from the lower one.
template <OnBranch Place>
Place SteadyExtreme(const Problem& problem, const LawPoint& point, const ScaledRecord& record) {
  const std::span<const double> displacement = record.displacement;
  const auto [lowest, highest] = std::ranges::minmax(displacement);
  const std::array<double, 2> stroke = {lowest, highest};
  const bool is_masing = problem.model->memory == models::Memory::kReturnPoint;
  const models::LoadingPath path = models::MakeLoadingPath(
      stroke, {}, problem.model->memory,
      {.state = models::InitialState::kSteady,
       .asymmetry = is_masing ? problem.parameters.AsymmetryAt(point.theta) : 0.0});
  const models::NormalizedLaw law = LawUnder(problem, point, record);
  models::NormalizedResponse response;
  std::array<double, 2> t{};
  response.Evaluate(*problem.model, law, path, stroke, t);
  models::OriginSensitivity sensitivity;
  response.DifferentiateByOrigins(*problem.model, law, path, stroke, sensitivity);
  Place at;
  at.displacement = highest;
  at.response = t[1];
  at.slope = sensitivity.sample_slope[1];
  at.gain = sensitivity.sample_gain[1];
  Place from;
  from.response = t[0];
  PutOn(path.branches[static_cast<std::size_t>(path.runs.back().branch)], from, *problem.model, at);
  return at;
}

/// Returns a column's values where branches start, from its value on the first of them.
/// @param value  what is added on a branch up to a place
template <OnBranch Place, typename Value>
std::vector<double> StartsOf(const Value& value, const models::LoadingPath& path,
                             std::span<const Place> origins, double first) {
  std::vector<double> start(origins.size(), first);
  for (std::size_t b = 0; b < origins.size(); ++b) {
    const std::int32_t parent = path.branches[b].parent;
    if (parent < 0) continue;
    start[b] = origins[b].gain * start[static_cast<std::size_t>(parent)] + value(origins[b]);
  }
  return start;
}

/// On the first branch: nothing where the contact was unloaded; a steady loop stays symmetric.
template <OnBranch Place, typename Value>
double FirstStart(const Value& value, const models::LoadingPath& path, const Place& extreme,
                  std::span<const Place> origins) {
  switch (path.branches.front().start) {
    case models::BranchStart::kSteadyCentre: {
      const std::vector<double> start = StartsOf(value, path, origins, 0.0);
      return -(start[1] + start[2]) / 2;
    }
    case models::BranchStart::kSteadyExtreme:
      return -path.branches.front().direction * value(extreme) / (1 + extreme.gain);
    default:
      return 0.0;
  }
}

/// The column at every sample, over the slip force.
template <OnBranch Place, typename Value>
void FillAlongBranches(const Value& value, const models::LoadingPath& path, const Place& extreme,
                       std::span<const Place> places, std::span<const Place> origins,
                       std::span<double> column) {
  const std::vector<double> start =
      StartsOf(value, path, origins, FirstStart(value, path, extreme, origins));
  for (const models::BranchRun& run : path.runs) {
    for (std::size_t i = run.begin; i < run.end; ++i) {
      column[i] = places[i].gain * start[static_cast<std::size_t>(run.branch)] + value(places[i]);
    }
  }
}

}  // namespace mindahl::identification
