
#include <tuple>

#include "contact/printed_equations.h"
#include "mindahl/contact/cattaneo_mindlin.h"
#include "mindahl/contact/mindlin_dahl_mapping.h"
#include "recovery/recovered.h"
#include "support/prelude.h"

// Mindlin's contact must come back from any correct source of its loops: the equations for an
// imposed displacement, those for an imposed force, and an ensemble of spring-slider elements that
// knows neither.
namespace mindahl::identification::mindlin_source_test {
namespace {

using namespace contact;
using namespace loop;
using namespace models;

// The contact of the paper's section 3, a rounded.
constexpr MindlinContact kContact{
    .contact_radius = 2.7e-3, .tangential_compliance = 4.42e-11, .slip_force = 2500.0};

/// 0 on the virgin curve, then 1 unloading, 2 reloading, 1, … for a wave from 0 upwards.
int PhaseOf(double cycles) {
  if (cycles <= 0.25) return 0;
  return std::fmod(cycles - 0.25, 1.0) < 0.5 ? 1 : 2;
}

/// Mindlin's equations 13 to 15, phase by phase.
Record DisplacementControlled(const MindlinContact& contact, Wave wave, double amplitude,
                              double cycles, int samples_per_cycle, double direction) {
  Record record;
  record.displacement = Cycling(wave, amplitude, cycles, samples_per_cycle);
  for (std::size_t i = 0; i < record.displacement.size(); ++i) {
    const double x = record.displacement[i];
    switch (PhaseOf(static_cast<double>(i) / samples_per_cycle)) {
      case 0:
        record.force.push_back(MindlinVirginForce(contact, x));
        break;
      case 1:
        record.force.push_back(MindlinUnloadingForce(contact, x, amplitude));
        break;
      default:
        record.force.push_back(MindlinReloadingForce(contact, x, amplitude));
    }
  }
  return testing::Scaled(record, direction, direction);
}

/// Equations 6, 8 and 9: the force is imposed and the displacement follows.
Record ForceControlled(const MindlinContact& contact, Wave wave, double peak, double cycles,
                       int samples_per_cycle, double direction) {
  Record record;
  record.force = Cycling(wave, peak, cycles, samples_per_cycle);
  const printed::Contact exact(contact);
  for (std::size_t i = 0; i < record.force.size(); ++i) {
    const double force = record.force[i];
    switch (PhaseOf(static_cast<double>(i) / samples_per_cycle)) {
      case 0:
        record.displacement.push_back(static_cast<double>(exact.VirginDisplacement(force)));
        break;
      case 1:
        record.displacement.push_back(
            static_cast<double>(exact.UnloadingDisplacement(force, peak)));
        break;
      default:
        record.displacement.push_back(
            static_cast<double>(exact.ReloadingDisplacement(force, peak)));
    }
  }
  return testing::Scaled(record, direction, direction);
}

/// Spring-slider elements in parallel, each advanced on its own from the last state: its only
/// knowledge of the contact is the stiffness still sticking at each displacement of first loading.
class JenkinsEnsemble {
 public:
  /// `elements` knots at z = 1 − x/δc = (1 − k/n)², which crowd where the curve bends.
  JenkinsEnsemble(const MindlinContact& contact, int elements) {
    const double reach = GrossSlipDisplacement(contact);
    double last_x = 0.0;
    double last_force = 0.0;
    std::vector<double> chord;
    for (int k = 1; k <= elements; ++k) {
      const double root = 1 - static_cast<double>(k) / elements;
      const double x = reach * (1 - root * root);
      const double force = contact.slip_force * (1 - root * root * root);
      slip_at_.push_back(x);
      chord.push_back((force - last_force) / (x - last_x));
      last_x = x;
      last_force = force;
    }
    for (std::size_t k = 0; k < chord.size(); ++k) {
      stiffness_.push_back(chord[k] - (k + 1 < chord.size() ? chord[k + 1] : 0.0));
    }
    stretch_.assign(stiffness_.size(), 0.0);
  }

  double MoveTo(double displacement) {
    double force = 0.0;
    for (std::size_t k = 0; k < stretch_.size(); ++k) {
      stretch_[k] =
          std::clamp(stretch_[k] + displacement - displacement_, -slip_at_[k], slip_at_[k]);
      force += stiffness_[k] * stretch_[k];
    }
    displacement_ = displacement;
    return force;
  }

 private:
  std::vector<double> slip_at_;
  std::vector<double> stiffness_;
  std::vector<double> stretch_;
  double displacement_ = 0.0;
};

struct Drive {
  double lambda;
  double cycles;
  double direction;
  Wave wave;
};

std::vector<Drive> Drives(const std::vector<double>& lambdas) {
  std::vector<Drive> drives;
  for (const double lambda : lambdas) {
    for (const double cycles : {1.0, 1.25, 2.0, 2.6, 4.0}) {
      for (const double direction : {1.0, -1.0}) {
        for (const Wave wave : {Wave::kSine, Wave::kTriangle}) {
          drives.push_back({lambda, cycles, direction, wave});
        }
      }
    }
  }
  return drives;
}

::testing::Message Describe(const Drive& drive) {
  return ::testing::Message() << "lambda " << drive.lambda << ", " << drive.cycles << " cycles, "
                              << (drive.wave == Wave::kSine ? "sine" : "triangle")
                              << (drive.direction > 0 ? " up" : " down");
}

TEST(MindlinSource, EquationsForAnImposedDisplacementReturnTheContact) {
  for (const Drive& drive : Drives({0.5, 0.65, 0.8, 0.95, 1.0, 1.05, 1.3, 2.0, 3.0})) {
    SCOPED_TRACE(Describe(drive));
    const double amplitude = drive.lambda * GrossSlipDisplacement(kContact);
    for (const int samples_per_cycle : {drive.wave == Wave::kSine ? 200 : 60}) {
      const Record record = DisplacementControlled(kContact, drive.wave, amplitude, drive.cycles,
                                                   samples_per_cycle, drive.direction);
      EXPECT_TRUE(Recovers(FitOne(record), MapMindlinToDahl(kContact), kNoiseFree));
    }
  }
}

TEST(MindlinSource, EquationsForAnImposedForceReturnTheContact) {
  // Force control cannot slip grossly: λ = 1 − (1 − T*/Tc)^{2/3} stays below 1.
  for (const Drive& drive : Drives({0.5, 0.65, 0.8, 0.95, 1.0})) {
    SCOPED_TRACE(Describe(drive));
    const double peak =
        MindlinVirginForce(kContact, drive.lambda * GrossSlipDisplacement(kContact));
    for (const int samples_per_cycle : {drive.wave == Wave::kSine ? 200 : 60}) {
      const Record record = ForceControlled(kContact, drive.wave, peak, drive.cycles,
                                            samples_per_cycle, drive.direction);
      EXPECT_TRUE(Recovers(FitOne(record), MapMindlinToDahl(kContact), kNoiseFree));
    }
  }
}

TEST(MindlinSource, EnsembleOfJenkinsElementsReturnsTheContactWithinItsDiscretisation) {
  constexpr int kElements = 2000;
  // The ensemble's first loading is the chord polygon of Mindlin's curve. With s = √z and h = 1/n
  // the chord lies below it by at most (Δx)²/8·|f''| = (2shδc)²/8 · σ/(2δc·s) = 3/8·s·h²·Tc, and a
  // branch, twice the curve at half the size, by twice that.
  constexpr double kForceError = 0.75 / kElements / kElements;
  // A coarser promise that does not rest on the fit's own covariance.
  constexpr double kCoarse = 1e-4;
  for (const double lambda : {0.5, 0.8, 1.2, 3.0}) {
    for (const double direction : {1.0, -1.0}) {
      SCOPED_TRACE(::testing::Message() << "lambda " << lambda << ", direction " << direction);
      History displacement =
          Cycling(Wave::kSine, lambda * GrossSlipDisplacement(kContact), 1.75, 200);
      JenkinsEnsemble ensemble(kContact, kElements);
      std::vector<double> force;
      for (double& x : displacement) {
        x *= direction;
        force.push_back(ensemble.MoveTo(x));
      }
      FitOptions options;
      options.force_noise = kForceError * kContact.slip_force;
      const FitResult fit = FitOne(MakeRecord(displacement, force), options);
      EXPECT_TRUE(Recovers(fit, MapMindlinToDahl(kContact), kCoarse));
      // By Cauchy and Schwarz an error of at most ε a sample moves a parameter by at most √n times
      // the standard error that noise of that size would give it.
      const double reach = std::sqrt(static_cast<double>(displacement.size()));
      const BranchLaw truth = MapMindlinToDahl(kContact);
      const auto expect_near = [&](const char* name, double value) {
        const ParameterEstimate& estimate = *fit.Find(name);
        ASSERT_TRUE(estimate.standard_error) << name;
        EXPECT_NEAR(estimate.value, value, reach * *estimate.standard_error) << name;
      };
      expect_near("sigma", truth.tangential_stiffness);
      expect_near("alpha", truth.shape_exponent);
      expect_near("slip_force", truth.slip_force);
    }
  }
}

TEST(MindlinSource, ContactsFromAtomicToTectonicScaleAreAllTheSameToTheFit) {
  // a, G*, Tc: an atomic-force tip, a fretting contact, a rough joint, a fault.
  const std::vector<MindlinContact> contacts = {{1e-9, 1e-10, 1e-15},
                                                {2e-9, 5e-11, 3e-9},
                                                {1e-4, 4e-11, 12.0},
                                                {0.3, 1e-10, 4e6},
                                                {1e5, 3e-11, 1e12}};
  for (const MindlinContact& contact : contacts) {
    for (const double lambda : {0.6, 1.5}) {
      SCOPED_TRACE(::testing::Message() << "Tc " << contact.slip_force << ", lambda " << lambda);
      const Record record = DisplacementControlled(
          contact, Wave::kSine, lambda * GrossSlipDisplacement(contact), 2.0, 100, -1.0);
      EXPECT_TRUE(Recovers(FitOne(record), MapMindlinToDahl(contact), kNoiseFree));
    }
  }
}

}  // namespace
}  // namespace mindahl::identification::mindlin_source_test
