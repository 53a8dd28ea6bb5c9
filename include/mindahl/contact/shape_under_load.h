#pragma once

#include <optional>
#include <string>

#include "mindahl/contact/mindlin_dahl_mapping.h"

namespace mindahl::contact {

// Identifies a contact whose stiffness follows the load as a known kind of shape predicts: a ∝ N^p,
// so σ = 8a/G* ∝ N^p. One stiffness stands for all loads.

/// Shapes whose contact radius is a power of the load.
enum class ContactShape {
  kSphere,     ///< p = 1/3, Hertz
  kCone,       ///< p = 1/2, Sneddon
  kFlatPunch,  ///< p = 0
  kRough,      ///< p = 1: nominally flat surfaces that touch at their summits
};

/// Holds the quantities that follow from a shape; empty where they do not.
struct ShapeUnderLoad {
  std::optional<PropagatedValue> contact_radius;     ///< a [m] at the load; not of rough surfaces
  std::optional<PropagatedValue> equivalent_radius;  ///< ρ [m] of a sphere
  /// G* [1/Pa] and E* [Pa] where they were not known: of a sphere
  std::optional<PropagatedValue> tangential_compliance;
  std::optional<PropagatedValue> effective_modulus;
  /// E [Pa] of the one body whose E was not known, 1 or 2; of a sphere
  std::optional<PropagatedValue> youngs_modulus;
  int body = 0;
  std::optional<PropagatedValue> slope;  ///< slope [-] of a cone's side against the other surface
  /// N/σ [m] of rough surfaces, the same under every load
  std::optional<PropagatedValue> load_over_stiffness;
  /// Names, in a sentence, the inputs that more would need; empty where nothing is missing.
  std::string unidentified;
};

/// Identifies a contact from a stiffness σ [N/m] under the normal load of what is known:
///
/// | shape | known | identified |
/// |---|---|---|
/// | sphere | G*, E* | a = σG*/8, ρ = 4E*a³/(3N) |
/// | sphere | ρ, G* | a = σG*/8, E* = 3Nρ/(4a³) |
/// | sphere | ρ, E of one body, ν of both | the other E, of which σ = 8a/G* with Hertz's a |
/// | sphere | ρ, one ν for both bodies | G*E* = 2(2 − ν)/(1 − ν), so G* = √(384Nρ/(G*E*·σ³)) |
/// | cone | G*, E* | a, and tan θ = 2N/(πE*a²) (Sneddon 1965) |
/// | flat punch | G* | a |
/// | rough | nothing | N/σ |
///
/// G* given wins over that of the materials. With one ν the ratio G*E* is the same whatever the
/// two E are, since both compliances are sums of 1/E: it is why no modulus is needed. E of a body
/// exists where σ is less than against a rigid body in its place: the stiffness falls without end
/// as that body softens.
/// @param stiffness  σ [N/m], finite, > 0; standard error >= 0, may be infinite
/// @param known      with a normal load; its contact radius is not looked at
/// @throws InvalidArgument naming the parameter, its value and the rule, or the load as missing
/// Errors as IdentifyContact().
ShapeUnderLoad IdentifyShape(ContactShape shape, const UncertainValue& stiffness,
                             const KnownContact& known);

}  // namespace mindahl::contact
