#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "mindahl/contact/cattaneo_mindlin.h"
#include "mindahl/contact/hertz.h"
#include "mindahl/models/branch_law.h"

namespace mindahl::contact {

// The Mindlin-Dahl mapping (Peyret, Rosatello, Chevallier & Dion 2017, eq. 21). The virgin curve of
// Cattaneo and Mindlin solves Dahl's equation dT/dδ = σ(1 − T/Tc)^α with
//   σ = 8a/G*,   α = 1/3,   Tc = μN,   δc = Tc/(σ(1 − α)) = 3·Tc·G*/(16a).
// Forward, a contact gives Dahl's parameters; inverse, a fitted σ and Tc and what is known of the
// contact give the rest.

/// Dahl's exponent α of a Mindlin contact.
inline constexpr double kMindlinShapeExponent = 1.0 / 3.0;

/// Returns Dahl's parameters of a contact with known radius and compliance: σ = 8a/G*, α = 1/3, Tc.
/// With a friction coefficient and a normal load, the slip force is GrossSlipForce(μ, N).
/// @throws InvalidArgument as Validate(MindlinContact)
models::BranchLaw MapMindlinToDahl(const MindlinContact& contact);

/// A quantity with its standard uncertainty. A number alone is exact, and where a plain number is
/// asked for the quantity reads as its value.
struct UncertainValue {
  UncertainValue() = default;
  UncertainValue(double exact) : value(exact) {}
  UncertainValue(double estimate, double error) : value(estimate), standard_error(error) {}
  operator double() const { return value; }

  double value = 0.0;
  /// Same unit, >= 0. Finite for what is known; of a fit infinity where it leaves the value open.
  double standard_error = 0.0;
};

/// Holds the known properties of one body; any member may be missing.
struct KnownBody {
  std::optional<UncertainValue> youngs_modulus = std::nullopt;  ///< E [Pa], finite, > 0
  std::optional<UncertainValue> poisson_ratio = std::nullopt;   ///< ν [-], in (−1, 0.5]
  /// R [m], not 0, infinite for a plane, which is exact, negative for a seat
  std::optional<UncertainValue> radius = std::nullopt;
};

/// Holds the known properties of the contact, in addition to the fit. The uncertainties are
/// independent of each other and of the fit's.
struct KnownContact {
  std::optional<UncertainValue> normal_load = std::nullopt;  ///< N [N], finite, > 0
  KnownBody body_1{};
  KnownBody body_2{};
  /// a [m], measured otherwise, finite, > 0
  std::optional<UncertainValue> contact_radius = std::nullopt;
  std::optional<UncertainValue> tangential_compliance = std::nullopt;  ///< G* [1/Pa], finite, > 0
};

/// A result with the parts of its uncertainty: standard_error² = fit_error² + input_error².
struct PropagatedValue : UncertainValue {
  double fit_error = 0.0;    ///< from σ and Tc, their correlation included; same unit
  double input_error = 0.0;  ///< from what is known besides the fit; same unit
  /// The input that contributes most, "radius of body 1"; empty where all are exact. To be measured
  /// better first.
  std::string_view largest_input;

  /// Returns the fraction of the variance from the fit [-], 1 where it leaves the value open; 0
  /// where nothing is uncertain.
  [[nodiscard]] double FitShare() const;
  /// Returns the fraction of the variance from the inputs [-]; with FitShare() it makes 1, or 0
  /// where nothing is uncertain.
  [[nodiscard]] double InputShare() const;
};

/// Holds what materials and radii, or contact radius and compliance, predict under a load.
struct PredictedContact {
  std::optional<PropagatedValue> effective_modulus;  ///< E* [Pa]; of materials
  std::optional<PropagatedValue> equivalent_radius;  ///< ρ [m]; of two radii
  std::optional<PropagatedValue> approach;           ///< a²/ρ [m]; of two radii
  PropagatedValue tangential_compliance;             ///< G* [1/Pa]
  PropagatedValue contact_radius;                    ///< a [m]
  PropagatedValue maximum_pressure;                  ///< p₀ [Pa]
  PropagatedValue tangential_stiffness;              ///< σ = 8a/G* [N/m]
  PropagatedValue slip_force;                        ///< Tc = μN [N]
  PropagatedValue gross_slip_displacement;           ///< δc = 3·μN·G*/(16a) [m]
};

/// Applies Hertz, Mindlin and the mapping with the uncertainty of every input; values as the
/// functions of hertz.h and MapMindlinToDahl() give them. All uncertainty is that of inputs:
/// fit_error is 0.
/// @param known  N, and either a and G* alone or E, ν and R of both bodies
/// @param friction_coefficient  μ [-], finite, > 0
/// @throws InvalidArgument naming what is missing, or the parameter, its value and the rule
PredictedContact PredictContact(const KnownContact& known,
                                const UncertainValue& friction_coefficient);

/// Holds the predictions of Hertz and Mindlin when materials, radii and load are all known.
struct HertzPrediction {
  PropagatedValue effective_modulus;     ///< E* [Pa]
  PropagatedValue equivalent_radius;     ///< ρ [m] of the two radii
  PropagatedValue contact_radius;        ///< a [m] of Hertz
  PropagatedValue maximum_pressure;      ///< p₀ [Pa] of Hertz
  PropagatedValue tangential_stiffness;  ///< σ [N/m] = 8a/G*, with the G* in use
  /// δc [m] = 3·Tc·G*/(16a) with the measured Tc
  PropagatedValue gross_slip_displacement;
  /// Measured over predicted σ [-]; 1 when the theory holds. Also the ratio of the identified
  /// contact radius to Hertz's.
  PropagatedValue sigma_over_hertz_mindlin;
  /// Mindlin's δc of the measured σ and Tc over the predicted [-]: the inverse of the ratio of σ,
  /// for Tc is in both.
  PropagatedValue gross_slip_displacement_ratio;
};

/// Holds what fit and knowledge of the contact identify together; empty where they do not.
struct IdentifiedContact {
  std::optional<PropagatedValue> friction_coefficient;  ///< μ = Tc/N [-]; needs N
  std::optional<PropagatedValue> contact_radius;        ///< a = σG*/8 [m]; needs G*
  std::optional<PropagatedValue>
      tangential_compliance;                         ///< G* = 8a/σ [1/Pa]; needs a given radius a
  std::optional<PropagatedValue> equivalent_radius;  ///< ρ = 4E*a³/(3N) [m]; needs E*, a, N
  std::optional<PropagatedValue> maximum_pressure;   ///< p₀ = 3N/(2πa²) [Pa]; needs a, N
  /// Mindlin's δc = 3Tc/(2σ) [m]; needs nothing. That of the fitted α is Tc/(σ(1 − α)).
  PropagatedValue gross_slip_displacement;
  /// Measured σ over 8a/G* [-], for a given radius a and a known G*; 1 when the theory holds.
  std::optional<PropagatedValue> sigma_over_mindlin;
  std::optional<HertzPrediction> hertz;  ///< needs E, ν and R of both bodies, and N

  /// A sentence for each quantity that is missing, with the inputs that would give it:
  /// "friction coefficient needs the normal load".
  std::vector<std::string> unidentified;
  /// A sentence for each quantity that was given and also follows from other inputs, with both
  /// values and which one is used.
  std::vector<std::string> redundant;
};

/// Names the quantities that a fit together with known properties may identify.
enum class ContactQuantity {
  kFrictionCoefficient,
  kContactRadius,
  kTangentialCompliance,
  kEquivalentRadius,
  kMaximumPressure,
};

/// Returns, in words ("the normal load"), the inputs that IdentifyContact() still needs for a
/// quantity; empty where nothing is missing.
std::vector<std::string> MissingInputs(const KnownContact& known, ContactQuantity quantity);

/// Inverts the mapping: from a fitted stiffness and slip force to the contact.
///
/// Knowledge may be redundant. What is given directly wins over what follows from other inputs:
///  - G* given and E, ν of both bodies: the given G* is used throughout, E* comes from the
///  materials;
///  - a given and G* known: a = σG*/8 and G* = 8a/σ are both reported, each ignoring the other's
///  given
///    value, and sigma_over_mindlin compares them; ρ and p₀ use the given a and nothing of the fit;
///  - a given and Hertz complete: Hertz's a serves the prediction alone.
/// The first and the last are also named in `redundant`, whatever the discrepancy.
///
/// Standard errors are propagated to first order (GUM, JCGM 100:2008, eq. 13) from σ and Tc with
/// their correlation and from every input, each counted once however many ways it enters: E of a
/// body is in G*, in E* and so in Hertz's a. A relative error of a counts twice in p₀ and three
/// times in ρ.
///
/// @param tangential_stiffness  σ [N/m], finite, > 0; standard error >= 0, may be infinite
/// @param slip_force            Tc [N], finite, > 0; standard error >= 0, may be infinite
/// @param known                 standard errors finite, >= 0, 0 for a plane's radius
/// @param correlation           of the errors of σ and Tc [-], in [−1, 1]; of no account where
///   either is infinite
/// @throws InvalidArgument naming the parameter, its value and the rule, also for knowledge that is
///   invalid but not needed
/// The first order is symmetric, the truth is not: 10 % of a is +33 % or −27 % of ρ, not ±30 %.
IdentifiedContact IdentifyContact(const UncertainValue& tangential_stiffness,
                                  const UncertainValue& slip_force, const KnownContact& known,
                                  double correlation = 0.0);

/// Returns a sentence for each value that is possible but implausible, with what to check: most
/// often a unit. Each limit lies beyond what is measured of dry solids:
///   G* > 1 1/Pa    a body softer than foam; many texts write G* for its inverse
///   E < 1 MPa      softer than rubber
///   a > R/3        of the smaller radius: Hertz's parabola is no sphere any more (Johnson §4.1)
///   μ > 5
/// @param friction_coefficient  μ [-], given or identified
/// @param fitted_radius  a [m] as identified; a given one and Hertz's are taken from `known`
std::vector<std::string> DoubtsAbout(const KnownContact& known,
                                     std::optional<double> friction_coefficient,
                                     std::optional<double> fitted_radius = std::nullopt);

}  // namespace mindahl::contact
