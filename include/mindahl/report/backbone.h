#pragma once

#include <string>

#include "mindahl/identification/backbone_estimate.h"
#include "mindahl/report/report.h"

namespace mindahl::report {

/// Returns the backbone as CSV: displacement, force, the ends of its band, and the fitted law.
std::string BackboneCsv(const identification::BackboneEstimate& backbone, const Units& units);

/// Returns the backbone in words, with σ, Tc and α of the fitted law: how stiff it begins, what it
/// carries at the largest displacement, whether it levels off there, and where the law leaves its
/// band. UTF-8, at most 100 columns.
std::string BackboneText(const identification::BackboneEstimate& backbone,
                         const identification::FitResult& fit, const Units& units);

}  // namespace mindahl::report
