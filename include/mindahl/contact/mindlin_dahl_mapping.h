#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mindahl/contact/cattaneo_mindlin.h"
#include "mindahl/contact/hertz.h"
#include "mindahl/models/branch_law.h"

namespace mindahl::contact {

// The Mindlin-Dahl mapping (Peyret, Rosatello, Chevallier & Dion 2017, eq. 21). The virgin curve of
// Cattaneo and Mindlin solves Dahl's equation dT/dδ = σ(1 − T/Tc)^α with
//   σ = 8a/G*,   α = 1/3,   Tc = μN,   δc = Tc/(σ(1 − α)) = 3·Tc·G*/(16a).

/// Dahl's exponent α of a Mindlin contact.
inline constexpr double kMindlinShapeExponent = 1.0 / 3.0;

/// Returns Dahl's parameters of a contact with known radius and compliance: σ = 8a/G*, α = 1/3, Tc.
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
  double standard_error = 0.0;  ///< same unit, finite, >= 0
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
  std::optional<UncertainValue> friction_coefficient = std::nullopt;  ///< μ [-], finite, > 0
  std::optional<UncertainValue> normal_load = std::nullopt;           ///< N [N], finite, > 0
  KnownBody body_1{};
  KnownBody body_2{};
  /// a [m], measured otherwise, finite, > 0
  std::optional<UncertainValue> contact_radius = std::nullopt;
  std::optional<UncertainValue> tangential_compliance = std::nullopt;  ///< G* [1/Pa], finite, > 0
};

/// Refuses values that no contact has, and two planes; what is missing is no fault. Messages call
/// E, ν and R of the bodies youngs_modulus_1, poisson_1, radius_1 and so on.
/// @throws InvalidArgument naming the quantity, its value and the rule
void Validate(const KnownContact& known);

/// Holds what materials and radii, or contact radius and compliance, predict under a load.
struct PredictedContact {
  std::optional<UncertainValue> effective_modulus;  ///< E* [Pa]; of materials
  std::optional<UncertainValue> equivalent_radius;  ///< ρ [m]; of two radii
  UncertainValue tangential_compliance;             ///< G* [1/Pa]
  UncertainValue contact_radius;                    ///< a [m]
  UncertainValue maximum_pressure;                  ///< p₀ [Pa]
  UncertainValue tangential_stiffness;              ///< σ = 8a/G* [N/m]
  UncertainValue slip_force;                        ///< Tc = μN [N]
  UncertainValue gross_slip_displacement;           ///< δc = 3·μN·G*/(16a) [m]
};

/// Applies Hertz, Mindlin and the mapping; values as the functions of hertz.h and
/// MapMindlinToDahl() give them, errors as of IdentifyContact().
/// @param known  μ, N, and either a and G* alone or E, ν and R of both bodies
/// @throws InputError naming the options that give these, where they are not given
/// @throws InvalidArgument naming the parameter, its value and the rule
PredictedContact PredictContact(const KnownContact& known);

/// Returns G* [1/Pa]: the given one, else that of both bodies' E and ν; empty where neither is
/// known.
/// @throws InvalidArgument as TangentialCompliance(Body, Body)
std::optional<double> TangentialCompliance(const KnownContact& known);

/// Names the quantities that a fit together with known properties may identify.
enum class ContactQuantity {
  kFrictionCoefficient,   ///< μ = Tc/N [-]; needs N
  kContactRadius,         ///< a = σG*/8 [m]; needs G*
  kTangentialCompliance,  ///< G* = 8a/σ [1/Pa]; needs a given radius a
  kEquivalentRadius,      ///< ρ = 4E*a³/(3N) [m]; needs E*, a, N
  kMaximumPressure,       ///< p₀ = 3N/(2πa²) [Pa]; needs a, N
  /// σ over 8a/G* [-], 1 when the theory holds: of Hertz's a, which needs E, ν and R of both bodies
  /// and N, else of a given a and a known G*
  kStiffnessRatio,
};

/// Inverts the mapping: from a stiffness and a slip force to a quantity of the contact. What is
/// given directly wins over what follows from other inputs: G* over the materials, of which E*
/// still comes, and a given a over σG*/8 in ρ and p₀. The standard error is that of the inputs, to
/// first order (GUM, JCGM 100:2008, eq. 13), each counted once however many ways it enters. σ and
/// Tc are exact here: their intervals are mapped end by end.
/// @param stiffness   σ [N/m], finite, > 0
/// @param slip_force  Tc [N], finite, > 0
/// @param known       standard errors finite, >= 0, 0 for a plane's radius
/// @returns empty where the inputs do not determine it
/// @throws InvalidArgument naming the parameter, its value and the rule, also for knowledge that is
///   invalid but not needed
/// Values are exact to rounding; derivatives are central differences, to 1e-9.
std::optional<UncertainValue> IdentifyContact(ContactQuantity quantity, double stiffness,
                                              double slip_force, const KnownContact& known);

/// Returns a sentence for each value that is possible but implausible, with what to check: most
/// often a unit. Each limit lies beyond what is measured of dry solids:
///   G* > 1 1/Pa    a body softer than foam; many texts write G* for its inverse
///   E < 1 MPa      softer than rubber
///   E > 2 TPa      stiffer than diamond
///   a > R/3        of the smaller radius: Hertz's parabola is no sphere any more (Johnson §4.1)
/// @param fitted_radius  a [m] as identified; a given one and Hertz's are taken from `known`
std::vector<std::string> DoubtsAbout(const KnownContact& known,
                                     std::optional<double> fitted_radius = std::nullopt);

}  // namespace mindahl::contact
