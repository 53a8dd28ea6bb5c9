#include "cli/established.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <memory>
#include <string>

#include "mindahl/core/error.h"

namespace mindahl::cli {

using identification::AdequacyVerdict;
using identification::FitResult;
using identification::Identifiability;
using identification::ParameterEstimate;
using identification::ParameterStatus;

bool Established(const FitResult& fit, Strictness strictness) {
  if (!fit.converged) return false;
  const AdequacyVerdict verdict = fit.adequacy.verdict;
  switch (strictness) {
    case Strictness::kNone:
      return true;
    case Strictness::kDoubtful:
      return verdict != AdequacyVerdict::kInadequate &&
             std::ranges::all_of(fit.parameters, &ParameterEstimate::is_known);
    case Strictness::kAdequate:
      return verdict == AdequacyVerdict::kAdequate &&
             std::ranges::all_of(fit.parameters, [](const ParameterEstimate& estimate) {
               return estimate.status == ParameterStatus::kFixed ||
                      estimate.identifiability == Identifiability::kIdentifiable;
             });
  }
  return false;
}

void AddStrict(CLI::App& command, Strictness& strictness, const std::string& otherwise,
               const std::string& group) {
  // A configuration has `strict = true`.
  static const std::map<std::string, Strictness> levels = {{"adequate", Strictness::kAdequate},
                                                           {"true", Strictness::kAdequate},
                                                           {"doubtful", Strictness::kDoubtful},
                                                           {"false", Strictness::kNone}};
  const auto text = std::make_shared<std::string>();
  const auto read = [text, &strictness](const std::string& given) {
    const auto level = levels.find(given);
    if (level == levels.end()) {
      throw InputError(fmt::format(
          "--strict: '{}' is no verdict: give --strict for adequate, or --strict=doubtful", given));
    }
    strictness = level->second;
  };
  command
      .add_flag("--strict{adequate}", *text,
                otherwise +
                    " unless the model is adequate and every free\n"
                    "parameter identifiable; --strict=doubtful accepts a doubtful\n"
                    "model and parameters that are effective")
      ->each(read)
      ->group(group);
}

}  // namespace mindahl::cli
