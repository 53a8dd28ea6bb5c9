#include "mindahl/report/contact.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

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

}  // namespace mindahl::report
