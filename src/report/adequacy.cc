#include "report/adequacy.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "core/text.h"
#include "mindahl/identification/terms.h"
#include "mindahl/report/units.h"
#include "report/names.h"
#include "report/statements.h"

namespace mindahl::report {

using identification::Adequacy;
using identification::AdequacyVerdict;
using identification::Cause;

namespace {

struct CauseRow {
  std::string_view code;
  const char* looks;     // like what, with its size; an argument is left unused where it has none
  const char* negative;  // likewise of a negative size; null where the sign is shown
  const char* remedy;    // where no option takes it into account
  double whole = std::numeric_limits<double>::infinity();  // a size from which on it is all
  const char* remedy_of_displacement = nullptr;            // where that is fitted; null: the same
  const char* unsized = nullptr;  // of one of several numbers, where the first says little
};

constexpr const char* kLookAtTheLoad =
    "check whether the normal load varies with the position; if it is recorded, name its column "
    "with --normal-load-column";

constexpr std::array<CauseRow, 25> kCauses = {{
    {"channel_lag", "a force that is read {} after the displacement",
     "a displacement that is read {} after the force",
     "compare the delays and filters of the two channels"},
    {"viscous_force", "an additional viscous force of {}", nullptr,
     "record the time, and give --viscous fit"},
    {"plateau_slope", "an additional force that grows by {} with the displacement", nullptr,
     "give --plateau-slope"},
    {"force_drift", "a force that drifts by {}", nullptr, "give --drift"},
    {"normal_load", "a force that follows the measured load, which varies, to {}", nullptr,
     "keep to one load with --load-window"},
    {.code = "shape_of_law",
     .looks = "branches shaped differently from the law's",
     .negative = nullptr,
     .remedy = "compare the laws with --model auto",
     .remedy_of_displacement = "fit another law, --model mindlin-dahl or dahl, and compare"},
    {"guide_friction", "an additional friction of {} that reverses at once with the motion",
     "a friction whose jump at each reversal is {} too small",
     "look for a guide or a seal that rubs, and measure it without the contact"},
    {"rig_in_series", "a rig in series that deflects by {}",
     "a rig in series that deflects by {} less than was subtracted", "give --rig-stiffness fit",
     std::numeric_limits<double>::infinity(),
     "measure the rig's stiffness and subtract its deflection from the displacement"},
    {"backlash", "a backlash of {} after each reversal", "an overtravel of {} after each reversal",
     "look for play between the contact and the displacement sensor"},
    {"displacement_sensor", "a nonlinear displacement sensor", nullptr,
     "calibrate the displacement sensor over the whole stroke"},
    {"inertia", "a mass of {} between the contact and the force sensor", nullptr,
     "move more slowly, or subtract the inertia from the force"},
    {"unequal_directions", "a friction that differs by {} from the mean in each direction",
     "a friction that differs by {} from the mean in each direction",
     "check whether the load changes with the direction of motion", 1.0, nullptr,
     "a friction that differs between the two directions"},
    {"running_in", "a friction that grows by {} over the record",
     "a friction that falls by {} over the record",
     "leave the first cycles out with --skip-cycles, or fit parts of the record"},
    {"force_saturates",
     "a force reading that loses {} of its excess over nine tenths of its peak, "
     "as of an overloaded sensor",
     "a force reading that gains {} of its excess over nine tenths of its peak",
     "check the ranges of the force sensor and its amplifier", 1.0, nullptr,
     "a force reading that is nonlinear near its peak"},
    {"slip_position", "a slip force that grows by {} from the middle of the stroke to its end",
     "a slip force that falls by {} from the middle of the stroke to its end", kLookAtTheLoad,
     std::numeric_limits<double>::infinity(), nullptr,
     "a slip force that depends on the position, differently in each direction"},
    {"slip_position_quadratic",
     "a slip force that grows by {}, nonlinearly, from the middle of the stroke to its end",
     "a slip force that falls by {}, nonlinearly, from the middle of the stroke to its end",
     kLookAtTheLoad, std::numeric_limits<double>::infinity(), nullptr,
     "a slip force that depends on the position, differently in each direction"},
    {"speed_power", "a force that depends on a power of the speed", nullptr,
     "record the time, and compare tests at several speeds"},
    {"force_of_position", "a force that depends on the position", nullptr,
     "look for a spring, a cable or a tilt parallel to the contact, and measure it without the "
     "contact"},
    {"covariate", "a force in proportion to another column of the file, {}", nullptr,
     "name the column with --covariate"},
    {"smoothing", "a force that is averaged over a window in time with a standard deviation of {}",
     "a displacement that is averaged over a window in time with a standard deviation of {}",
     "compare the filters of the two channels"},
    {"held_displacement",
     "a displacement reading that repeats while the contact moves, so that {} of the travel "
     "between two readings is missing",
     nullptr, "record the displacement as often as the force, or leave the repeats out"},
    {"amplitude_dependence", "a friction that grows by {} from the narrowest stroke to the widest",
     "a friction that falls by {} from the narrowest stroke to the widest",
     "fit each amplitude alone"},
    {"displacement_drift", "a displacement that drifts by {}", nullptr, "give --drift"},
    {"clock_drift", "a force whose clock falls behind by {} over the record",
     "a force whose clock gains {} over the record",
     "sample both channels by one clock, or fit parts of the record"},
    {"heavy_tails", "readings far off their neighbours, {} of all", nullptr,
     "look for disturbances of the channel"},
}};

const CauseRow& RowOf(const Cause& cause) {
  const auto row = std::ranges::find(kCauses, cause.code, &CauseRow::code);
  if (row == kCauses.end()) {
    throw std::logic_error(fmt::format("the cause '{}' has no sentence", cause.code));
  }
  return *row;
}

std::string SizeText(const Cause& cause, double size) {
  if (size >= RowOf(cause).whole) return "all";
  if (cause.unit == "-") return fmt::format("{:.3g} %", 100 * size);
  return Quantity(size, cause.unit, 3);
}

/// Describes the look of the residuals in words.
std::string Looks(const Cause& cause) {
  const CauseRow& row = RowOf(cause);
  if (cause.unit.empty() && row.unsized != nullptr) return row.unsized;
  const bool turns = cause.size < 0 && row.negative != nullptr;
  return fmt::format(fmt::runtime(turns ? row.negative : row.looks),
                     SizeText(cause, turns ? -cause.size : cause.size));
}

/// Units by sample of a record without a time, and over that of a column, of a force and of a
/// torque.
constexpr std::array<std::pair<std::string_view, std::string_view>, 5> kOthersOfForce = {{
    {"N/sample", "N m/sample"},
    {"N samples/m", "N m samples/rad"},
    {"N samples²/m", "N m samples²/rad"},
    {"N/unit", "N m/unit"},
    {"m/sample", "rad/sample"},
}};

bool IsOfLaw(const identification::ParameterEstimate& estimate) {
  return estimate.name == "sigma" || estimate.name == "alpha" || estimate.name == "slip_force";
}

/// Names the parameters of the law whose intervals include what the model misses; others where none
/// of these does.
std::string WhatIncludesIt(const identification::FitResult& fit) {
  std::vector<std::string> names;
  std::vector<std::string> others;
  for (const identification::ParameterEstimate& estimate : fit.parameters) {
    if (estimate.identifiability != identification::Identifiability::kEffective) continue;
    (IsOfLaw(estimate) ? names : others).push_back(estimate.name);
  }
  if (names.empty()) names.swap(others);
  if (names.empty()) return "no parameter is usable";
  const bool are_several = names.size() + others.size() > 1;
  return fmt::format(
      "the interval{} of {}{} include{} this", are_several ? "s" : "", fmt::join(names, ", "),
      others.empty() ? "" : fmt::format(" and {} more", others.size()), are_several ? "" : "s");
}

}  // namespace

bool IsJudged(const Report& report) { return !report.failed() && report.fit.adequacy.tried > 0; }

std::string WhyNoOption(const Cause& cause) {
  if (cause.has_known_factor()) return cause.option + ", where the factor C is known";
  const bool is_of_speed = cause.code == "viscous_force" || cause.code == "speed_power";
  return is_of_speed ? "needs a time column" : "no option takes it into account yet";
}

void AdaptCauses(const Units& units, std::vector<Cause>& causes) {
  for (Cause& cause : causes) {
    cause.unit = UnitIn(units, cause.unit);
    if (units.force == kUnitsOfForce.force) continue;
    for (const auto& [of_force, of_torque] : kOthersOfForce) {
      if (cause.unit == of_force) cause.unit = of_torque;
    }
  }
}

namespace {

/// A column's factor that is known, as a piston's area is, is better held than fitted: a column
/// that goes with the motion takes its fraction of the slip force.
std::string OrHeld(const Cause& cause) {
  if (cause.code != "covariate") return "";
  if (cause.has_known_factor()) {
    return " where its factor is known; the column follows the contact's force, and a factor that "
           "is fitted would take a part of slip_force";
  }
  return fmt::format(", or {}=C where its factor is known", cause.option);
}

}  // namespace

std::string Sentence(const Cause& cause, loop::Channel response) {
  const CauseRow& row = RowOf(cause);
  const bool is_other =
      response == loop::Channel::kDisplacement && row.remedy_of_displacement != nullptr;
  const std::string why = cause.is_measured ? "over which the force stays constant in every stroke"
                                            : fmt::format("which explains {:.0f} % of the misfit",
                                                          100 * cause.explains);
  return fmt::format("{}, {}: {}", Looks(cause), why,
                     cause.option.empty()
                         ? std::string(is_other ? row.remedy_of_displacement : row.remedy)
                         : fmt::format("give {}{}", cause.option, OrHeld(cause)));
}

std::vector<std::string_view> CauseCodes() { return NamesOf(kCauses, &CauseRow::code); }

bool IsUsable(const Report& report) {
  if (!IsJudged(report)) return true;
  const Adequacy& adequacy = report.fit.adequacy;
  if (adequacy.verdict == AdequacyVerdict::kInadequate) {
    return std::ranges::any_of(report.fit.parameters,
                               &identification::ParameterEstimate::includes_discrepancy);
  }
  if (adequacy.verdict == AdequacyVerdict::kAdequate) return true;
  return adequacy.use != identification::Use::kNone ||
         std::ranges::any_of(report.fit.parameters, [](const auto& estimate) {
           return IsOfLaw(estimate) && estimate.is_known();
         });
}

std::string MisfitSentence(const Report& report) {
  const Adequacy& adequacy = report.fit.adequacy;
  const bool is_of_force = report.fit.response == loop::Channel::kForce;
  std::string sentence = fmt::format("{} misses the {} by {} rms", report.fit.model->name,
                                     is_of_force ? "force" : "displacement",
                                     Quantity(adequacy.misfit, report.units.response, 3));
  if (adequacy.misfit_over_half_gap) {
    const double percent = 100 * *adequacy.misfit_over_half_gap;
    sentence += percent < 100 ? fmt::format(" ({:.2g} % of the half gap)", percent)
                              : fmt::format(" ({:.0f} % of the half gap)", percent);
  }
  const double repeats = report.fit.WidestRecord().structure.repeatable_share;
  if (repeats > 0) {
    sentence += fmt::format(", {:.0f} % of its variance alike in every stroke", 100 * repeats);
  }
  return sentence;
}

std::string VerdictSentence(const Report& report) {
  if (!IsJudged(report)) return fmt::format("not judged: {}", kWhyNotJudged);
  const Adequacy& adequacy = report.fit.adequacy;
  if (const auto* unseen = report.fit.FindFinding("loop_not_seen"); unseen != nullptr) {
    return fmt::format(
        "inadequate: the force shows no loop, since the model explains only {:.2g} % of its "
        "variance; the parameters mean nothing for this record",
        std::max(0.0, 100 * unseen->Number("r_squared").value_or(0.0)));
  }
  if (adequacy.verdict == AdequacyVerdict::kAdequate) {
    return fmt::format("adequate: the residuals, {} rms, look like noise ({})",
                       Quantity(report.fit.residuals.rms, report.units.response, 3),
                       ChanceText(adequacy.p_value, 2));
  }
  return fmt::format("{}, {}: {}, more than noise alone explains ({}); {}", Name(adequacy.verdict),
                     adequacy.use == identification::Use::kNone ? "of no use for the law's shape"
                                                                : Name(adequacy.use),
                     MisfitSentence(report), ChanceText(adequacy.p_value, 2),
                     WhatIncludesIt(report.fit));
}

namespace {

/// Says how other records are fitted by a model whose terms were chosen.
std::string SameModelAgain(const Report& report) {
  if (!report.terms || report.terms->added.empty()) return "";
  std::vector<std::string> groups;
  std::string columns;
  for (const std::string& name : report.terms->added) {
    if (identification::FindTermGroup(name) != nullptr) {
      groups.push_back(name);
      continue;
    }
    const auto column =
        std::ranges::find(report.options.covariates, name, identification::NameOfCovariate);
    if (column == report.options.covariates.end()) continue;
    const char* const quote = column->find(' ') == std::string::npos ? "" : "'";
    columns += fmt::format(" --covariate {}{}{}", quote, *column, quote);
  }
  return fmt::format(
      "no known cause explains half of the remaining misfit; to fit other records of this contact "
      "by the same model, give --terms {}{}",
      groups.empty() ? "none" : fmt::format("{}", fmt::join(groups, ",")), columns);
}

/// Returns the advice for a loop that is far from sliding and determines no slip force; empty
/// elsewhere. A spring parallel to a contact that slides lowers the energy ratio, too, but leaves a
/// gap that is the same over the stroke.
std::string LargerAmplitude(const Report& report) {
  constexpr double kFarFromSliding = 0.25;
  constexpr double kSameGap = 0.15;
  const loop::LoopFacts& facts = report.fit.WidestRecord().facts;
  const identification::ParameterEstimate* slip_force = report.fit.Find("slip_force");
  if (!facts.closed || !(facts.energy_ratio < kFarFromSliding) || slip_force == nullptr ||
      slip_force->is_known() || report.fit.response != loop::Channel::kForce) {
    return "";
  }
  const std::optional<double> of_gap = EnergyOverEvenGap(facts);
  if (of_gap && std::abs(*of_gap - 1) < kSameGap) return "";
  return fmt::format(
      "raise the amplitude until the force levels off: an energy ratio of {:.2g} is far from "
      "sliding, and the record determines no slip force",
      facts.energy_ratio);
}

}  // namespace

std::string NextStep(const Report& report) {
  const Adequacy& adequacy = report.fit.adequacy;
  if (!IsJudged(report) || adequacy.verdict == AdequacyVerdict::kAdequate) return "";
  if (adequacy.causes.empty() || adequacy.causes.front().option.empty()) {
    if (const std::string larger = LargerAmplitude(report); !larger.empty()) return larger;
  }
  if (adequacy.causes.empty()) return SameModelAgain(report);
  return "it looks like " + Sentence(adequacy.causes.front(), report.fit.response);
}

}  // namespace mindahl::report
