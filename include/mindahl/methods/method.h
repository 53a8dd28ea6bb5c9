#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string_view>

#include "mindahl/models/branch_law.h"
#include "mindahl/models/friction_model.h"

namespace mindahl::methods {

/// An imposed displacement [m]; the contact is unloaded at 0.
struct Drive {
  std::span<const double> displacement{};
  /// Amplitude [m] at each sample where it changes along the path, else empty; no method looks at
  /// it, but Simplified-Dahl does (models/simplified_law.h).
  std::span<const double> envelope = {};
};

/// Sets how finely a method resolves.
struct Resolution {
  /// Substeps a sample, elements or intervals: what the method says. >= 1
  std::size_t steps = 1;
  /// Largest local error of T/Tc in a step of an adaptive method, above rounding.
  double tolerance = 1e-6;
};

/// Computes the force [N] along a drive; reversals and branches are found within. The spans must
/// have one length.
/// @returns what this costs [ns], samples read and written aside: the operations that were made
///   times what each takes by a regression of bench/methods_bench (docs/tradeoff.md), and so the
///   same in every run and on every machine
using Evaluator = std::function<double(const Drive& drive, std::span<double> force)>;

/// A way to evaluate a friction model along a drive. The reversals and the loops that close are the
/// model's; what differs is how a branch is followed. Every method keeps |T| <= Tc; the elements of
/// Iwan add up to Tc, to rounding.
struct Method {
  std::string_view name{};   ///< on the command line
  std::string_view title{};  ///< in reports
  /// Unit of Resolution::steps, a plural in -s first, as "substeps a sample"; "" if unused.
  std::string_view steps = {};
  std::size_t default_steps = 1;
  bool adaptive = false;     ///< uses Resolution::tolerance
  bool masing_only = false;  ///< serves only models whose memory is kReturnPoint
  Evaluator (*prepare)(const models::FrictionModel& model, const models::BranchLaw& law,
                       const Resolution& resolution) = nullptr;
};

/// - exact: the closed form (models/response.h)
/// - dopri5: the branch law as a differential equation, dT/dx = σ(v − s(T−T₀)/(span·Tc))^α on each
///   branch (Peyret et al. eqs 10, 26, 27), by Dormand–Prince 5(4) with controlled error, `steps`
///   its least number a sample
/// - iwan: `steps` Jenkins elements (methods/iwan.h); order 2 in 1/steps
/// - table: the branch law between `steps` equal intervals of y/(1+y), linear; order 2 while u > 0
///   at a fixed distance, min(2, 1/|1−α|) for any 0 < α; exact for α = 2
std::span<const Method> Methods();

/// Returns nullptr when there is no such method.
const Method* FindMethod(std::string_view name);

/// Returns a method made ready for a law: what a simulator does once.
/// @param model  must outlive the evaluator
/// @throws InvalidArgument for an invalid law or resolution, or a model that the method does not
///   serve, naming both
Evaluator Prepare(const Method& method, const models::FrictionModel& model,
                  const models::BranchLaw& law, const Resolution& resolution);

}  // namespace mindahl::methods
