#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "mindahl/contact/mindlin_dahl_mapping.h"
#include "mindahl/identification/fit.h"
#include "mindahl/loop/record.h"
#include "mindahl/models/branch_law.h"

namespace mindahl::report {

/// Returns the correlation of the errors of two parameters of a fit; 0 where the fit does not say.
double Correlation(const identification::FitResult& fit, std::string_view first,
                   std::string_view second);

/// Identifies the contact of a fit, with its errors and their correlation, and by the rules that
/// keep it from stating what the record does not determine:
///  - errors are those of the parameters' intervals, FitResult::ErrorOf(): a parameter that was
///    held is exact, one that the record leaves open has an infinite error;
///  - no μ from a slip force that is not identifiable: `unidentified` then has the lower limit;
///  - no ρ and no p₀ from a load series that denies Hertz's law.
/// @param fit  one that did not fail
/// @throws InvalidArgument as IdentifyContact()
contact::IdentifiedContact IdentifyFittedContact(const identification::FitResult& fit,
                                                 const contact::KnownContact& known);

/// Identifies the contact by a law that was not fitted, with the same relative errors of σ and Tc.
/// @throws InvalidArgument as IdentifyContact()
contact::IdentifiedContact IdentifyContactOf(const identification::FitResult& fit,
                                             const models::BranchLaw& law,
                                             const contact::KnownContact& known);

/// Returns why μ is withheld though the normal load is known: the slip force is not identifiable.
/// Empty where it is not withheld.
std::optional<std::string> WhyFrictionIsWithheld(const identification::FitResult& fit,
                                                 const contact::KnownContact& known);

/// Returns the mean measured normal load [N], which a steady test keeps to: of the samples in the
/// window where there is one. Empty where a record has no load or no sample counts.
std::optional<double> MeanNormalLoad(std::span<const loop::Record> records,
                                     const std::optional<identification::Interval>& window = {});

}  // namespace mindahl::report
