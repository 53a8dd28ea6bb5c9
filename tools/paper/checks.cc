#include "checks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string_view>
#include <utility>

#include "mindahl/contact/mindlin_dahl_mapping.h"
#include "mindahl/models/branch_law.h"
#include "mindahl/models/friction_model.h"
#include "mindahl/models/steady_loop.h"
#include "responses.h"

namespace mindahl::paper {

using models::Excitation;

namespace {

/// [% of T*]. response.h: 5e-14·Tc along a path, of the least T*, 0.28·Tc where the growing sine
/// starts.
constexpr double kRounding = 2e-11;

/// Half a unit of the last digit of "0.93", "4.839e8".
double HalfUnit(std::string_view printed) {
  const std::size_t exponent = printed.find('e');
  const std::string_view mantissa = printed.substr(0, exponent);
  const std::size_t point = mantissa.find('.');
  const int decimals =
      point == std::string_view::npos ? 0 : static_cast<int>(mantissa.size() - point - 1);
  const int power =
      exponent == std::string_view::npos ? 0 : std::stoi(std::string(printed.substr(exponent + 1)));
  return 0.5 * std::pow(10.0, power - decimals);
}

/// Eq. 15 with the printed sign of its displacement, +1, or the corrected one, −1.
double ReloadingForce(double displacement, double peak, int sign) {
  const double slip_force = kContact.slip_force;
  const double share = displacement / GrossSlipDisplacement(kContact);
  const double stuck = std::pow(1 - peak / slip_force, 2.0 / 3.0);
  return -peak + 2 * slip_force * (1 - std::pow((sign * share + stuck + 1) / 2, 1.5));
}

void AddParameterChecks(std::vector<Check>& checks) {
  const auto stiffness = [](double radius) {
    return contact::MindlinTangentialStiffness(radius, kContact.tangential_compliance);
  };
  checks.push_back(Check::AsPrinted("§3: σ = 8a/G* of the printed a = 0.0027 m [N/m]", "4.8869e8",
                                    stiffness(kContact.contact_radius)));
  checks.push_back(
      Check::AsPrinted("§3: σ of a = 0.0026735 m [N/m]", "4.839e8", stiffness(0.0026735)));
  checks.push_back(Check::AsPrinted("§3: a = σG*/8 of the printed σ = 4.839e8 N/m [m]", "2.6735e-3",
                                    kPrintedStiffness * kContact.tangential_compliance / 8));
}

void AddEquationChecks(std::vector<Check>& checks) {
  constexpr double kRoundOff = 1e-14;  // some twenty roundings of forces near Tc, each 2e-16
  const double gross_slip = GrossSlipDisplacement(kContact);
  const double amplitude = kMicroSlip * gross_slip;
  const double peak = contact::MindlinVirginForce(kContact, amplitude);
  checks.push_back(Check::Within("eq. 15 as printed, T₂(−δ*)/T*: the wrong end", 1.0, kRoundOff,
                                 ReloadingForce(-amplitude, peak, +1) / peak));
  checks.push_back(Check::Within("eq. 15 with −δ, T₂(−δ*)/T*", -1.0, kRoundOff,
                                 ReloadingForce(-amplitude, peak, -1) / peak));
  const double inside = 0.3 * amplitude;
  checks.push_back(Check::Within("eq. 15 with −δ, T₂(0.3δ*) over the library's", 1.0, kRoundOff,
                                 ReloadingForce(inside, peak, -1) /
                                     contact::MindlinReloadingForce(kContact, inside, amplitude)));

  // At δ = ¾δc eq. 16 has √(1/4) and T = (1 − 1/8)·Tc. A central difference of ±h errs by
  // h²·|f'''|/6 = h²·σ/(24·δc²·(1/4)^{3/2}), with h = 1e-4·δc 4e-9·σ.
  constexpr double kStep = 1e-4;
  constexpr double kCentralDifference = 1e-8;
  const double slope = (contact::MindlinVirginForce(kContact, (0.75 + kStep) * gross_slip) -
                        contact::MindlinVirginForce(kContact, (0.75 - kStep) * gross_slip)) /
                       (2 * kStep * gross_slip) / ExactLaw().tangential_stiffness;
  const double remaining =
      1 - contact::MindlinVirginForce(kContact, 0.75 * gross_slip) / kContact.slip_force;
  checks.push_back(
      Check::Within("eq. 13: its slope at ¾δc, over σ", 0.5, kCentralDifference, slope));
  checks.push_back(
      Check::Within("eq. 19 with exponent 1/3: the same", 0.5, kRoundOff, std::cbrt(remaining)));
  checks.push_back(Check::AsPrinted("eq. 19 as printed, exponent 1/2: not the same", "0.354",
                                    std::sqrt(remaining)));

  const double with_12a =
      3 * kContact.slip_force * kContact.tangential_compliance / (12 * kContact.contact_radius);
  checks.push_back(Check::AsPrinted("eq. 23 with 12a: δ/δc at the \"micro-slip\" λ = 0.8", "1.07",
                                    kMicroSlip * with_12a / gross_slip));
  checks.push_back(Check::Within(
      "eq. 23 with 12a: T/Tc there", 1.0, 0.0,
      contact::MindlinVirginForce(kContact, kMicroSlip * with_12a) / kContact.slip_force));
  checks.push_back(
      Check::Within("eq. 23 with 16a: T/Tc at δc", 1.0, 0.0,
                    contact::MindlinVirginForce(kContact, gross_slip) / kContact.slip_force));
}

/// ∮T dδ [J] over the last whole cycle, by trapezoids.
double AreaOfLastCycle(const Excitation& excitation, const std::vector<double>& force) {
  double area = 0.0;
  for (std::size_t i = force.size() - kSamplesPerCycle; i < force.size(); ++i) {
    area += (excitation.displacement[i] - excitation.displacement[i - 1]) *
            (force[i] + force[i - 1]) / 2;
  }
  return area;
}

void AddEnergyChecks(std::vector<Check>& checks) {
  // A trapezoid of width w errs by |T''|w³/12, w <= 2πX/n, and T'' <= 1.12·σ²/(3Tc) along the loop
  // of λ = 0.8: together 7e-6·Tc·X of a loop of 0.43·Tc·X.
  constexpr double kTrapezoids = 2e-5;
  const Excitation sine = Sine(kMicroSlip, 5);
  const double amplitude = sine.envelope.front();
  const double loop = AreaOfLastCycle(sine, MindlinForce(sine));
  // ∫T dδ of eq. 13
  const double gross_slip = contact::GrossSlipDisplacement(kContact);
  const double work =
      kContact.slip_force *
      (amplitude - 0.4 * gross_slip * (1 - std::pow(1 - amplitude / gross_slip, 2.5)));
  const double dissipated = 2 * work - amplitude * contact::MindlinVirginForce(kContact, amplitude);
  checks.push_back(Check::Within("§2.3: 4 × dissipated part of the initial loading over loop area",
                                 1.0, kTrapezoids, 4 * dissipated / loop));
  checks.push_back(Check::Within(
      "Johnson 7.57 over loop area", 1.0, kTrapezoids,
      models::SteadyLoopEnergy(*models::FindFrictionModel("mindlin"), ExactLaw(), amplitude) /
          loop));
  // With z = 1 − λ: work w = λ − ⅖(1 − z^{5/2}) in Tc·δc, loop 8w − 4λ(1 − z^{3/2}).
  checks.push_back(Check::AsPrinted("§2.3 misread: 4 × work of the initial loading over loop area",
                                    "4.742", 4 * work / loop));
}

void AddTableChecks(std::vector<Check>& checks, const std::vector<ErrorsByCycle>& sine_errors) {
  const std::string_view zero;
  const std::vector<std::vector<std::string_view>> expected = {
      {zero, zero, zero, zero, zero},
      {zero, zero, zero, zero, zero},
      {"0.93", "0.84", "0.82", "0.81", "0.81"},
      {"11.4", "3.57", "0.719", "0.144", "0.029"},
      {"13.3", zero, zero, zero, zero}};
  for (std::size_t row = 0; row < expected.size(); ++row) {
    const ErrorsByCycle& errors = sine_errors.at(row);
    for (std::size_t cycle = 0; cycle < expected[row].size(); ++cycle) {
      const std::string quantity =
          fmt::format("{}, {}, cycle {} [% of T*]", errors.model, errors.excitation, cycle + 1);
      const std::string printed(expected[row][cycle]);
      checks.push_back(printed.empty()
                           ? Check::Within(quantity, 0.0, kRounding, errors.worst[cycle])
                           : Check::AsPrinted(quantity, printed, errors.worst[cycle]));
    }
  }
}

double Largest(const std::vector<double>& values) { return *std::ranges::max_element(values); }

/// Of Full-Dahl with the envelope against exact memory, over all cycles [% of T*].
double EnvelopeError(std::size_t samples_per_cycle) {
  const Excitation growing = GrowingSine(samples_per_cycle);
  return Largest(WorstByCycle(PercentOfPeak(growing, FullDahlForce(ExactLaw(), growing),
                                            RememberingForce("mindlin", growing)),
                              samples_per_cycle));
}

void AddMemoryChecks(std::vector<Check>& checks, const std::vector<ErrorsByCycle>& growing_errors) {
  const Excitation growing = GrowingSine();
  const std::vector<double> exact = RememberingForce("mindlin", growing);
  const auto largest = [&](const std::vector<double>& force) {
    return Largest(WorstByCycle(PercentOfPeak(growing, force, exact)));
  };
  checks.push_back(Check::Within("exact memory: mindlin-dahl against mindlin [% of T*]", 0.0,
                                 kRounding, largest(RememberingForce("mindlin-dahl", growing))));
  checks.push_back(Check::Within("exact memory: models/ against contact/ [% of T*]", 0.0, kRounding,
                                 largest(RememberingMindlinForce(growing))));
  // T* = Tc does not change any more, and every branch of cycle 5 starts from it.
  for (const ErrorsByCycle& errors : growing_errors) {
    if (errors.excitation != "exact memory" || errors.model.starts_with("Mindlin")) continue;
    checks.push_back(Check::Within(
        fmt::format("{} against exact memory in gross slip, cycle 5 [% of T*]", errors.model), 0.0,
        kRounding, errors.worst.back()));
  }
  // T* is held over each step, so it is half a step's growth off: of T*, ln g/(2·samples).
  const double held_peak =
      100 * std::log(kGrowth) / (2 * kGrowingCycles * static_cast<double>(kSamplesPerCycle));
  checks.push_back(Check::Within("Full-Dahl against exact memory, four times the samples [% of T*]",
                                 EnvelopeError(kSamplesPerCycle), held_peak,
                                 EnvelopeError(4 * kSamplesPerCycle)));
}

}  // namespace

Check Check::AsPrinted(std::string quantity, std::string expected, double found) {
  const double value = std::stod(expected);
  const double tolerance = HalfUnit(expected);
  return {std::move(quantity), std::move(expected), value, tolerance, found};
}

Check Check::Within(std::string quantity, double value, double tolerance, double found) {
  std::string expected =
      tolerance > 0 ? fmt::format("{:.4g} ± {:.1g}", value, tolerance) : fmt::format("{:g}", value);
  return {std::move(quantity), std::move(expected), value, tolerance, found};
}

bool Check::Passes() const { return std::abs(found - value) <= tolerance; }

std::vector<ErrorsByCycle> SineErrors() {
  std::vector<ErrorsByCycle> errors;
  const auto add = [&](const char* model, double lambda, const auto& force) {
    const Excitation sine = Sine(lambda, 5);
    errors.push_back({model, fmt::format("λ = {}", lambda),
                      WorstByCycle(PercentOfPeak(sine, force(sine), MindlinForce(sine)))});
  };
  const auto full = [](const Excitation& sine) { return FullDahlForce(ExactLaw(), sine); };
  const auto simplified = [](const Excitation& sine) {
    return SimplifiedDahlForce(ExactLaw(), sine);
  };
  add("Full-Dahl, exact σ", kMicroSlip, full);
  add("Full-Dahl, exact σ", kMacroSlip, full);
  add("Full-Dahl, σ = 4.839e8", kMicroSlip,
      [](const Excitation& sine) { return FullDahlForce(PrintedLaw(), sine); });
  add("Simplified-Dahl, exact σ", kMicroSlip, simplified);
  add("Simplified-Dahl, exact σ", kMacroSlip, simplified);
  return errors;
}

std::vector<ErrorsByCycle> GrowingSineErrors() {
  const Excitation growing = GrowingSine();
  const std::vector<double> mindlin = MindlinForce(growing);
  const std::vector<double> full = FullDahlForce(ExactLaw(), growing);
  const std::vector<double> simplified = SimplifiedDahlForce(ExactLaw(), growing);
  const std::vector<double> exact = RememberingForce("mindlin", growing);
  const auto worst = [&](const std::vector<double>& force, const std::vector<double>& reference) {
    return WorstByCycle(PercentOfPeak(growing, force, reference));
  };
  return {{"Full-Dahl", "Mindlin", worst(full, mindlin)},
          {"Simplified-Dahl", "Mindlin", worst(simplified, mindlin)},
          {"Mindlin", "exact memory", worst(mindlin, exact)},
          {"Full-Dahl", "exact memory", worst(full, exact)},
          {"Simplified-Dahl", "exact memory", worst(simplified, exact)}};
}

std::vector<Check> MakeChecks(const std::vector<ErrorsByCycle>& sine_errors,
                              const std::vector<ErrorsByCycle>& growing_errors) {
  std::vector<Check> checks;
  AddTableChecks(checks, sine_errors);
  AddParameterChecks(checks);
  AddEquationChecks(checks);
  AddEnergyChecks(checks);
  AddMemoryChecks(checks, growing_errors);
  return checks;
}

}  // namespace mindahl::paper
