#include "identification/diagnosis/law_findings.h"

namespace mindahl::identification {

namespace {

bool PrefersOther(const LawChoice& choice) {
  return choice.decided && choice.preferred == choice.alternative;
}

}  // namespace

std::optional<LawChoice> ReportedLaw(const std::optional<LawChoice>& choice,
                                     AdequacyVerdict verdict) {
  const bool is_inadequate = verdict == AdequacyVerdict::kInadequate;
  return choice && is_inadequate && !PrefersOther(*choice) ? std::nullopt : choice;
}

std::optional<Finding> FindOtherLaw(const std::optional<LawChoice>& choice) {
  if (!choice || (choice->decided && !PrefersOther(*choice))) return std::nullopt;
  Finding finding{.code = PrefersOther(*choice) ? FindingCode("other_law_fits_better")
                                                : FindingCode("law_undecided"),
                  .parameters = {"sigma", "slip_force"},
                  .numbers = {{"sigma", choice->law.tangential_stiffness},
                              {"alpha", choice->law.shape_exponent},
                              {"slip_force", choice->law.slip_force}},
                  .kind = choice->alternative->name};
  if (choice->delta_aicc) finding.numbers.emplace_back("delta_aicc", *choice->delta_aicc);
  return finding;
}

std::optional<Finding> FindContradictedLaw(const MemoryTest& memory,
                                           const std::optional<LawChoice>& choice,
                                           const models::FrictionModel& fitted) {
  if (!choice || choice->preferred == nullptr || !choice->delta_aicc) return std::nullopt;
  const bool prefers_masing = choice->preferred->memory == models::Memory::kReturnPoint;
  const MemoryVerdict opposite = prefers_masing ? MemoryVerdict::kDahl : MemoryVerdict::kMasing;
  if (memory.verdict != opposite) return std::nullopt;
  return Finding{.code = "memory_contradicts_law",
                 .numbers = {{"p_value", memory.p_value},
                             {"dahl_p_value", memory.dahl_p_value},
                             {"delta_aicc", choice->preferred == &fitted ? *choice->delta_aicc
                                                                         : -*choice->delta_aicc}},
                 .kind = prefers_masing ? "masing" : "dahl"};
}

}  // namespace mindahl::identification
