#include "mindahl/identification/terms.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace mindahl::identification {
namespace {

// Below it the force is as good as a slip force.
constexpr double kLeastSpeedExponent = 0.2;
// Below it (v/v₀)^m − 1 is m·ln(v/v₀) within a tenth over two decades of speed.
constexpr double kLeastSlipSpeedExponent = 0.05;

constexpr Term Stiffness(std::string_view name, std::string_view meaning, Presence presence) {
  return {.name = name,
          .unit = "N/m",
          .meaning = meaning,
          .presence = presence,
          .positive = true,
          .lowest = 1e-6,
          .highest = 1e9,
          .powers = {.force = 1, .length = -1}};
}

/// Makes the factor of a force in addition to the contact's.
constexpr Term Factor(std::string_view name, std::string_view unit, std::string_view meaning,
                      TermScale powers, bool is_never_negative = false) {
  return {.name = name,
          .unit = unit,
          .meaning = meaning,
          .powers = powers,
          .is_linear = true,
          .needs_time = powers.time != 0,
          .is_never_negative = is_never_negative};
}

/// Makes a change of the slip force over the position or time. With both changes over the position
/// the slip force stays positive over the whole stroke.
constexpr Term SlipChange(std::string_view name, std::string_view meaning) {
  return {.name = name, .meaning = meaning, .lowest = -0.5, .highest = 0.5, .start = 0.0};
}

/// Makes an exponent of the speed, of a force that another term scales: its bounds are ends of the
/// theory's where it shapes no column.
constexpr Term Exponent(std::string_view name, std::string_view meaning, std::string_view needs,
                        double lowest, std::string_view shapes = {}) {
  return {.name = name,
          .meaning = meaning,
          .lowest = lowest,
          .highest = 1.0,
          .needs_time = true,
          .start = 0.5,
          .shapes = shapes,
          .needs = needs,
          .lowest_is_of_theory = shapes.empty(),
          .highest_is_of_theory = shapes.empty()};
}

/// Bounds are in units of the data (half ranges of displacement and force), far outside what a
/// record can determine: a stiffness of 1e9 is a vertical branch, a slip force of 1e4 a line.
constexpr std::array kTermRows = {
    Stiffness("sigma", "σ, tangential stiffness at the start of every branch", Presence::kAlways),
    Term{.name = "alpha",
         .meaning = "α, shape exponent",
         .presence = Presence::kAlways,
         .lowest = 0.0,
         .highest = 20.0,
         .lowest_is_of_theory = true},
    Term{.name = "slip_force",
         .unit = "N",
         .meaning = "Tc",
         .presence = Presence::kAlways,
         .positive = true,
         .lowest = 1e-3,
         .highest = 1e4,
         .powers = {.force = 1}},
    Stiffness("rig_stiffness", "k of a spring in series, δ = x + T/k", Presence::kOnDemand),
    Term{.name = "load_exponent",
         .meaning = "p of σ ∝ N^p, for records whose loads differ",
         .presence = Presence::kLoadSeries,
         // The theories have exponents between 0 and 1.
         .lowest = -5.0,
         .highest = 5.0},
    Term{.name = "asymmetry",
         .meaning = "A of slip forces Tc(1 + A) where the displacement grows and Tc(1 − A) where "
                    "it falls; slip_force is their mean",
         // One slip force is then nine times the other. Nearer to −1 and 1 a virgin branch grows
         // twice as large as the contact's, as branches of a contact are that was cycled.
         .lowest = -0.8,
         .highest = 0.8},
    Factor("plateau_slope", "N/m", "slope of an additional force slope·δ",
           {.force = 1, .length = -1}),
    Factor("viscous", "N s/m", "C of an additional force C·dδ/dt",
           {.force = 1, .length = -1, .time = 1}, /*is_never_negative=*/true),
    Exponent("speed_exponent",
             "m of a force C·v^m along the motion, v the speed in m/s and C viscous, in place of "
             "the viscous force",
             "viscous", kLeastSpeedExponent, "viscous"),
    Factor("inertia", "kg", "M of an additional force M·d²δ/dt²",
           {.force = 1, .length = -1, .time = 2}, /*is_never_negative=*/true),
    SlipChange("slip_slope",
               "m₁ of a slip force Tc(1 + m₁ξ + m₂ξ²), ξ the position, ±1 at the ends of the "
               "widest stroke"),
    SlipChange("slip_curvature", "m₂, likewise"),
    Term{.name = "slip_speed",
         .meaning = "c of a slip force Tc(1 + c((v/v₀)^m − 1)), v₀ the mean speed in the middle "
                    "third of the strokes, at which Tc is that of the fit",
         // At 1 there is no slip force at rest, and below −1 it would more than halve by v₀.
         .lowest = -1.0,
         .highest = 1.0,
         .needs_time = true,
         .start = 0.3,
         .needs = "slip_speed_exponent",
         .highest_is_of_theory = true},
    Exponent("slip_speed_exponent", "m, likewise", "slip_speed", kLeastSlipSpeedExponent),
    SlipChange(
        "slip_trend",
        "k of a slip force Tc(1 + kτ), τ the time, −1 at the record's beginning and 1 at its "
        "end; the sample's number where there is no time"),
    Term{.name = "drag_fraction",
         .meaning = "d of a force Tc((1 − d)·t + d(v/v₀)^m) whose part d acts along the motion and "
                    "has no memory, t the contact's force over Tc, v₀ as for slip_speed",
         .lowest = 0.0,
         .highest = 1.0,
         .needs_time = true,
         .start = 0.3,
         .needs = "drag_exponent",
         .lowest_is_of_theory = true,
         .highest_is_of_theory = true},
    Exponent("drag_exponent", "m, likewise", "drag_fraction", kLeastSpeedExponent),
    Factor("plateau_curvature", "N/m²",
           "factor of an additional force in proportion to δ², δ from the middle of the stroke",
           {.force = 1, .length = -2}),
    Term{.name = "ripple_period",
         .unit = "m",
         .meaning = "λ of a periodic force A±cos(2πδ/λ + φ±), one phase for each direction",
         .positive = true,
         .lowest = 0.01,
         .highest = 1.0,  // fits twice into a stroke
         .powers = {.length = 1},
         .start = 0.0,
         .shapes = "ripple_",
         .needs = "ripple_cosine_up"},
    Factor("ripple_cosine_up", "N",
           "factor of cos(2πδ/λ) where the displacement grows, δ from the middle of the first "
           "record",
           {.force = 1}),
    Factor("ripple_sine_up", "N", "factor of sin(2πδ/λ), likewise", {.force = 1}),
    Factor("ripple_cosine_down", "N", "factor of cos(2πδ/λ) where the displacement falls",
           {.force = 1}),
    Factor("ripple_sine_down", "N", "factor of sin(2πδ/λ), likewise", {.force = 1}),
    Term{.name = "lag",
         .unit = "s",
         .meaning = "delay of the contact's force after the displacement, negative if before it; "
                    "in samples where the record has no time",
         // A longer one is a filter or a clock of its own. Samples that near to the ends of a
         // record do not count under a lag that is fitted.
         .lowest = -0.05,
         .highest = 0.05,
         .powers = {.cycle = 1},
         .unit_by_sample = "samples"},
    Term{
        .name = "backlash",
        .unit = "m",
        .meaning = "g, width of a gap before the contact, which bears no force while it is crossed",
        .lowest = 0.0,
        .highest = 1.0,  // half of a stroke
        .powers = {.length = 1},
        .lowest_is_of_theory = true},
    Term{.name = "covariate",
         .unit = "N/unit",
         .meaning = "C of an additional force C·column, one for each named column: "
                    "`covariate_COLUMN`, with _ for blanks and signs; N/ the column's unit where "
                    "the header has one. force_offset is then its value in the middle of the "
                    "column's range",
         .powers = {.force = 1, .of_file = true},
         .is_linear = true,
         .of_column = true},
    Term{.name = "force_offset",
         .unit = "N",
         .meaning = "force added to the model's; with a drift, its value at the record's middle",
         .presence = Presence::kOffsets,
         .powers = {.force = 1, .of_file = true},
         .is_linear = true},
    Term{
        .name = "displacement_offset",
        .unit = "m",
        .meaning = "position at which a virgin contact is unloaded; for a steady loop its centre, "
                   "taken from the data",
        .presence = Presence::kOffsets,
        .powers = {.length = 1},
    },
    Term{.name = "force_drift",
         .unit = "N/s",
         .meaning = "rate of a force linear in time; in N a sample where the record has no time",
         .presence = Presence::kReported,
         .powers = {.force = 1, .time = -1, .of_file = true},
         .is_linear = true,
         .unit_by_sample = "N/sample"},
    Term{.name = "displacement_drift",
         .unit = "m/s",
         .meaning = "rate of a displacement linear in time, where the displacement is fitted; in m "
                    "a sample where the record has no time",
         .presence = Presence::kNever,
         .powers = {.length = 1, .time = -1},
         .is_linear = true,
         .unit_by_sample = "m/sample"},
};

constexpr auto kTerms = [] {
  auto terms = kTermRows;
  for (std::size_t i = 0; i < terms.size(); ++i) {
    terms[i].id = static_cast<TermId>(i);
    terms[i].is_of_record = terms[i].id >= TermId::kForceOffset;
  }
  return terms;
}();
static_assert(kTerms.back().id == TermId::kDisplacementDrift);

/// The same of a displacement that answers an imposed force.
constexpr auto kTermsOfDisplacement = [] {
  auto terms = kTerms;
  for (Term& term : terms) {
    const bool is_offset = term.presence == Presence::kOffsets;
    if (is_offset) term.is_linear = !term.is_linear;  // that of the other channel is linear
    if (term.id == TermId::kDisplacementDrift) {
      term.presence = Presence::kReported;
    } else if (term.id > TermId::kSlipForce && term.id != TermId::kLoadExponent && !is_offset) {
      term.presence = Presence::kNever;
    }
  }
  return terms;
}();

template <typename Row>
const Row* FindNamed(std::span<const Row> rows, std::string_view name) {
  const auto row = std::ranges::find(rows, name, &Row::name);
  return row == rows.end() ? nullptr : &*row;
}

}  // namespace

double Term::scale(const TermUnits& units) const {
  return (powers.of_file ? units.force_sense : 1.0) * std::pow(units.force, powers.force) *
         std::pow(units.half_duration, powers.time) * std::pow(units.cycle, powers.cycle) *
         std::pow(units.length, powers.length);
}

double Term::reference(const TermUnits& units) const {
  if (id == TermId::kForceOffset) return units.force_sense * units.force_reference;
  return id == TermId::kDisplacementOffset ? units.displacement_reference : 0.0;
}

std::span<const Term> Terms(loop::Channel response) {
  if (response == loop::Channel::kForce) return kTerms;
  return kTermsOfDisplacement;
}

const Term& TermOf(TermId id, loop::Channel response) {
  return Terms(response)[static_cast<std::size_t>(id)];
}

const Term* FindTerm(std::string_view name, loop::Channel response) {
  return FindNamed(Terms(response), name);
}

std::span<const TermGroup> TermGroups() {
  static const std::vector<TermGroup> groups = {
      {"viscous", {"viscous"}, "force C·v of the velocity v"},
      {"speed_exponent", {"speed_exponent", "viscous"}, "force C·v^m", /*is_tried=*/false},
      {"drag", {"drag_fraction", "drag_exponent"}, "part d of Tc, by v^m, without memory"},
      {"inertia", {"inertia"}, "force of a mass between contact and load cell"},
      {"plateau_slope", {"plateau_slope"}, "force in proportion to the displacement"},
      {"slip_speed", {"slip_speed", "slip_speed_exponent"}, "slip force that depends on the speed"},
      {"slip_trend", {"slip_trend"}, "slip force that changes with time"},
      {"slip_position",
       {"slip_slope", "plateau_slope"},
       "force and slip force that depend on the position"},
      {"slip_position_quadratic",
       {"slip_slope", "slip_curvature", "plateau_slope", "plateau_curvature"},
       "force and slip force that depend on the position, to second order: spring, gravity"},
      {"ripple",
       {"ripple_period", "ripple_cosine_up", "ripple_sine_up", "ripple_cosine_down",
        "ripple_sine_down"},
       "force that is periodic in the position",
       /*is_tried=*/false},
      {"force_drift", {"force_drift"}, "force in proportion to time"},
      {"rig_stiffness", {"rig_stiffness"}, "rig in series"},
      {"asymmetry", {"asymmetry"}, "slip forces that differ by direction"},
      {"lag", {"lag"}, "delay of the force after the displacement"},
      {"backlash", {"backlash"}, "gap that is crossed at zero force"},
  };
  return groups;
}

const TermGroup* FindTermGroup(std::string_view name) { return FindNamed(TermGroups(), name); }

bool LeadsGroup(const Term& term) {
  return std::ranges::any_of(
      TermGroups(), [&](const TermGroup& group) { return group.terms.front() == term.name; });
}

std::string_view TermNameOf(std::string_view parameter) {
  const std::size_t digits = parameter.find_last_not_of("0123456789");
  const bool numbered =
      digits != std::string_view::npos && digits + 1 < parameter.size() && parameter[digits] == '_';
  return numbered ? parameter.substr(0, digits) : parameter;
}

const Term* TermOfParameter(std::string_view parameter) {
  const bool is_of_column = parameter.starts_with(NameOfCovariate(""));
  return is_of_column ? &TermOf(TermId::kCovariate) : FindTerm(TermNameOf(parameter));
}

std::string NameOfCovariate(std::string_view column) {
  std::string name = "covariate_";
  for (const char letter : column) {
    name += std::string_view(" \t=:;,.[](){}'\"").find(letter) != column.npos ? '_' : letter;
  }
  return name;
}

}  // namespace mindahl::identification
