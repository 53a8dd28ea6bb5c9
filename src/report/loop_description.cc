#include "mindahl/report/loop_description.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

#include "mindahl/contact/cattaneo_mindlin.h"
#include "mindahl/identification/fit_result.h"
#include "mindahl/models/branch_law.h"
#include "mindahl/models/steady_loop.h"

namespace mindahl::report {

MeasuredLoop MeasuredLoopOf(const identification::RecordFit& record) {
  const loop::LoopFacts& facts = record.facts;
  if (facts.closed) return {facts.amplitude, facts.peak_force, facts.energy_per_cycle};
  const loop::LoopMeasures& measures = record.measures;
  return {measures.amplitude, measures.peak_force, measures.energy_per_cycle};
}

namespace {

using identification::Identifiability;
using identification::ParameterEstimate;

/// Returns the mean over the cycles that the facts' energy is of; empty without numbers of cycles.
std::optional<double> MeanOfSteadyCycles(const loop::LoopFacts& facts,
                                         std::span<const double> of_cycles) {
  double sum = 0.0;
  double count = 0.0;
  for (std::size_t k = 0; k < of_cycles.size(); ++k) {
    if (!facts.cycles[k].steady) continue;
    sum += of_cycles[k];
    ++count;
  }
  return count > 0 ? std::optional(sum / count) : std::nullopt;
}

bool HasValue(const ParameterEstimate& estimate) {
  return estimate.is_known() || estimate.identifiability == Identifiability::kExtrapolated;
}

}  // namespace

bool SlipsGrossly(const models::FrictionModel& model, const models::BranchLaw& law,
                  double contact_amplitude) {
  const double gross_slip = models::SteadyGrossSlipAmplitude(model, law);
  if (std::isfinite(gross_slip)) return contact_amplitude >= gross_slip;
  return models::SteadyPeakForce(model, law, contact_amplitude) >= kAsGoodAsSlip * law.slip_force;
}

LoopDescription DescribeLoop(const identification::FitResult& fit) {
  const identification::RecordFit& widest = fit.WidestRecord();
  const models::BranchLaw law = fit.LawOf(widest);
  LoopDescription loop;
  loop.measured = MeasuredLoopOf(widest);
  const MeasuredLoop& measured = loop.measured;
  loop.contact_amplitude = identification::ContactAmplitude(fit, law, measured.amplitude);
  loop.model_energy =
      MeanOfSteadyCycles(widest.facts, widest.law_energy)
          .value_or(models::SteadyLoopEnergy(*fit.model, law, loop.contact_amplitude));
  const double energy = measured.energy.value_or(loop.model_energy);
  if (measured.amplitude > 0 && measured.peak_force > 0) {
    loop.energy_ratio = energy / (4 * measured.amplitude * measured.peak_force);
  }
  const double gross_slip = models::SteadyGrossSlipAmplitude(*fit.model, law);
  const auto has_value = [&](const char* name) { return HasValue(*fit.Find(name)); };
  loop.knows_slip = has_value("sigma") && has_value("alpha") && has_value("slip_force");
  if (std::isfinite(gross_slip) && loop.knows_slip) {
    loop.gross_slip_displacement = gross_slip;
    loop.gross_slip_energy_ratio = models::GrossSlipEnergyRatio(*fit.model, law, fit.rig);
  }
  const double peak = models::SteadyPeakForce(*fit.model, law, loop.contact_amplitude);
  loop.slip_force_share = peak / law.slip_force;
  const bool slips_by_law = SlipsGrossly(*fit.model, law, loop.contact_amplitude);
  const bool is_seen_to_slide = loop::Slides(widest.facts);
  if (is_seen_to_slide) {
    loop.sliding_fraction = widest.facts.sliding_fraction;
    if (!slips_by_law) {  // a law that is not there yet at this amplitude contradicts the record
      loop.gross_slip_displacement.reset();
      loop.gross_slip_energy_ratio.reset();
    }
  }
  const bool slips = slips_by_law || is_seen_to_slide;
  // Any slip force above a lower limit of Tc fits as well: by none of these does less slip.
  const ParameterEstimate& slip_force = *fit.Find("slip_force");
  const bool is_bounded = slip_force.identifiability == Identifiability::kBoundedBelow;
  const bool is_open = !HasValue(slip_force) && !(is_bounded && !slips);
  if (is_open && !is_seen_to_slide) return loop;
  loop.regime = slips ? SlipRegime::kGross : SlipRegime::kPartial;
  loop.stick_radius_ratio =
      slips ? 0.0 : contact::StickRadiusRatio(std::min(peak, law.slip_force), law.slip_force);
  return loop;
}

}  // namespace mindahl::report
