#include "mindahl/report/contact.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>

#include "core/probability.h"
#include "mindahl/report/load_series.h"

namespace mindahl::report {

using identification::FitResult;

namespace {

/// Returns a parameter for the contact module: its error is infinite if the fit leaves it open.
contact::UncertainValue Uncertain(const FitResult& fit, std::string_view name) {
  const identification::ParameterEstimate& estimate = *fit.Find(name);
  return {estimate.value, fit.ErrorOf(estimate)};
}

/// Removes the quantities that rest on Hertz's law where a load series denies it.
void WithholdSphere(const FitResult& fit, contact::IdentifiedContact& contact) {
  if (!DeniesHertz(fit)) return;
  contact.equivalent_radius.reset();
  contact.maximum_pressure.reset();
}

}  // namespace

double Correlation(const FitResult& fit, std::string_view first, std::string_view second) {
  const std::size_t count = fit.parameters.size();
  const auto place = [&](std::string_view name) {
    return static_cast<std::size_t>(fit.Find(name) - fit.parameters.data());
  };
  const double correlation = fit.correlation[place(first) * count + place(second)];
  return std::isfinite(correlation) ? std::clamp(correlation, -1.0, 1.0) : 0.0;
}

std::optional<std::string> WhyFrictionIsWithheld(const FitResult& fit,
                                                 const contact::KnownContact& known) {
  const identification::ParameterEstimate* slip_force = fit.Find("slip_force");
  if (!known.normal_load || slip_force == nullptr || slip_force->is_known()) {
    return std::nullopt;
  }
  return fmt::format("needs an identifiable slip force; from this loop it is at least {:.3g}",
                     slip_force->lower95.value_or(0.0) / known.normal_load->value);
}

contact::IdentifiedContact IdentifyFittedContact(const FitResult& fit,
                                                 const contact::KnownContact& known) {
  contact::IdentifiedContact contact =
      contact::IdentifyContact(Uncertain(fit, "sigma"), Uncertain(fit, "slip_force"), known,
                               Correlation(fit, "sigma", "slip_force"));
  if (const std::optional<std::string> why = WhyFrictionIsWithheld(fit, known)) {
    contact.friction_coefficient.reset();
    contact.unidentified.push_back("friction coefficient " + *why);
  }
  WithholdSphere(fit, contact);
  return contact;
}

contact::IdentifiedContact IdentifyContactOf(const FitResult& fit, const models::BranchLaw& law,
                                             const contact::KnownContact& known) {
  const auto moved = [&](std::string_view name, double value) {
    const contact::UncertainValue fitted = Uncertain(fit, name);
    return contact::UncertainValue{value, fitted.standard_error * (value / fitted.value)};
  };
  contact::IdentifiedContact contact = contact::IdentifyContact(
      moved("sigma", law.tangential_stiffness), moved("slip_force", law.slip_force), known,
      Correlation(fit, "sigma", "slip_force"));
  WithholdSphere(fit, contact);
  return contact;
}

std::optional<double> MeanNormalLoad(std::span<const loop::Record> records,
                                     const std::optional<identification::Interval>& window) {
  double sum = 0.0;
  double count = 0.0;
  for (const loop::Record& record : records) {
    if (record.normal_load.empty()) return std::nullopt;
    for (const double load : record.normal_load) {
      if (window && (load < window->lower || load > window->upper)) continue;
      sum += load;
      ++count;
    }
  }
  if (count == 0) return std::nullopt;
  return sum / count;
}

AlphaTest TestAlpha(const identification::FitResult& fit) {
  AlphaTest test;
  const identification::ParameterEstimate& alpha = *fit.Find("alpha");
  if (alpha.status == identification::ParameterStatus::kFixed) return test;
  constexpr double kThird = contact::kMindlinShapeExponent;
  test.minus_third = alpha.value - kThird;
  if (!alpha.is_known()) return test;
  const double error = fit.ErrorTowards(alpha, kThird);
  if (error > 0 && std::isfinite(error)) {
    test.z = *test.minus_third / error;
    test.p_value = PValueOfT(*test.z, fit.ErrorDegreesOfFreedom());
  }
  test.is_rejected = alpha.lower95 > kThird || alpha.upper95 < kThird;
  const auto& likelihood = fit.mindlin_test;
  if (likelihood && (likelihood->p_value < kSignificance) == *test.is_rejected) {
    test.likelihood = likelihood;
  }
  return test;
}

StiffnessTest TestStiffness(std::string_view radius, const contact::PropagatedValue& ratio,
                            double degrees_of_freedom, double confidence) {
  StiffnessTest test;
  test.confidence = confidence;
  test.radius = radius;
  test.ratio = ratio;
  if (!(ratio.standard_error > 0) || std::isinf(ratio.standard_error)) return test;
  const double share = ratio.FitShare();
  const double degrees =
      share > 0 ? degrees_of_freedom / (share * share) : std::numeric_limits<double>::infinity();
  const double half_width = StudentQuantile(degrees, confidence) * ratio.standard_error;
  test.interval95 = {ratio.value - half_width, ratio.value + half_width};
  test.z = (ratio.value - 1) / ratio.standard_error;
  test.p_value = PValueOfT(*test.z, degrees);
  return test;
}

std::vector<StiffnessTest> TestStiffness(const identification::FitResult& fit,
                                         const contact::IdentifiedContact& contact) {
  std::vector<StiffnessTest> tests;
  const bool is_known = fit.Find("sigma")->is_known();
  const auto add = [&](std::string_view radius, const contact::PropagatedValue& ratio) {
    tests.push_back(is_known
                        ? TestStiffness(radius, ratio, fit.ErrorDegreesOfFreedom(), fit.confidence)
                        : StiffnessTest{.radius = radius, .ratio = ratio});
  };
  if (contact.hertz) add("hertz", contact.hertz->sigma_over_hertz_mindlin);
  if (contact.sigma_over_mindlin) add("given", *contact.sigma_over_mindlin);
  return tests;
}

using identification::ParameterEstimate;
using identification::ParameterStatus;

namespace {

/// Ways of ln Tc and of a, the latter in proportion to the slip force, as one of their sum.
std::optional<double> Together(const std::optional<double>& of_slip_force,
                               const std::optional<double>& of_asymmetry, double correlation) {
  if (!of_slip_force || !of_asymmetry) return std::nullopt;
  return std::sqrt(std::max(*of_slip_force * *of_slip_force + *of_asymmetry * *of_asymmetry +
                                2 * correlation * *of_slip_force * *of_asymmetry,
                            0.0));
}

/// 0 of what is held.
std::optional<double> WayTo(const ParameterEstimate& estimate, const std::optional<double>& end) {
  if (estimate.status == ParameterStatus::kFixed) return 0.0;
  if (!end) return std::nullopt;
  return std::abs(*end - estimate.value);
}

std::optional<double> LogWayTo(const ParameterEstimate& estimate,
                               const std::optional<double>& end) {
  if (estimate.status == ParameterStatus::kFixed) return 0.0;
  if (!end || !(*end > 0)) return std::nullopt;
  return std::abs(std::log(*end / estimate.value));
}

std::optional<double> ErrorOf(const ParameterEstimate& estimate) {
  return estimate.status == ParameterStatus::kFixed ? std::optional<double>(0.0)
                                                    : estimate.standard_error;
}

/// @param sense  +1 where the motion is towards positive displacement, −1 where it is not
SlipForce InSense(double sense, const ParameterEstimate& slip_force,
                  const ParameterEstimate& asymmetry, double correlation) {
  const double share = 1 + sense * asymmetry.value;
  const auto over_share = [&](std::optional<double> way) {
    if (way) *way /= share;
    return way;
  };
  const double correlation_in_sense = sense * correlation;
  SlipForce force{.value = slip_force.value * share};
  if (slip_force.status == ParameterStatus::kFixed && asymmetry.status == ParameterStatus::kFixed) {
    return force;
  }
  std::optional<double> error_of_slip_force = ErrorOf(slip_force);
  if (error_of_slip_force) *error_of_slip_force /= slip_force.value;
  if (const auto error =
          Together(error_of_slip_force, over_share(ErrorOf(asymmetry)), correlation_in_sense)) {
    force.standard_error = force.value * *error;
  }
  const auto& towards_lower = sense > 0 ? asymmetry.lower95 : asymmetry.upper95;
  const auto& towards_upper = sense > 0 ? asymmetry.upper95 : asymmetry.lower95;
  if (const auto way =
          Together(LogWayTo(slip_force, slip_force.lower95),
                   over_share(WayTo(asymmetry, towards_lower)), correlation_in_sense)) {
    force.lower95 = force.value * std::exp(-*way);
  }
  if (const auto way =
          Together(LogWayTo(slip_force, slip_force.upper95),
                   over_share(WayTo(asymmetry, towards_upper)), correlation_in_sense)) {
    force.upper95 = force.value * std::exp(*way);
  }
  return force;
}

}  // namespace

std::optional<SlipForces> DescribeSlipForces(const FitResult& fit) {
  const ParameterEstimate* const slip_force = fit.Find("slip_force");
  const ParameterEstimate* const asymmetry = fit.Find("asymmetry");
  if (slip_force == nullptr || asymmetry == nullptr || !slip_force->is_known() ||
      !asymmetry->is_known()) {
    return std::nullopt;
  }
  const bool both_are_free =
      slip_force->status != ParameterStatus::kFixed && asymmetry->status != ParameterStatus::kFixed;
  const double correlation = both_are_free ? Correlation(fit, "slip_force", "asymmetry") : 0.0;
  return SlipForces{.positive = InSense(1.0, *slip_force, *asymmetry, correlation),
                    .negative = InSense(-1.0, *slip_force, *asymmetry, correlation)};
}

}  // namespace mindahl::report
