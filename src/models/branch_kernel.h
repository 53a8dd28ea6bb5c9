#pragma once

#include <span>

#include "models/normalized_response.h"
#include "models/response_gradient.h"
#include "models/scaled_branches.h"

/// The branch law at many displacements at once, for fits: the same arithmetic for every sample,
/// without a jump or a call, so that the compiler makes vectors of it. Built for several
/// instruction sets, of which the widest that the processor has is chosen at the first call; they
/// differ in roundings only.
///
/// Errors: φ relative 4 ε, as in backbone.h; derivatives 4 ε of 1 and, next to slip, those of a
/// displacement that is off by ε, which for α < 1/2 bends φ' without bound: they steer a solver.
namespace mindahl::models {

/// Computes t of the samples of one run, `limit` being the largest |t|.
void EvaluateGeneralRun(const ScaledBranch& branch, double shape_exponent, double limit,
                        std::span<const double> displacement, std::span<double> t);

/// Computes t and its derivatives; a column of `gradient` that is empty is not wanted.
void DifferentiateGeneralRun(const ScaledBranch& branch, const BranchGradient& branch_gradient,
                             double shape_exponent, double limit,
                             std::span<const double> displacement, std::span<double> t,
                             const NormalizedGradient& gradient);

}  // namespace mindahl::models
