#pragma once

#include <ceres/loss_function.h>
#include <ceres/problem.h>

#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "mindahl/identification/fit_options.h"
#include "mindahl/identification/fit_result.h"
#include "mindahl/loop/record.h"

// The only public header that includes Ceres' headers.
namespace mindahl::identification {

/// A parameter of the problem and its parameter block, θ: non-dimensional and of order one.
///   value = scale·exp(θ) where it is positive,  else  value = reference + scale·θ
struct [[gnu::visibility("default")]] CeresParameter {
  std::string name;  ///< name in FitResult::parameters
  std::string unit;
  double theta = 0.0;  ///< the parameter block, of size one
  double lower = 0.0;  ///< bounds of θ
  double upper = 0.0;
  bool fixed = false;
  bool positive = false;
  double reference = 0.0;  ///< [unit]
  double scale = 1.0;      ///< [unit]

  [[nodiscard]] double Value() const;
  [[nodiscard]] double ThetaAt(double value) const;
};

/// The least-squares problem of a fit, unprojected: ceres::CostFunctions with analytic Jacobians
///   rᵢ = √wᵢ·(T_model(δᵢ; σ, α, Tc, rig, offsets, terms) − Tᵢ)/residual_unit
/// over all parameters of the fit, one residual block of all records. To it residuals and priors of
/// one's own are added, and ceres::Solve is called:
///
///     CeresProblem contact(records, options, fit, fit.force_noise);
///     ceres::Problem problem;
///     contact.AddTo(problem);
///     problem.AddResidualBlock(prior, nullptr, &contact.Find("alpha").theta);
///     ceres::Solve(solver_options, &problem, &summary);
///     contact.Find("sigma").Value();
///
/// Without residuals of one's own its minimum is the fit's. Priors of the options, turning points
/// that the fit found between samples, weights of noisy displacements and those of a robust loss
/// are not part of it; a robust loss is given to AddTo(), which applies it to each sample.
class [[gnu::visibility("default")]] CeresProblem {
 public:
  /// @param records        [m], [N]; those of the fit
  /// @param options        those of the fit
  /// @param fit            gives initial state, sign of the force and the starting values
  /// @param residual_unit  [N], or [m] in a fit of the displacement, > 0, by which residuals are
  ///                       divided: with the noise's standard deviation ½Σr² is minus the
  ///                       log-likelihood, to which that of a prior is added
  /// @throws InvalidArgument as the fit does
  CeresProblem(std::span<const loop::RecordView> records, const FitOptions& options,
               const FitResult& fit, double residual_unit = 1.0);
  CeresProblem(CeresProblem &&) noexcept;
  CeresProblem& operator=(CeresProblem&&) noexcept;
  ~CeresProblem();

  /// Returns those of the contact, then those of each record. The addresses of θ stay the same.
  [[nodiscard]] std::span<CeresParameter> parameters();
  /// @throws InvalidArgument where there is none of that name
  [[nodiscard]] CeresParameter& Find(std::string_view name);

  /// Adds the residual block of all samples, one record after the other, and bounds; holds what the
  /// fit holds. Residuals of samples that do not count are 0.
  /// @param problem  takes ownership of what is added; this must outlive it
  /// @param loss     of each sample, in residual units, of whose residual it puts sgn(r)·√ρ(r²) in
  ///                 the place; none: least squares
  void AddTo(ceres::Problem & problem, std::unique_ptr<ceres::LossFunction> loss = nullptr);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace mindahl::identification
