#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mindahl/contact/cattaneo_mindlin.h"
#include "mindahl/contact/hertz.h"

namespace mindahl {

// The Mindlin-Dahl mapping (Peyret, Rosatello, Chevallier & Dion 2017, eq. 21). The virgin curve of
// Cattaneo and Mindlin solves Dahl's equation dT/dδ = σ(1 − T/Tc)^α with
//   σ = 8a/G*,   α = 1/3,   Tc = μN,   δc = Tc/(σ(1 − α)) = 3·Tc·G*/(16a).
// Forward, a contact gives Dahl's parameters; inverse, a fitted σ and Tc and what is known of the
// contact give the rest.

/// Dahl's exponent α of a Mindlin contact.
inline constexpr double kMindlinShapeExponent = 1.0 / 3.0;

/// Dahl's parameters of a Mindlin contact.
struct MindlinDahlParameters {
  double tangential_stiffness = 0.0;              ///< σ [N/m]
  double shape_exponent = kMindlinShapeExponent;  ///< α [-]
  double slip_force = 0.0;                        ///< Tc [N]
  double gross_slip_displacement = 0.0;           ///< δc [m]
};

/// Dahl's parameters of a contact whose radius and compliance are known.
/// With a friction coefficient and a normal load, the slip force is GrossSlipForce(μ, N).
/// @throws InvalidArgument as Validate(MindlinContact)
MindlinDahlParameters MapMindlinToDahl(const MindlinContact& contact);

/// Everything that Hertz and Mindlin say of two bodies under load.
struct HertzMindlinContact {
  double effective_modulus = 0.0;      ///< E* [Pa]
  double tangential_compliance = 0.0;  ///< G* [1/Pa]
  double equivalent_radius = 0.0;      ///< ρ [m]
  double contact_radius = 0.0;         ///< a [m]
  double maximum_pressure = 0.0;       ///< p₀ [Pa]
  double approach = 0.0;               ///< normal approach a²/ρ [m]
  MindlinDahlParameters dahl;          ///< σ, α, Tc, δc

  [[nodiscard]] MindlinContact Mindlin() const {
    return {contact_radius, tangential_compliance, dahl.slip_force};
  }
};

/// Hertz, then Mindlin, then the mapping, from geometry, materials and load.
/// @param normal_load           N [N], finite, > 0
/// @param friction_coefficient  μ [-], finite, > 0
/// @throws InvalidArgument naming the parameter, its value and the rule; see Body and
/// EquivalentRadius
HertzMindlinContact SolveHertzMindlin(const Body& body_1, const Body& body_2, double normal_load,
                                      double friction_coefficient);

/// A positive quantity with its uncertainty.
struct UncertainValue {
  double value = 0.0;
  /// Same unit, >= 0. 0 when it does not come from the fit, infinity when the fit leaves it open.
  double standard_error = 0.0;
};

/// What is known of one body; any member may be missing.
struct KnownBody {
  std::optional<double> youngs_modulus = std::nullopt;  ///< E [Pa], finite, > 0
  std::optional<double> poisson_ratio = std::nullopt;   ///< ν [-], in (−1, 0.5]
  std::optional<double> radius =
      std::nullopt;  ///< R [m], not 0, infinite for a plane, negative for a seat
};

/// What is known of the contact besides the fit. Taken as exact: the standard errors of what is
/// identified carry the fit's uncertainty alone.
struct KnownContact {
  std::optional<double> normal_load = std::nullopt;  ///< N [N], finite, > 0
  KnownBody body_1{};
  KnownBody body_2{};
  std::optional<double> contact_radius = std::nullopt;  ///< a [m], measured otherwise, finite, > 0
  std::optional<double> tangential_compliance = std::nullopt;  ///< G* [1/Pa], finite, > 0
};

/// What Hertz and Mindlin predict when materials, radii and load are all known.
struct HertzPrediction {
  double effective_modulus = 0.0;     ///< E* [Pa]
  double equivalent_radius = 0.0;     ///< ρ [m] of the two radii
  double contact_radius = 0.0;        ///< a [m] of Hertz
  double maximum_pressure = 0.0;      ///< p₀ [Pa] of Hertz
  double tangential_stiffness = 0.0;  ///< σ [N/m] = 8a/G*, with the G* in use
  /// δc [m] = 3·Tc·G*/(16a) with the measured Tc, whence the standard error
  UncertainValue gross_slip_displacement;
  /// Measured over predicted σ [-]; 1 when the theory holds. Also the ratio of the identified
  /// contact radius to Hertz's.
  UncertainValue sigma_over_hertz_mindlin;
};

/// What the fit and the knowledge of the contact identify together; empty what they do not.
struct IdentifiedContact {
  std::optional<UncertainValue> friction_coefficient;  ///< μ = Tc/N [-]; needs N
  std::optional<UncertainValue> contact_radius;        ///< a = σG*/8 [m]; needs G*
  std::optional<UncertainValue>
      tangential_compliance;                        ///< G* = 8a/σ [1/Pa]; needs a given radius a
  std::optional<UncertainValue> equivalent_radius;  ///< ρ = 4E*a³/(3N) [m]; needs E*, a, N
  std::optional<UncertainValue> maximum_pressure;   ///< p₀ = 3N/(2πa²) [Pa]; needs a, N
  /// Measured σ over 8a/G* [-], for a given radius a and a known G*; 1 when the theory holds.
  std::optional<UncertainValue> sigma_over_mindlin;
  std::optional<HertzPrediction> hertz;  ///< needs E, ν and R of both bodies, and N

  /// A sentence for each quantity that is missing, with the inputs that would give it:
  /// "friction coefficient needs the normal load".
  std::vector<std::string> unidentified;
  /// A sentence for each quantity that was given and also follows from other inputs, with both
  /// values and which one is used.
  std::vector<std::string> redundant;
};

/// The inverse mapping: from a fitted stiffness and slip force to the contact.
///
/// Knowledge may be redundant. What is given directly wins over what follows from other inputs:
///  - G* given and E, ν of both bodies: the given G* is used throughout, E* comes from the
///  materials;
///  - a given and G* known: a = σG*/8 and G* = 8a/σ are both reported, each ignoring the other's
///  given
///    value, and sigma_over_mindlin compares them; ρ and p₀ use the given a, with no standard
///    error;
///  - a given and Hertz complete: Hertz's a serves the prediction alone.
/// The first and the last are also told in `redundant`, whatever the discrepancy.
///
/// Standard errors are linear: the relative error of a, G* and the ratios is that of σ, of p₀ twice
/// and of ρ three times it; that of μ and of the predicted δc is that of Tc.
///
/// @param tangential_stiffness  σ [N/m], finite, > 0; standard error >= 0, may be infinite
/// @param slip_force            Tc [N], finite, > 0; standard error >= 0, may be infinite
/// @throws InvalidArgument naming the parameter, its value and the rule, also for knowledge that is
///   invalid but not needed
IdentifiedContact IdentifyContact(const UncertainValue& tangential_stiffness,
                                  const UncertainValue& slip_force, const KnownContact& known);

}  // namespace mindahl
