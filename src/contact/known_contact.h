#pragma once

#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "contact/propagation.h"
#include "mindahl/contact/mindlin_dahl_mapping.h"

// What is known of a contact besides a fit: its rules, what follows from it alone, what is missing.
namespace mindahl::contact {

/// @throws InvalidArgument naming the quantity, its value and the rule
void RequireKnown(std::string_view quantity, const std::optional<UncertainValue>& known);

/// @throws InvalidArgument likewise, for any member
void RequireKnown(const KnownContact& known);

/// What a fit gives: its standard error may be infinite, where it leaves the parameter open.
/// @throws InvalidArgument likewise
void RequireFitted(std::string_view quantity, std::string_view unit,
                   const UncertainValue& estimate);

/// What the caller has found to be known.
template <typename Value>
const Value& Present(const std::optional<Value>& quantity) {
  if (!quantity) throw std::logic_error("a quantity of the contact that is needed is not known");
  return *quantity;
}

/// E and ν are known.
inline bool IsElastic(const KnownBody& body) { return body.youngs_modulus && body.poisson_ratio; }

/// 1/E* = Σ (1 − ν²)/E, of bodies whose E and ν are known
Quantity EffectiveModulusOf(const KnownContact& known);

/// G* = Σ 2(2 − ν)(1 + ν)/E, likewise
Quantity TangentialComplianceOf(const KnownContact& known);

/// 1/ρ = 1/R₁ + 1/R₂; a plane changes nothing.
Quantity EquivalentRadiusOf(const UncertainValue& radius_1, const UncertainValue& radius_2);

// What is not known, in words: "the radius of body 1".
std::vector<std::string> MissingElasticConstants(const KnownContact& known);
std::vector<std::string> MissingRadii(const KnownContact& known);

}  // namespace mindahl::contact
