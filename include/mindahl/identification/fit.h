#pragma once

#include <span>

#include "mindahl/identification/fit_options.h"
#include "mindahl/identification/fit_result.h"
#include "mindahl/loop/record.h"

namespace mindahl::identification {

/// Least-squares fits of records with the same options, one after the other.
///
/// A fit is of one contact: σ, α and Tc (and what else is not Term::is_of_record) are shared by its
/// records, offsets belong to each. It minimises
///   Σ w·(T_model(δ) − T)²,   T_model = Tc·t(δ; σ/Tc, α, δ₀, Tc/k_r) + Σ factor·column
/// over non-dimensional parameters, so that the answer does not depend on the units. t is the
/// closed form of docs/theory.md §5 with its exact gradient; there is no time step and no sampling
/// rule. Offsets and factors, in which the force is linear, are eliminated (variable projection:
/// Golub & Pereyra 1973, with Kaufman's Jacobian), so that σ, α and Tc are searched, and the origin
/// of a virgin contact. They start from a scan of the plane of σ/Tc and α on a thinned record.
class Fitter {
 public:
  /// @throws InvalidArgument for options that break a rule whatever the records are
  explicit Fitter(FitOptions options = {});

  /// @param records  [m], [N]; at least as many samples that count as free parameters
  /// @returns valid until the next call. A fit that fails is a result with converged = false and
  ///   the reason in `termination`
  /// @throws InvalidArgument for records or options that break a rule
  const FitResult& Fit(std::span<const loop::RecordView> records, Depth depth = Depth::kFull);
  const FitResult& Fit(const loop::RecordView& record, Depth depth = Depth::kFull) {
    return Fit({&record, 1}, depth);
  }

  /// Fits a record similar to the last one, from the last solution, without a scan of the plane,
  /// and finds the minimum of Fit() to the solver's tolerance. Calls Fit() if there is no last
  /// solution, if it is at a bound or, from Depth::kErrors on, either record does not determine the
  /// law, and if this fit does not converge or leaves 1.5 times the residuals.
  const FitResult& Continue(const loop::RecordView& record, Depth depth = Depth::kFull);

  [[nodiscard]] const FitOptions& options() const { return options_; }

 private:
  FitOptions options_;
  FitResult result_;
};

/// Fits all the records together.
FitResult Fit(std::span<const loop::Record> records, const FitOptions& options = {},
              Depth depth = Depth::kFull);

}  // namespace mindahl::identification
