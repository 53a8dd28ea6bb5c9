#include "mindahl/contact/cattaneo_mindlin.h"
#include "mindahl/contact/mindlin_dahl_mapping.h"
#include "recovery/recovered.h"
#include "support/prelude.h"

// Mindlin's contact comes back from loops by his own equations, on every scale.
namespace mindahl::identification::mindlin_source_test {
namespace {

using namespace contact;
using namespace loop;
using namespace models;

/// Mindlin's equations 13 to 15, phase by phase: from 0 upwards on the virgin curve, then unloading
/// and reloading.
Record LoopOf(const MindlinContact& contact, Wave wave, double lambda, double cycles,
              int samples_per_cycle, double direction) {
  const double amplitude = lambda * GrossSlipDisplacement(contact);
  Record record;
  record.displacement = Cycling(wave, amplitude, cycles, samples_per_cycle);
  for (std::size_t i = 0; i < record.displacement.size(); ++i) {
    const double x = record.displacement[i];
    const double phase = static_cast<double>(i) / samples_per_cycle;
    const bool unloads = std::fmod(phase - 0.25, 1.0) < 0.5;
    record.force.push_back(phase <= 0.25 ? MindlinVirginForce(contact, x)
                           : unloads     ? MindlinUnloadingForce(contact, x, amplitude)
                                         : MindlinReloadingForce(contact, x, amplitude));
  }
  return testing::Scaled(record, direction, direction);
}

TEST(MindlinSource, EquationsForAnImposedDisplacementReturnTheContact) {
  // The contact of the paper's section 3, a rounded.
  constexpr MindlinContact kContact{2.7e-3, 4.42e-11, 2500.0};
  for (const double lambda : {0.5, 0.8, 1.0, 1.05, 3.0}) {
    for (const double cycles : {1.0, 1.25, 2.6}) {
      for (const double direction : {1.0, -1.0}) {
        for (const Wave wave : {Wave::kSine, Wave::kTriangle}) {
          SCOPED_TRACE(::testing::Message() << lambda << ", " << cycles << " cycles " << direction);
          const int samples_per_cycle = wave == Wave::kSine ? 200 : 60;
          EXPECT_TRUE(
              Recovers(FitOne(LoopOf(kContact, wave, lambda, cycles, samples_per_cycle, direction)),
                       MapMindlinToDahl(kContact), kNoiseFree));
        }
      }
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
      EXPECT_TRUE(Recovers(FitOne(LoopOf(contact, Wave::kSine, lambda, 2.0, 100, -1.0)),
                           MapMindlinToDahl(contact), kNoiseFree));
    }
  }
}

}  // namespace
}  // namespace mindahl::identification::mindlin_source_test
