#include "identification/diagnosis/law_findings.h"

#include <utility>

namespace mindahl::identification {

void SayLaw(const std::optional<LawChoice>& choice, FitResult& result) {
  if (!choice) return;
  const bool other_is_better = choice->decided && choice->preferred == choice->alternative;
  const bool is_inadequate = result.adequacy.verdict == AdequacyVerdict::kInadequate;
  if (is_inadequate && !other_is_better) return;
  result.law_choice = choice;
  if (choice->decided && !other_is_better) return;
  Finding finding{
      .code = other_is_better ? FindingCode("other_law_fits_better") : FindingCode("law_undecided"),
      .parameters = {"sigma", "slip_force"},
      .numbers = {{"sigma", choice->law.tangential_stiffness},
                  {"alpha", choice->law.shape_exponent},
                  {"slip_force", choice->law.slip_force}},
      .kind = choice->alternative->name};
  if (choice->delta_aicc) finding.numbers.emplace_back("delta_aicc", *choice->delta_aicc);
  result.findings.push_back(std::move(finding));
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
