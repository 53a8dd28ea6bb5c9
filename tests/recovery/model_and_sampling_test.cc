// Every identifiable model, and every way in which a correct record may be cut, shifted, mirrored
// or sampled.

#include "mindahl/contact/cattaneo_mindlin.h"
#include "mindahl/contact/mindlin_dahl_mapping.h"
#include "recovery/recovered.h"
#include "support/prelude.h"

namespace mindahl::identification::model_and_sampling_test {
namespace {

// Elastic limit Tc/σ of one micrometre.
constexpr double kElasticLimit = 1e-6;

BranchLaw LawWith(double shape_exponent) { return {4e7, shape_exponent, 40.0}; }

Record RecordOf(const char* model, const BranchLaw& law, const History& displacement,
                const InitialContact& initial = {}) {
  return MakeRecord(displacement, Respond(Model(model), law, displacement, initial));
}

struct ModelCase {
  const char* model;
  double shape_exponent;
};

const std::vector<ModelCase> kModelCases = {{"jenkins", 0.0},
                                            {"mindlin", 1.0 / 3},
                                            {"mindlin-dahl", 0.0},
                                            {"mindlin-dahl", 0.1},
                                            {"mindlin-dahl", 1.0 / 3},
                                            {"mindlin-dahl", 0.7},
                                            {"mindlin-dahl", 1.0},
                                            {"mindlin-dahl", 2.0},
                                            {"mindlin-dahl", 3.0},
                                            {"dahl", 0.1},
                                            {"dahl", 1.0 / 3},
                                            {"dahl", 0.7},
                                            {"dahl", 1.0},
                                            {"dahl", 2.0},
                                            {"dahl", 3.0}};

/// Amplitudes that bend the loop whatever α: from half to three times δc where that is finite.
std::vector<double> Reaches(const ModelCase& c) {
  const double limit = c.shape_exponent < 0.9 ? 1 / (1 - c.shape_exponent) : 4.0;
  // Below gross slip Jenkins' element is a plain spring.
  return c.shape_exponent == 0 ? std::vector{1.2 * limit, 3 * limit}
                               : std::vector{0.5 * limit, 0.9 * limit, 1.5 * limit, 3 * limit};
}

TEST(ModelRecovery, VirginLoopsOfEveryModelReturnItsParameters) {
  for (const ModelCase& c : kModelCases) {
    for (const double reach : Reaches(c)) {
      for (const double direction : {1.0, -1.0}) {
        SCOPED_TRACE(::testing::Message() << c.model << ", alpha " << c.shape_exponent << ", reach "
                                          << reach << ", direction " << direction);
        const History displacement =
            Cycling(Wave::kSine, direction * reach * kElasticLimit, 2.25, 160);
        const BranchLaw law = LawWith(c.shape_exponent);
        const FitResult fit = FitOne(RecordOf(c.model, law, displacement), OfModel(c.model));
        EXPECT_TRUE(Recovers(fit, law, kNoiseFree));
      }
    }
  }
}

TEST(ModelRecovery, JenkinsLoopJustBeyondSlipIsRecovered) {
  // Where none of the samples slips the slip force has no effect: a false minimum beside the true
  // one.
  const BranchLaw law = LawWith(0.0);
  for (const double lambda : {1.003, 1.01, 1.02, 1.03, 1.1}) {
    const History displacement = Cycling(Wave::kSine, lambda * kElasticLimit, 2, 200);
    const FitResult fit = FitOne(RecordOf("jenkins", law, displacement), OfModel("jenkins"));
    EXPECT_TRUE(Recovers(fit, law, kNoiseFree)) << lambda;
  }
}

TEST(ModelRecovery, SteadyLoopsOfEveryModelReturnItsParametersFromAnySample) {
  constexpr int kSamples = 160;
  for (const ModelCase& c : kModelCases) {
    for (const double reach : Reaches(c)) {
      const BranchLaw law = LawWith(c.shape_exponent);
      const History displacement = Cycling(Wave::kSine, reach * kElasticLimit, 3.0, kSamples);
      const Record steady = RecordOf(c.model, law, displacement, {.state = InitialState::kSteady});
      // On the way up, at the top, on the way down, at the bottom.
      for (const std::size_t begin : {std::size_t{11}, std::size_t{40}, std::size_t{73},
                                      std::size_t{120}, std::size_t{150}}) {
        SCOPED_TRACE(::testing::Message() << c.model << ", alpha " << c.shape_exponent << ", reach "
                                          << reach << ", from sample " << begin);
        FitOptions options = OfModel(c.model);
        options.initial_state = InitialState::kSteady;
        EXPECT_TRUE(Recovers(FitOne(From(steady, begin), options), law, kNoiseFree));
      }
    }
  }
}

class MasingRecord : public ::testing::Test {
 protected:
  static constexpr double kReach = 2e-6;  // 4/3 of Mindlin's gross slip
  const BranchLaw law_ = LawWith(1.0 / 3);

  Record Loop(const History& displacement) const {
    return RecordOf("mindlin-dahl", law_, displacement);
  }
};

TEST_F(MasingRecord, SteadyLoopOffCentreWithOffsetsInBothChannelsIsRecovered) {
  const Record record = From(Loop(Cycling(Wave::kSine, kReach, 3.0, 200)), 231);
  // An offset of k amplitudes takes log₁₀ k digits off every sample.
  EXPECT_TRUE(Recovers(FitOne(testing::Shifted(record, 30 * kReach, -170.0)), law_, kNoiseFree));
}

TEST_F(MasingRecord, VirginLoopWithOffsetsInBothChannelsIsRecoveredWithTheOffsets) {
  const double displacement_offset = -0.7 * kReach;
  const double force_offset = 12.0;
  const Record record = testing::Shifted(Loop(Cycling(Wave::kSine, kReach, 1.75, 200)),
                                         displacement_offset, force_offset);
  const FitResult fit = FitOne(record);
  EXPECT_TRUE(Recovers(fit, law_, kNoiseFree));
  EXPECT_EQ(fit.initial_state, InitialState::kVirgin);
  EXPECT_NEAR(fit.Find("displacement_offset")->value, displacement_offset, kNoiseFree * kReach);
  EXPECT_NEAR(fit.Find("force_offset")->value, force_offset, kNoiseFree * law_.slip_force);
}

TEST_F(MasingRecord, OppositeForceSignIsFoundAndFollowed) {
  const Record record = testing::Scaled(Loop(Cycling(Wave::kSine, -kReach, 2.0, 200)), 1.0, -1.0);
  const FitResult fit = FitOne(record);
  EXPECT_EQ(fit.force_sense, -1);
  EXPECT_TRUE(Recovers(fit, law_, kNoiseFree));
  for (std::size_t i = 0; i < record.size(); ++i) {
    ASSERT_NEAR(fit.records[0].fitted_force[i], record.force[i], kNoiseFree * law_.slip_force);
  }
}

TEST_F(MasingRecord, UnequalReversalsGrowingAmplitudesAndUnevenSamplesAreRecovered) {
  History nested;
  double last = 0.0;
  // Off centre, an inner loop within an inner loop, one passed, then beyond the first extreme.
  for (const double turn : {1.4, -0.3, 0.8, 0.1, 0.5, 0.3, 1.1, -0.9, 1.9, -0.2}) {
    const int steps = 2 + static_cast<int>(40 * std::abs(turn - last));
    for (int i = 1; i <= steps; ++i) {
      nested.push_back((last + (turn - last) * i / steps) * kElasticLimit);
    }
    last = turn;
  }
  History growing = Cycling(Wave::kSine, 1.0, 4.0, 120);
  for (std::size_t i = 0; i < growing.size(); ++i) {
    growing[i] *= kReach * static_cast<double>(i) / static_cast<double>(growing.size());
  }
  Generator generator(20240611);
  const History fine = Cycling(Wave::kSine, kReach, 3.0, 400);
  History uneven;  // and repeated
  for (std::size_t i = 0; i < fine.size(); ++i) {
    const bool is_extreme = i % 200 == 100;  // otherwise the response to the kept samples differs
    if (!is_extreme && generator() % 4 != 0) continue;
    uneven.push_back(fine[i]);
    while (generator() % 3 == 0) uneven.push_back(fine[i]);
  }
  for (const History& displacement : {nested, growing, uneven}) {
    EXPECT_TRUE(Recovers(FitOne(Loop(displacement)), law_, kNoiseFree));
  }
}

TEST_F(MasingRecord, VirginRecordWhoseFirstRowIsAlreadyLoadedIsRecovered) {
  const Record record = Loop(Cycling(Wave::kSine, kReach, 2.0, 200));
  for (const std::size_t begin : {std::size_t{3}, std::size_t{12}, std::size_t{30}}) {
    SCOPED_TRACE(begin);
    EXPECT_TRUE(Recovers(FitOne(From(record, begin)), law_, kNoiseFree));
  }
}

TEST_F(MasingRecord, FewSamplesInACycleAndExtremesBetweenThemAreEnough) {
  // The samples themselves are the history: the generator turns where the last sample before the
  // extreme lies, as the fit does.
  for (const Wave wave : {Wave::kSine, Wave::kTriangle}) {
    for (const int samples_per_cycle : {8, 12, 13, 20, 50, 90, 201}) {
      for (const double reach : {0.9e-6, kReach}) {
        SCOPED_TRACE(::testing::Message() << samples_per_cycle << " samples, reach " << reach);
        const History displacement = Cycling(wave, reach, 3.0, samples_per_cycle);
        EXPECT_TRUE(Recovers(FitOne(Loop(displacement)), law_, kNoiseFree));
      }
    }
  }
}

// --- units ---------------------------------------------------------------------------------------

// The fit works on scaled numbers; what differs between units is their rounding, magnified by the
// condition of the fit, and on noisy data where the solver stops: |Δcost| < 1e-10·cost leaves
// √1e-10 = 1e-5 standard errors, 1e-3 relative.
constexpr double kUnitInvariance = 1e-6;

TEST(UnitInvariance, MirroredShiftedAndRescaledNoisyRecordsGiveTheSameFit) {
  Generator generator(7);
  const BranchLaw law = LawWith(0.45);
  const Record record =
      testing::WithForceNoise(RecordOf("mindlin-dahl", law, Cycling(Wave::kSine, 3e-6, 2.5, 120)),
                              0.01 * law.slip_force, generator);
  const FitResult reference = FitOne(record);
  ASSERT_TRUE(reference.converged);

  struct Change {
    const char* what;
    double displacement, force, displacement_shift, force_shift;
  };
  for (const Change& change :
       {Change{"micrometres and kilonewtons", 1e6, 1e-3, 0, 0}, Change{"inches", 39.37, 1, 0, 0},
        Change{"atomic", 1e-6, 1e-15, 0, 0}, Change{"tectonic", 1e6, 1e12, 0, 0},
        Change{"mirrored", -1, -1, 0, 0}, Change{"load cell on the other body", 1, -1, 0, 0},
        Change{"shifted", 1, 1, 5e-6, -100}}) {
    SCOPED_TRACE(change.what);
    const FitResult fit =
        FitOne(testing::Shifted(testing::Scaled(record, change.displacement, change.force),
                                change.displacement_shift, change.force_shift));
    const double stiffness = std::abs(change.force / change.displacement);
    const BranchLaw expected = {reference.law.tangential_stiffness * stiffness,
                                reference.law.shape_exponent,
                                reference.law.slip_force * std::abs(change.force)};
    EXPECT_TRUE(Recovers(fit, expected, kUnitInvariance));
    EXPECT_EQ(fit.initial_state, reference.initial_state);
    for (const char* name : {"sigma", "alpha", "slip_force"}) {
      SCOPED_TRACE(name);
      const ParameterEstimate& a = *reference.Find(name);
      const ParameterEstimate& b = *fit.Find(name);
      EXPECT_EQ(a.identifiability, b.identifiability);
      // Standard errors come from profiles of their own, solved as loosely.
      constexpr double kErrorInvariance = 1e-3;
      EXPECT_NEAR(*b.standard_error / b.value / (*a.standard_error / a.value), 1.0,
                  kErrorInvariance);
    }
  }
}

// ---
// Mindlin's contact comes back from loops by his own equations, on every scale.

using namespace contact;

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
}  // namespace mindahl::identification::model_and_sampling_test
