#pragma once

#include <span>

#include "identification/gram/omitted_terms.h"
#include "identification/inference/estimates.h"
#include "identification/problem/problem.h"
#include "mindahl/identification/fit_result.h"
#include "mindahl/loop/preparation.h"
#include "mindahl/models/branch_law.h"

/// Extends the interval of a parameter beyond that of noise alone: by other laws that the record
/// does not exclude, and by what the model misses. Such an error does not average out, however many
/// samples there are, and its size is that of the record.
namespace mindahl::identification {

/// Includes a law that the record does not exclude: a closed interval of σ or Tc is extended by
/// itself times the ratio of the values, an open one and that of α to the other value.
void IncludeLaw(const models::BranchLaw& law, ParameterEstimates& parameters);

/// Extends intervals by those of Mindlin's contact in a compliant rig, where the record does not
/// distinguish it: a rig makes a loop more angular, as a smaller α than Mindlin's does. A contact
/// far stiffer than its rig is Jenkins' element, the same curve with no other α: it is left out.
/// @returns `shape_or_rig`; nothing where a rig does not restore 1/3 or is there already
std::vector<Finding> IncludeCompliantRig(const Estimates& fitted, ParameterEstimates& parameters);

/// Includes what steps of the readings may hide. Of the force: half of one, where no noise makes it
/// dither; branches whose α differ by 0.05 are no more than 1 % of Tc apart. Of the displacement: a
/// step over the amplitude, in σ and by as much in α: where each cycle is sampled at the same
/// places, the errors of the encoder repeat and do not average out.
void CoverSteps(const loop::PreparedRecords& records, FitResult& result);

/// Extends intervals to what they are with γ integrated out, and to where each cause leads, which
/// alone may be what is omitted. The error counts twice: a step to first order goes a part of the
/// way to a law of another form.
void WidenByOmittedTerms(const Problem& problem, const Solution& solution, const AdequacyTest& test,
                         double quantile, std::span<ParameterEstimate> estimates);

/// Makes intervals cover the model discrepancy. That of σ includes the stiffness after reversals.
/// If the measured loop reaches slip, the interval of Tc is replaced by the union of three parts:
/// the fitted value; the measured half gap with a margin on both sides; and the previous interval,
/// clamped to the range of half gap, T* and value with the same margin. Of a loop that slips at its
/// ends alone, and a model that misses little, T* takes the place of the half gap, and no lower end
/// is raised. The margin combines the scatter of the cycles' half gaps with the force that the
/// model misses. Closed intervals are marked as including the discrepancy; open ones, but
/// Tc's, do not change.
void CoverDiscrepancy(const Estimates& fitted, FitResult& result);

/// Raises the lower limit of Tc, of an interval that is open above, to the force that the contact
/// carries: T*, where no force beside the contact's is fitted; the half gap of a doubtful model.
void KeepAboveCarriedForce(const Parameters& fitted, FitResult& result);

}  // namespace mindahl::identification
