#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace mindahl::identification {

/// Says whether the model describes the record.
enum class AdequacyVerdict {
  kAdequate,    ///< residuals look like noise in this record
  kDoubtful,    ///< they do not; intervals cover what the causes that explain it would change
  kInadequate,  ///< parameters of this model mean nothing for this record
};

/// Grades the use of the fitted parameters by the force that the model misses over the half gap
/// measured without a model.
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
  double size = 0.0;        ///< its value in `unit`; of several numbers the first
  std::string_view unit;    ///< "s", "samples", "N s/m" …
  std::string option;       ///< command-line option that fits it; empty where there is none yet
  /// Largest shift that it would cause in σ, α or Tc [half width of their 95 % intervals].
  double moves = 0.0;
  bool is_measured = false;  ///< seen in the record without the model, and named first
};

/// A fit's judgement of itself: docs/identification.md.
struct Adequacy {
  AdequacyVerdict verdict = AdequacyVerdict::kAdequate;
  /// rms of what is explained by all causes together or comes back in every stroke, over that of
  /// the noise
  double misfit_over_noise = 0.0;
  double misfit = 0.0;        ///< rms of what the model misses [N or m]
  double p_value = 1.0;       ///< probability of such residuals from noise alone
  std::vector<Cause> causes;  ///< those that help, the best first
  /// rms of what the model misses over the measured half gap; empty where no gap was measured.
  std::optional<double> misfit_over_half_gap;
  Use use = Use::kNone;
  std::size_t tried = 0;  ///< causes that the record can identify; 0: no verdict
};

}  // namespace mindahl::identification
