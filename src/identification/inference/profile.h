#pragma once

#include <array>
#include <optional>

#include "identification/inference/estimates.h"
#include "identification/inference/noise.h"
#include "identification/intervals.h"
#include "identification/solve/search.h"
#include "mindahl/identification/fit_result.h"

namespace mindahl::identification {

/// Ends of the set of parameters that the data do not distinguish from the best fit.
struct Range {
  double lower = 0.0;  // of θ
  double upper = 0.0;
};

/// Ranges of ln σ, α and ln Tc over the points of a profile that are not rejected: of kStiffness,
/// kShape and kSlipForce.
using ProfiledRanges = std::array<Range, 3>;

/// The likelihood along the one direction in which hysteresis loops are badly determined.
///
/// Far from gross slip a loop depends on σ and α/Tc, and weakly on the rest (docs/theory.md §10):
/// the likelihood is a long curved valley along which Tc, and α with it, may change many times at
/// little cost. The Jacobian at the best fit sees its floor there and no further. So Tc is moved
/// along a grid from the peak force to twenty times it, the others fitted again from the last
/// point, and every parameter's range is collected over the points that a likelihood-ratio test
/// does not reject.
struct SlipForceProfile {
  /// Not clearly rejected where Tc is twenty times the largest force, or α has reached its bound.
  bool open_above = false;
  ProfiledRanges ranges = {};
  LikelihoodProfile likelihood = {};
};

/// F of the best fit against those with Tc at the lower and the upper end of the parabola's 95 %
/// interval, over the critical one: 1 where the parabola is right. Tc is determined.
/// @param last_gain  of F: a step that gains less is the last of a search, and its gain is taken as
///   predicted. The searches start from the parabola's own minima, and are off by less than a fifth
///   of it
std::array<double, 2> RatiosAtEnds(const FittedProblem& fitted, const FitOptions& options,
                                   double last_gain, SearchBuffers& buffers);

/// Gain of F for RatiosAtEnds(), which is then off by a thousandth of the critical F.
inline constexpr double kLastGainAtEnds = 0.02;

/// True if the parabola may be wrong along Tc: where the loop stays away from slip, where Tc is
/// badly known, and where its likelihood at the ends of the parabola's interval is another one.
/// @param peak_share  T* of the record over Tc
bool NeedsSlipForceProfile(const FittedProblem& fitted, double peak_share,
                           const FitOptions& options, SearchBuffers& buffers);

SlipForceProfile ProfileSlipForce(const FittedProblem& fitted, const FitOptions& options,
                                  SearchBuffers& buffers);

/// True if a rigid contact, σ a thousand times larger, passes the same test. Not asked where σ is
/// known far too well for it.
bool StiffnessIsOpenAbove(const FittedProblem& fitted, const FitOptions& options,
                          SearchBuffers& buffers);

/// Profiles σ, α and Tc along the likelihood from the bound α = 0 upwards, each with half the
/// interval that it has with α held; empty where α does not lie at that bound. There the parabola
/// holds α, but a small α moves σ: at the same secant of a loop of T* the tangent σ is larger by
/// (α/2)(T*/Tc), which may be many standard errors.
std::optional<ProfiledRanges> ProfileSmallShape(const FittedProblem& fitted,
                                                const FitOptions& options, SearchBuffers& buffers);

/// Puts the ends of the likelihood into the intervals of σ, α, Tc and the rig's stiffness, where a
/// rig is fitted and the likelihood at the ends of the parabola's interval of its stiffness is
/// another one: σ, α and k_r share one valley, which bends towards the rigid rig. Each end is where
/// F is the critical one, to a hundredth; one that is not reached is open.
ParameterEstimates ProfileBesideRig(const FittedProblem& fitted, const FitOptions& options,
                                    SearchBuffers& buffers, ParameterEstimates parameters);

/// Includes them in the intervals.
ParameterEstimates IncludeSmallShape(const Problem& problem, const ProfiledRanges& ranges,
                                     ParameterEstimates parameters);

/// Puts the ranges into the intervals where these are narrower; a standard error that was too small
/// follows.
ParameterEstimates WidenByRanges(const Problem& problem, const ProfiledRanges& ranges,
                                 double quantile, ParameterEstimates parameters);

/// Returns the force [N] that the contact is seen to carry, the more of two: the fitted one less
/// twice the error of the fit, and the measured peak less a standard deviation of its white noise:
/// half the distance between the medians of a few ends is known to about half of that.
/// @param peak_force  T* [N], which it does not exceed
double CarriedForce(const Problem& problem, const FitResult& result, double peak_force);

/// Puts what a profile found into the intervals: the wider of both, and open ends.
/// @param carried  [N]: a contact that carried it has at least that slip force
ParameterEstimates WidenByProfile(const Problem& problem, const SlipForceProfile& profile,
                                  double quantile, double carried, ParameterEstimates parameters);

}  // namespace mindahl::identification
