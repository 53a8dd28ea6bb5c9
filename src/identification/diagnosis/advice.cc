#include "identification/diagnosis/advice.h"

#include <algorithm>
#include <vector>

#include "identification/problem/moved_samples.h"
#include "mindahl/identification/terms.h"

namespace mindahl::identification {
namespace {

/// An option with what is given to it.
struct Advised {
  std::string_view option;
  std::string_view words;  // "--lag fit"
};

std::vector<Advised> OptionsAmong(std::string_view words) {
  std::vector<Advised> found;
  while (!words.empty()) {
    const std::size_t next = std::min(words.find(" --"), words.size());
    const std::string_view one = words.substr(0, next);
    found.push_back({one.substr(0, one.find(' ')), one});
    words.remove_prefix(std::min(next + 1, words.size()));
  }
  return found;
}

const Term* TermOf(std::string_view option, loop::Channel response) {
  const auto terms = Terms(response);
  const auto term = std::ranges::find(terms, option, &Term::option);
  return term == terms.end() ? nullptr : &*term;
}

bool HasTimes(const ScaledRecords& data) {
  return std::ranges::none_of(data.records,
                              [](const ScaledRecord& record) { return record.velocity.empty(); });
}

/// Masing's law does not model it under a load that varies, and Dahl's own not behind a rig.
bool MayBeAsymmetric(const Problem& problem) {
  return problem.model->memory == models::Memory::kReturnPoint ? !problem.data->load_varies
                                                               : !problem.parameters.has_rig();
}

/// An asymmetry is identifiable where the offset is known, or if the contact started unloaded; of
/// Dahl's own law, whose branches bend by it, always.
bool TellsAsymmetry(const Problem& problem) {
  return problem.model->memory == models::Memory::kNone ||
         problem.state.Any(models::InitialState::kVirgin) || problem.parameters.any_zero_is_known();
}

bool IsAccepted(const Problem& problem, std::string_view option) {
  const ScaledRecords& data = *problem.data;
  if (option == "--loss") return true;
  // In a fit of the displacement the terms of the force do not exist.
  if (data.is_forced()) return option == "--drift";
  const Term* const term = TermOf(option, loop::Channel::kForce);
  if (term == nullptr) return false;
  if (term->needs_time && !HasTimes(data)) return false;
  if (ContactMotionOf(*term) != ContactMotion::kMeasured) {
    const std::size_t moved = problem.parameters.PositionOfMotion();
    const bool is_only =
        !problem.parameters.moves_contact() || problem.parameters[moved].term->name == term->name;
    const bool has_clocks = ContactMotionOf(*term) != ContactMotion::kLate || MayHaveClocks(data);
    return is_only && has_clocks && !data.load_varies;
  }
  if (term->name == "asymmetry") return MayBeAsymmetric(problem) && TellsAsymmetry(problem);
  return true;
}

}  // namespace

std::string AcceptedOptions(const Problem& problem, const FitOptions& options,
                            std::string_view wanted) {
  std::string accepted;
  bool has_asymmetry = std::ranges::find(options.terms, "asymmetry") != options.terms.end();
  for (const Advised& advised : OptionsAmong(wanted)) {
    if (!IsAccepted(problem, advised.option)) return "";
    const Term* const term = TermOf(advised.option, loop::Channel::kForce);
    const bool is_named = term != nullptr && !term->of_column;
    const std::string name(is_named ? term->name : "");
    if (is_named && options.fixed.contains(name)) return "";  // two values of one option
    // A term that is fitted already is not advised.
    if (is_named && std::ranges::find(options.terms, name) != options.terms.end()) continue;
    has_asymmetry = has_asymmetry || name == "asymmetry";
    accepted += accepted.empty() ? "" : " ";
    accepted += advised.words;
  }
  // Another term may let the steady loop win, with which an asymmetry of Masing's law is refused.
  if (!accepted.empty() && has_asymmetry && problem.model->memory == models::Memory::kReturnPoint &&
      !options.initial_state && options.initial_states.empty() &&
      !problem.parameters.any_zero_is_known()) {
    accepted += " --initial-state virgin";
  }
  return accepted;
}

}  // namespace mindahl::identification
