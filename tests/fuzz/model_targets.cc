#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

#include "fuzz/bytes.h"
#include "mindahl/core/error.h"
#include "mindahl/loop/reversals.h"
#include "mindahl/models/contact_state.h"
#include "mindahl/models/response.h"

namespace mindahl::fuzz {
namespace {

using models::BranchLaw;
using models::FrictionModel;

std::vector<double> Displacements(Bytes& bytes) {
  std::vector<double> displacements;
  while (!bytes.empty()) displacements.push_back(bytes.Double());
  return displacements;
}

/// Returns displacements of which a path is made: within ±1e307 m.
std::vector<double> FiniteDisplacements(Bytes& bytes) {
  std::vector<double> displacements = Displacements(bytes);
  std::erase_if(displacements, [](double value) { return !(std::abs(value) <= 1e307); });
  return displacements;
}

BranchLaw LawOf(Bytes& bytes) {
  return {.tangential_stiffness = bytes.Double(),
          .shape_exponent = bytes.Double(),
          .slip_force = bytes.Double()};
}

/// True if |T| <= Tc.
bool IsAllowed(const BranchLaw& law, double force) { return std::abs(force) <= law.slip_force; }

}  // namespace

void FindTurns(Input input) {
  Bytes bytes(input);
  const double gate = std::abs(bytes.Double());
  const std::vector<double> displacement = FiniteDisplacements(bytes);
  if (!std::isfinite(gate)) return;
  const std::vector<std::size_t> found = loop::FindReversals(displacement, gate);
  loop::ReversalFinder finder(gate);
  std::vector<std::size_t> streamed;
  for (const double value : displacement) {
    if (const std::optional<std::size_t> turn = finder.Add(value)) streamed.push_back(*turn);
  }
  Require(found == streamed, "reversals are the same of a record and of its samples");
  for (std::size_t i = 1; i < found.size(); ++i) {
    Require(found[i - 1] < found[i] && found[i] < displacement.size(), "reversals ascend");
    const double step = displacement[found[i]] - displacement[found[i - 1]];
    Require(std::abs(step) > gate, "reversals are farther apart than the gate");
    if (i < 2) continue;
    const double before = displacement[found[i - 1]] - displacement[found[i - 2]];
    Require((step > 0) != (before > 0), "maxima and minima alternate");
  }
  const loop::ReversalGate chosen = loop::ChooseReversalGate(displacement);
  Require(std::isfinite(chosen.gate) && chosen.gate >= 0, "a gate is finite");
}

void EvaluateModels(Input input) {
  Bytes bytes(input);
  const BranchLaw law = LawOf(bytes);
  const models::SeriesSpring rig{bytes.Byte() % 2 == 0 ? models::SeriesSpring{}.stiffness
                                                       : bytes.Double()};
  const std::vector<double> displacement = Displacements(bytes);
  const bool is_finite =
      std::ranges::all_of(displacement, [](double value) { return std::isfinite(value); });
  const std::vector<std::size_t> reversals =
      is_finite ? loop::FindReversals(displacement, 0.0) : std::vector<std::size_t>{};
  std::vector<double> force(displacement.size());
  for (const FrictionModel& model : models::FrictionModels()) {
    try {
      const models::LoadingPath path =
          models::MakeLoadingPath(displacement, reversals, model.memory, {});
      Require(is_finite, "a displacement that is not finite is refused");
      models::EvaluateForce(model, law, path, displacement, force, rig);
    } catch (const InvalidArgument&) {
      continue;
    }
    for (const double value : force) {
      Require(IsAllowed(law, value), "a force is a number within the slip force");
    }
  }
}

void MoveContacts(Input input) {
  Bytes bytes(input);
  const std::span<const FrictionModel> all = models::FrictionModels();
  const FrictionModel& model = all[bytes.Byte() % all.size()];
  const BranchLaw law = LawOf(bytes);
  std::optional<models::ContactState> state;
  try {
    state.emplace(model, law);
  } catch (const InvalidArgument&) {
    return;
  }
  while (!bytes.empty()) {
    const double displacement = bytes.Double();
    const double before = state->Force();
    std::optional<double> peeked;
    try {
      peeked = state->Peek(displacement);
    } catch (const InvalidArgument&) {
    }
    try {
      const double force = state->Move(displacement);
      Require(peeked && *peeked == force, "a look ahead is what the move gives");
      Require(IsAllowed(law, force), "a moved contact's force is within the slip force");
      Require(!std::isnan(state->TangentStiffness()), "a stiffness is a number");
    } catch (const InvalidArgument&) {
      Require(!peeked, "a look ahead is refused where the move is");
      Require(state->Force() == before, "a refused move leaves the state");
    }
  }
}

}  // namespace mindahl::fuzz
