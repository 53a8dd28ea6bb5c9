// One cycle after another from a stream: samples arrive piece by piece, as from a rig that runs,
// and every cycle is fitted as soon as it is complete, from where the last one ended. The friction
// of this contact falls; memory stays that of a cycle.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <random>
#include <vector>

#include "mindahl/campaign/cycle_fit.h"
#include "mindahl/campaign/cycle_splitter.h"
#include "mindahl/loop/record.h"
#include "mindahl/models/branch_law.h"
#include "mindahl/models/contact_state.h"
#include "mindahl/models/excitation.h"
#include "mindahl/models/friction_model.h"

namespace {

using namespace mindahl;

constexpr models::BranchLaw kLaw{
    .tangential_stiffness = 4e7, .shape_exponent = 1.0 / 3, .slip_force = 40.0};
constexpr int kCycles = 12;
constexpr std::size_t kSamplesPerCycle = 200;
constexpr std::size_t kPiece = 64;           // samples that arrive at once
constexpr double kAmplitude = 2e-6;          // [m]
constexpr double kNoise = 0.05;              // [N] of a reading
constexpr double kSensorNoise = 1e-10;       // [m], what is no turning point
constexpr double kLossPerCycle = 0.02;       // of the slip force
constexpr double kMostStandardErrors = 5.4;  // of noise alone one in 10 million is farther off

/// A contact whose slip force falls from one turning point of the motion to the next but one.
class Rig {
 public:
  /// The next samples; none at the end.
  loop::Record Read() {
    loop::Record piece;
    for (; piece.size() < kPiece && next_ < motion_.size(); ++next_) {
      // A quarter of a period after its zeros the motion turns: there a cycle begins.
      if (next_ % kSamplesPerCycle == kSamplesPerCycle / 4) Wear();
      piece.displacement.push_back(motion_[next_]);
      piece.force.push_back(contact_.Move(motion_[next_]) + noise_(generator_));
    }
    return piece;
  }

  /// [N] of the cycles from the first turning point on.
  [[nodiscard]] const std::vector<double>& slip_forces() const { return slip_forces_; }

 private:
  void Wear() {
    models::BranchLaw law = kLaw;
    law.slip_force *= std::pow(1 - kLossPerCycle, static_cast<double>(slip_forces_.size()));
    law.tangential_stiffness *= law.slip_force / kLaw.slip_force;
    slip_forces_.push_back(law.slip_force);
    contact_ = models::ContactState(*models::FindFrictionModel("mindlin-dahl"), law);
    // Slipping already: its memory is that of the last stroke, in whichever state it began.
    for (const double x : {-kAmplitude, kAmplitude}) contact_.Move(x);
  }

  std::vector<double> motion_ =
      models::MakeExcitation(
          {.amplitude = kAmplitude, .cycles = kCycles, .samples_per_cycle = kSamplesPerCycle})
          .displacement;
  models::ContactState contact_{*models::FindFrictionModel("mindlin-dahl"), kLaw};
  std::mt19937 generator_{1};
  std::normal_distribution<double> noise_{0.0, kNoise};
  std::vector<double> slip_forces_;
  std::size_t next_ = 0;
};

}  // namespace

int main() {
  Rig rig;
  campaign::CycleSplitter splitter(kSensorNoise);
  campaign::CycleFitter fitter({.preparation = {.reversal_gate = kSensorNoise}});
  std::vector<campaign::Cycle> complete;
  std::vector<std::size_t> lines;  // numbers of the samples, as lines of a file
  std::size_t fitted = 0;
  bool agrees = true;
  std::printf("%5s %14s %12s %12s %9s\n", "cycle", "sigma [N/m]", "alpha", "Tc [N]", "truth");
  for (loop::Record piece = rig.Read(); piece.size() > 0; piece = rig.Read()) {
    const std::size_t first = lines.empty() ? 0 : lines.back() + 1;
    lines.resize(piece.size());
    std::iota(lines.begin(), lines.end(), first);
    complete.clear();
    splitter.Add(piece, lines, complete);
    for (const campaign::Cycle& cycle : complete) {
      const campaign::CycleFit fit = fitter.Fit(cycle);
      if (!fit.flags.empty() || !fit["slip_force"]) return 1;
      const double truth = rig.slip_forces()[fit.number - 1];
      std::printf("%5zu %14.6g %12.5f %6.3f ± %-5.2g %8.3f\n", fit.number, *fit["sigma"],
                  *fit["alpha"], *fit["slip_force"], *fit["slip_force_error"], truth);
      agrees = agrees && std::abs(*fit["slip_force"] - truth) <=
                             kMostStandardErrors * *fit["slip_force_error"];
      ++fitted;
    }
  }
  // From the first turning point to the last are a cycle less than there are.
  return agrees && fitted == kCycles - 1 ? 0 : 1;
}
