#include "mindahl/report/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/text.h"
#include "mindahl/core/error.h"
#include "mindahl/identification/terms.h"
#include "report/statements.h"

namespace mindahl::report {

namespace {

/// Puts the fit into the units of a torque.
void TranslateToTorque(Report& report) {
  report.units = UnitsOf(report.is_torsional());
  for (ParameterEstimate& estimate : report.fit.parameters) {
    // Newtons over the unit of a column, whatever that is.
    const bool is_of_column = estimate.name.starts_with(identification::NameOfCovariate(""));
    estimate.unit = is_of_column ? std::string(report.units.force) + estimate.unit.substr(1)
                                 : UnitOfTorque(estimate.unit);
  }
}

/// Adds samples, in their order, to what is left out: each run of them where they are few.
void LeaveOut(std::span<const std::size_t> samples, const io::RecordFile& file, const char* why,
              std::vector<LeftOut>& out) {
  constexpr std::size_t kFew = 5;
  std::vector<LeftOut> runs;
  for (std::size_t k = 0; k < samples.size(); ++k) {
    const std::size_t line = file.LineOf(samples[k]);
    if (k == 0 || samples[k] != samples[k - 1] + 1) {
      runs.push_back({.file = file.name, .first = line, .why = why});
    }
    runs.back().last = line;
    ++runs.back().samples;
  }
  if (runs.size() > kFew) runs = {{file.name, samples.size(), 0, 0, why}};
  out.insert(out.end(), runs.begin(), runs.end());
}

/// Counts the samples, and adds those of the records that do not count to what is left out, and the
/// rows that were no samples.
void CountSamples(Report& report) {
  for (const LeftOut& part : report.left_out) report.samples += part.samples;
  const loop::PreparationOptions& chosen = report.options.preparation;
  const bool is_selected = chosen.load_window || chosen.samples || chosen.cycles;
  for (std::size_t r = 0; r < report.records.size(); ++r) {
    const RecordFit& fit = report.fit.records[r];
    const io::RecordFile& file = report.records[r];
    report.samples += file.record.size();
    std::vector<std::size_t> first_stroke;
    std::vector<std::size_t> others;
    for (std::size_t i = 0; i < fit.counts.size(); ++i) {
      if (fit.counts[i] != 0 || std::ranges::binary_search(fit.glitches, i)) continue;
      (i < fit.first_stroke ? first_stroke : others).push_back(i);
    }
    LeaveOut(fit.glitches, file, "faults", report.left_out);
    LeaveOut(first_stroke, file, "unrecorded turn", report.left_out);
    LeaveOut(others, file, is_selected ? "selection" : "lag", report.left_out);
    if (file.left_out.count > 0) {
      report.left_out.push_back({file.name, file.left_out.count, 0, 0, "not whole"});
    }
  }
}

void CollectWarnings(Report& report) {
  for (const Finding& finding : report.fit.findings) {
    if (finding.severity == identification::Severity::kNote) continue;
    report.warnings.push_back({std::string(finding.code), WarningText(finding, report)});
  }
  if (!report.check.empty()) report.warnings.push_back({"check_input", report.check});
  if (report.is_torsional() || report.failed() || !report.check.empty()) return;
  for (const std::string& sentence : DoubtsAbout(report.known, report.ValueOf("contact_radius"))) {
    report.warnings.push_back({"contact_implausible", sentence});
  }
}

// --- slips of units and of loads

constexpr double kMostPressure = 1e11;  // [Pa], more than any solid bears
constexpr double kLargestBall = 10.0;   // [m], a radius of a body on a rig
constexpr double kMostOff = 200.0;      // factor by which Hertz's radius may be missed
constexpr double kWidestLoop = 1.0;     // [m], an amplitude that no rig has
constexpr double kMostFriction = 5.0;
constexpr double kLeastFriction = 1e-3;

std::string LargeRadius(const Report& report) {
  const std::array bodies = {&report.known.body_1, &report.known.body_2};
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    const auto& radius = bodies[k]->radius;
    if (!radius || std::isinf(radius->value) || std::abs(radius->value) < kLargestBall) continue;
    return fmt::format("--radius-{} {:.4g} is {}: in mm it would be {}", k + 1, radius->value,
                       Quantity(radius->value, "m", 3), Quantity(radius->value / 1000, "m", 3));
  }
  return "";
}

/// Counts and volts without a unit are taken as metres.
std::string LargeAmplitude(const Report& report) {
  for (std::size_t r = 0; r < report.records.size(); ++r) {
    const io::ChosenColumn& column = report.records[r].displacement;
    const double amplitude = report.fit.records[r].facts.amplitude;
    if (!column.has_no_unit || amplitude < kWidestLoop) continue;
    return fmt::format(
        "the displacement names no unit, and ±{} is no loop: give its unit, or the gain of counts "
        "and volts, --displacement '#{}*GAIN [m]'",
        Quantity(amplitude, "m", 3), column.index);
  }
  return "";
}

/// Compares the contact with Hertz's, or with the radius that is known, and the pressure with what
/// a solid bears: by the estimate alone, whatever its interval. Names the unit that most likely
/// makes it larger or smaller by a factor than it can be.
std::string ImpossibleContact(const Report& report) {
  using Kind = contact::ContactQuantity;
  const auto value_of = [&](Kind kind) {
    return contact::IdentifyContact(kind, report.fit.law.tangential_stiffness,
                                    report.fit.law.slip_force, report.known);
  };
  const io::RecordFile& first = report.records.front();
  const double friction = value_of(Kind::kFrictionCoefficient).value_or(1.0);
  const bool is_friction_off = friction > kMostFriction || friction < kLeastFriction;
  const std::string unit =
      is_friction_off ? fmt::format("the unit of the force, {}, or of the load", first.force.unit)
                      : fmt::format("the unit of the displacement, {}", first.displacement.unit);
  const auto ratio = value_of(Kind::kStiffnessRatio);
  if (ratio && (ratio->value > kMostOff || ratio->value < 1 / kMostOff)) {
    const double off = ratio->value > 1 ? ratio->value : 1 / ratio->value;
    const auto radius = value_of(Kind::kContactRadius);
    return fmt::format("the contact radius{} is {:.0f} times {} than {}: look at {}",
                       radius ? ", " + Quantity(radius->value, "m", 3) + "," : "", off,
                       ratio->value > 1 ? "larger" : "smaller",
                       report.known.contact_radius ? "the given one" : "Hertz's", unit);
  }
  const auto pressure = value_of(Kind::kMaximumPressure);
  if (pressure && pressure->value > kMostPressure) {
    return fmt::format("the maximum pressure is {}, more than any solid bears: look at {}",
                       Quantity(pressure->value, "Pa", 3), unit);
  }
  if (!is_friction_off || !report.fit.Find("slip_force")->is_known()) return "";
  return fmt::format("μ is {:.3g}: look at {}", friction, unit);
}

/// Returns a question where half gaps of several files differ as loads would make them, and one law
/// does not describe them: in partial slip they differ by the amplitudes too. Of a load series half
/// gaps over the loads differ by what the loops are less full, else the loads are others.
std::string DifferentLoads(const Report& report) {
  constexpr double kAsFull = 1.2;  // energy ratio over energy ratio
  const FitResult& fit = report.fit;
  const bool is_series = fit.is_load_series();
  const AdequacyVerdict verdict = fit.adequacy.verdict;
  if (fit.records.size() < 2 || verdict == AdequacyVerdict::kAdequate ||
      (!is_series && verdict != AdequacyVerdict::kInadequate)) {
    return "";
  }
  std::vector<double> half_gaps;
  std::vector<double> fullness;
  for (const RecordFit& record : fit.records) {
    if (!record.facts.half_gap) return "";
    half_gaps.push_back(std::abs(*record.facts.half_gap) / (is_series ? *record.normal_load : 1.0));
    fullness.push_back(record.facts.energy_ratio);
  }
  const auto [least, greatest] = std::ranges::minmax(half_gaps);
  if (!(greatest > report.options.thresholds.other_test * least)) return "";
  if (!is_series) {
    const std::string_view unit = report.units.force;
    return fmt::format("half gaps from {} to {}: {}separate tests? mindahl batch",
                       Quantity(least, unit, 3), Quantity(greatest, unit, 3),
                       report.is_torsional() ? "" : "different loads? --normal-load N1,N2,…; ");
  }
  const auto [emptiest, fullest] = std::ranges::minmax(fullness);
  if (!(emptiest > 0 && fullest < kAsFull * emptiest)) return "";
  return fmt::format(
      "half gaps over the loads from {:.3g} to {:.3g} of loops that are as full: loads in another "
      "order than the files?",
      least, greatest);
}

/// Files whose loops take energy of a sign of their own: one sign is fitted to all.
std::string OppositeSigns(const Report& report) {
  constexpr double kClear = 0.05;  // [W/(4XT*)]
  if (report.fit.records.size() < 2) return "";
  std::string names;
  for (std::size_t r = 0; r < report.fit.records.size(); ++r) {
    const loop::LoopFacts& facts = report.fit.records[r].facts;
    if (!facts.closed || !(facts.energy_ratio < -kClear)) continue;
    names += (names.empty() ? "" : ", ") + report.records[r].name;
  }
  if (names.empty()) return "";
  return fmt::format(
      "the force of {} has another sign than that of the rest: turn it in the file, or mindahl "
      "batch",
      names);
}

std::string WhatToCheck(const Report& report) {
  if (std::string found = OppositeSigns(report); !found.empty()) return found;
  if (!report.is_torsional()) {
    if (std::string found = LargeRadius(report); !found.empty()) return found;
    if (std::string found = LargeAmplitude(report); !found.empty()) return found;
    if (std::string found = ImpossibleContact(report); !found.empty()) {
      // An input that no solid can have is the more likely error.
      const std::vector<std::string> doubts = contact::DoubtsAbout(report.known);
      return doubts.empty() ? found : doubts.front();
    }
  }
  return DifferentLoads(report);
}

}  // namespace

std::vector<std::string> Report::files() const { return NamesOf(records, &io::RecordFile::name); }

const ContactQuantity* Report::Find(std::string_view quantity) const {
  const auto found = std::ranges::find(contact, quantity, &ContactQuantity::name);
  return found == contact.end() ? nullptr : &*found;
}

std::optional<double> Report::ValueOf(std::string_view quantity) const {
  const ContactQuantity* found = Find(quantity);
  return found == nullptr ? std::nullopt : found->value;
}

Report MakeReport(ReportInput input) {
  const std::size_t records = input.fit.records.size();
  if (records == 0 || input.fit.model == nullptr) {
    throw InvalidArgument("there is nothing to report: the fit has no record or no model");
  }
  RequireSameSize("records", input.records.size(), "records of the fit", records);
  Report report;
  static_cast<ReportInput&>(report) = std::move(input);
  CountSamples(report);
  if (report.is_torsional()) TranslateToTorque(report);
  if (report.fit.response == loop::Channel::kDisplacement) {
    report.units.response = report.units.displacement;
    report.units.excitation = report.units.force;
  }
  if (!report.failed()) {
    if (!report.is_torsional()) {
      report.alpha = TestAlpha(report.fit);
      report.contact = DescribeContact(report.fit, report.known);
    }
    report.check = WhatToCheck(report);
    // No term repairs a fit that mixes up loads or units.
    if (!report.check.empty()) report.next.reset();
  }
  CollectWarnings(report);
  return report;
}

}  // namespace mindahl::report
