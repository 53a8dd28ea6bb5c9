#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mindahl/contact/mindlin_dahl_mapping.h"

namespace mindahl::contact {

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
