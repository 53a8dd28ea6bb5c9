#include "mindahl/campaign/shared_alpha.h"

#include <fmt/format.h>

#include <filesystem>
#include <system_error>

#include "mindahl/core/error.h"
#include "mindahl/io/csv_table.h"
#include "report/statements.h"

namespace mindahl::campaign {

void RequireThatAlphaCanBeShared(const identification::FitOptions& fit,
                                 std::span<const std::string> files) {
  if (fit.model->shape_exponent || fit.fixed.contains("alpha")) {
    throw InputError(
        fmt::format("--alpha shared: alpha is not fitted: {} it",
                    fit.fixed.contains("alpha") ? "--fix holds" : "--model prescribes"));
  }
  for (const std::string& file : files) {
    std::error_code error;
    const auto status = std::filesystem::status(file, error);
    const bool is_there_twice =
        !std::filesystem::exists(status) || std::filesystem::is_regular_file(status);
    if (file != io::kStandardInput && is_there_twice) continue;
    throw InputError(fmt::format(
        "--alpha shared: {} can be read only once, and two passes are needed: write it to a file",
        file));
  }
}

void PoolAlpha(const CycleFit& fit, PooledValue& alpha) {
  const bool is_known = !fit.HasFlag("not_converged") && !fit.HasFlag("alpha_open");
  const FittedValue& own = fit.alpha;
  if (!is_known || !own.value || !own.standard_error) return;
  if (*own.standard_error > 0) alpha.Add(*own.value, *own.standard_error);
}

void RequireSharedAlpha(const PooledValue& alpha) {
  if (alpha.count() > 0) return;
  throw InputError(
      "--alpha shared: no cycle determines alpha: --fix alpha=VALUE holds it at one that is "
      "known");
}

std::string SharedAlphaInWords(const PooledValue& alpha) {
  return fmt::format(
      "alpha {:.6g} ± {:.2g} shared, of {} cycles that scatter by {:.2g} beyond their errors, {}",
      alpha.mean(), alpha.standard_error(), alpha.count(), alpha.scatter(),
      report::ChanceText(alpha.p_value(), 1));
}

}  // namespace mindahl::campaign
