#include "mindahl/report/loop_description.h"

#include <algorithm>
#include <cmath>

#include "mindahl/contact/cattaneo_mindlin.h"
#include "mindahl/models/branch_law.h"
#include "mindahl/models/steady_loop.h"

namespace mindahl::report {

double ContactAmplitude(const identification::FitResult& fit, double amplitude) {
  if (std::isinf(fit.rig.stiffness)) return amplitude;
  // X − T*(X_c)/k_r falls in X_c.
  double low = 0.0;
  double high = amplitude;
  constexpr int kBisections = 200;
  for (int i = 0; i < kBisections && high - low > 1e-15 * amplitude; ++i) {
    const double middle = low + (high - low) / 2;
    const double whole =
        middle + models::SteadyPeakForce(*fit.model, fit.law, middle) / fit.rig.stiffness;
    (whole < amplitude ? low : high) = middle;
  }
  return low + (high - low) / 2;
}

LoopDescription DescribeLoop(const identification::FitResult& fit) {
  const models::BranchLaw& law = fit.law;
  const loop::LoopMeasures& measures = fit.WidestRecord().measures;
  LoopDescription loop;
  loop.contact_amplitude = ContactAmplitude(fit, measures.amplitude);
  loop.model_energy = models::SteadyLoopEnergy(*fit.model, law, loop.contact_amplitude);
  const double energy = measures.energy_per_cycle.value_or(loop.model_energy);
  if (measures.amplitude > 0 && measures.peak_force > 0) {
    loop.energy_ratio = energy / (4 * measures.amplitude * measures.peak_force);
  }
  const double gross_slip = GrossSlipDisplacement(law);
  if (std::isfinite(gross_slip)) loop.gross_slip_displacement = gross_slip;
  const double peak = models::SteadyPeakForce(*fit.model, law, loop.contact_amplitude);
  loop.slip_force_share = peak / law.slip_force;
  const bool slips = std::isfinite(gross_slip) ? loop.contact_amplitude >= gross_slip
                                               : peak >= kAsGoodAsSlip * law.slip_force;
  loop.regime = slips ? SlipRegime::kGross : SlipRegime::kPartial;
  loop.stick_radius_ratio =
      slips ? 0.0 : contact::StickRadiusRatio(std::min(peak, law.slip_force), law.slip_force);
  return loop;
}

}  // namespace mindahl::report
