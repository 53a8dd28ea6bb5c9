#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

namespace mindahl::identification {

struct ResidualStatistics {
  double rms = 0.0;        ///< [N] √(Σr²/n)
  double max_abs = 0.0;    ///< [N]
  double r_squared = 0.0;  ///< [–] 1 − Σr²/Σ(T − mean)²
  double durbin_watson = 0.0;  ///< [–] Σ(rᵢ − rᵢ₋₁)²/Σr²: 2 when white, → 0 when correlated
  /// Number of independent residuals of equal information: n/(1 + 2Σρ²), ρ the correlations of an
  /// autoregressive process (Bartlett 1946), over the strokes in which a fraction of them repeats
  double effective_samples = 0.0;
  std::size_t samples = 0;
};

/// Holds what of the residuals comes back at the same place of every stroke.
struct ResidualStructure {
  /// Fraction of the residuals' variance that repeats: 0 for noise, 1 for what the model cannot
  /// follow. 0 where an F test finds nothing, or a direction has one stroke only.
  double repeatable_share = 0.0;
  /// Variance within these strokes that does not repeat from one to the next, over the variance of
  /// all residuals: above 1 − `repeatable_share` where these strokes fit worse than the rest.
  double noise_share = 1.0;
  /// Correlation of the residuals from one stroke to the next of the same direction: near 1 if they
  /// repeat or change slowly. 0 if a direction has fewer than three strokes.
  double carried_over = 0.0;
  /// Number of strokes of growing and of falling displacement that are long enough.
  std::array<std::size_t, 2> strokes{};

  /// Returns the factor by which the variance of estimates exceeds that from noise: a residual that
  /// repeats in every stroke is not averaged away by more of them.
  [[nodiscard]] double Widening() const {
    const std::size_t most = std::max(strokes[0], strokes[1]);
    return most > 1 ? 1 + repeatable_share * static_cast<double>(most - 1) : 1.0;
  }
};

/// Says whether the model describes the record.
enum class AdequacyVerdict {
  kAdequate,    ///< residuals look like noise in this record
  kDoubtful,    ///< they do not; intervals include what their causes would change
  kInadequate,  ///< parameters of this model mean nothing for this record
};

/// Grades the use of the parameters: the force that the model misses over the measured half gap.
enum class Use {
  kQuantitative,  ///< no more than 5 % of it
  kIndicative,    ///< no more than 15 % of it
  kNone,
};

/// Describes an omitted term that the residuals look like.
struct Cause {
  std::string_view code;    ///< stable, for scripts; docs/contract.md lists them
  double delta_aicc = 0.0;  ///< change of AICc with the term: negative where it helps
  double explains = 0.0;    ///< fraction of the residuals' variance [–]
  std::string_view term;    ///< name in `--terms` that fits it; empty: none does
};

/// Holds whether, and why not, the model describes the records: docs/identification.md.
struct Adequacy {
  AdequacyVerdict verdict = AdequacyVerdict::kAdequate;
  /// rms of the residuals that causes explain or that repeat in every stroke, over the noise's
  double misfit_over_noise = 0.0;
  double misfit = 0.0;             ///< rms of what the model misses [N or m]
  double p_value = 1.0;            ///< probability of such residuals from noise alone
  std::vector<Cause> causes = {};  ///< those that help, the best first
  /// rms of what the model misses over the measured half gap; empty where no gap was measured.
  std::optional<double> misfit_over_half_gap = {};
  Use use = Use::kNone;
  std::size_t tried = 0;  ///< causes that the record can identify; 0: no verdict
};

}  // namespace mindahl::identification
