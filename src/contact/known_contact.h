#pragma once

#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "contact/propagation.h"
#include "mindahl/contact/mindlin_dahl_mapping.h"

// Checks the known properties of a contact, derives what follows without a fit, lists the missing.
namespace mindahl::contact {

/// @throws InvalidArgument naming the quantity, its value and the rule
void RequireKnown(std::string_view quantity, const std::optional<UncertainValue>& known);

/// @throws InvalidArgument likewise, for any member
void RequireKnown(const KnownContact& known);

/// Checks a fitted value: its standard error is infinite where the fit does not determine it.
/// @throws InvalidArgument likewise
void RequireFitted(std::string_view quantity, std::string_view unit,
                   const UncertainValue& estimate);

/// Returns a quantity that the caller has found to be known.
template <typename Value>
const Value& Present(const std::optional<Value>& quantity) {
  if (!quantity) throw std::logic_error("a quantity of the contact that is needed is not known");
  return *quantity;
}

/// True if E and ν are known.
inline bool IsElastic(const KnownBody& body) { return body.youngs_modulus && body.poisson_ratio; }

/// Returns 1/E* = Σ (1 − ν²)/E, of bodies whose E and ν are known.
Quantity EffectiveModulusOf(const KnownContact& known);

/// Returns G* = Σ 2(2 − ν)(1 + ν)/E, likewise.
Quantity TangentialComplianceOf(const KnownContact& known);

/// Returns 1/ρ = 1/R₁ + 1/R₂; a plane changes nothing.
Quantity EquivalentRadiusOf(const UncertainValue& radius_1, const UncertainValue& radius_2);

// Names the missing elastic constants, in words: "the radius of body 1".
std::vector<std::string> MissingElasticConstants(const KnownContact& known);
std::vector<std::string> MissingRadii(const KnownContact& known);

}  // namespace mindahl::contact
