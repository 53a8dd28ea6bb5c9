#include "mindahl/identification/thresholds.h"

#include <map>

#include "identification/diagnosis/adequacy.h"
#include "identification/diagnosis/diagnosis.h"
#include "identification/diagnosis/grade.h"
#include "identification/diagnosis/record_findings.h"
#include "identification/inference/estimates.h"
#include "identification/inference/law_tests.h"
#include "identification/inference/noise.h"
#include "identification/inference/profile.h"
#include "identification/inference/turning_point_test.h"
#include "identification/stages.h"
#include "mindahl/identification/model_selection.h"
#include "mindahl/models/steady_loop.h"
#include "support/prelude.h"

// What each threshold decides: a case a row, whose expectations are written for the value that the
// row states, and which no longer hold when it is twice or half of it.
namespace mindahl::identification::thresholds_test {
namespace {

using namespace loop;
using namespace models;

constexpr BranchLaw kMindlin{4e7, 1.0 / 3, 40.0};
constexpr double kGrossSlip = 1.5e-6;  // [m]
/// What is tested lies this much to either side of a threshold.
constexpr double kBelow = 0.75;
constexpr double kAbove = 1.33;

Record LoopOf(const BranchLaw& law, const History& displacement) {
  return MakeRecord(displacement, Respond(Model("mindlin-dahl"), law, displacement));
}

FitOptions With(const Thresholds& thresholds) {
  FitOptions options;
  options.thresholds = thresholds;
  return options;
}

// --- diagnosis: pure functions of a result made by hand

/// At gross slip.
FitResult Made() { return testing::MadeFit(/*peak_force=*/20.0); }

Use UseAt(const Thresholds& thresholds, double misfit) {
  FitResult result = Made();
  result.adequacy.misfit = misfit * result.PeakForce();
  return GradeUse(thresholds, result).use;
}

std::string MisfitOf(const Thresholds& thresholds, double misfit, double share) {
  FitResult result = Made();
  result.residuals.rms = misfit * result.PeakForce();
  result.records[0].structure.repeatable_share = share;
  const auto finding = FindMisfit(result, thresholds);
  return finding ? std::string(finding->code) : "none";
}

/// The kind of a misfit whose directions correlate so over the same displacement, or over the same
/// part of the stroke; its largest mean is where it is said to be.
std::string KindOf(const Thresholds& thresholds, double at_same_displacement, double in_stroke,
                   double position) {
  FitResult result = Made();
  result.residuals.rms = 0.5;
  ResidualStructure& structure = result.records[0].structure;
  structure.repeatable_share = 0.9;
  structure.directions[0].bins = {{position, 1.0, 0}, {0.9, 0, 0}, {0.9, 0, 0}, {0.9, 0, 0}};
  structure.directions[1].direction = -1;
  structure.directions[1].bins = {
      {0.9, in_stroke, 0},
      {0.9, std::sqrt(1 - at_same_displacement * at_same_displacement - in_stroke * in_stroke), 0},
      {0.9, 0, 0},
      {0.9, at_same_displacement, 0}};
  return std::string(FindMisfit(result, thresholds)->kind);
}

bool IsWide(const Thresholds& thresholds, std::size_t parameter, double lower, double upper) {
  FitResult result = Made();
  result.parameters[parameter].lower95 = lower;
  result.parameters[parameter].upper95 = upper;
  return !FindWideIntervals(result, thresholds).empty();
}

bool LoopIsSeen(const Thresholds& thresholds, double r_squared) {
  FitResult result = Made();
  result.residuals.r_squared = r_squared;
  return !FindUnseenLoop(result, thresholds);
}

bool WayIsTooLong(const Thresholds& thresholds, double excess) {
  FitResult result = Made();
  result.records[0].facts.closed = true;
  result.records[0].facts.path_ratio = 1 + excess;
  return !FindInRecords(result.records, thresholds).empty();
}

/// A loop whose measured energy is so much less than the model's, known to so many of its own.
bool EnergyContradicts(const Thresholds& thresholds, double difference, double error) {
  FitResult result = Made();
  result.model = &Model("mindlin-dahl");
  RecordFit& record = result.records[0];
  record.counts.assign(10, 1);
  record.facts.amplitude = 1e-6;
  const double energy = SteadyLoopEnergy(*result.model, result.law, 1e-6);
  record.facts.cycles.resize(1);
  record.facts.cycles[0].energy = (1 - difference) * energy;
  record.facts.cycles[0].steady = true;
  result.residuals.effective_samples = 100;
  result.force_noise = error * energy * 10 / 4e-6;
  return FindEnergyContradiction(result, thresholds).has_value();
}

/// A law of α = 1 whose asymptote the loop reaches to a share.
bool IsExtrapolated(const Thresholds& thresholds, double share) {
  FitResult result = Made();
  result.law.shape_exponent = 1.0;
  result.parameters[kSlipForce].lower95 = 0.9 * result.parameters[kSlipForce].value;
  result.parameters[kSlipForce].upper95 = 1.1 * result.parameters[kSlipForce].value;
  result.records[0].measures.peak_force = share * result.parameters[kSlipForce].value;
  return FindExtrapolated(result, thresholds).has_value();
}

/// A prior of α so many standard deviations off, which prior and record make in equal parts.
bool PriorIsContradicted(const Thresholds& thresholds, double distance) {
  FitResult result = Made();
  ParameterEstimate& alpha = result.parameters[kShape];
  constexpr double kError = 0.01;
  alpha.without_priors = {alpha.value, kError};
  alpha.prior = {alpha.value + distance * std::numbers::sqrt2 * kError, kError};
  return FindContradictedPrior(result, thresholds).has_value();
}

// --- tests and profiles on stages

/// A rig tried for a loop of another shape, at a chance and a variance of the noise given by hand.
bool RigIsFound(const Thresholds& thresholds, const Record& record, double p_value,
                double variance) {
  Stages stages(record, With(thresholds));
  const Solution best = stages.Solve();
  const Noise noise = KnownNoise(variance, stages.data.counted);
  const Estimates estimates(stages.problem, best, noise, {}, thresholds, stages.buffers.response);
  ThinnedRecords thin(stages.data, Stages::Memory());
  return TryRig({stages.problem, best, noise, estimates}, thin, MindlinTest{0.0, p_value, {}},
                stages.options, stages.buffers)
      .has_value();
}

// --- whole fits

/// A fit that only evaluates: its residuals are what was added to the model's force.
FitResult Evaluated(const Thresholds& thresholds, const History& displacement,
                    const std::vector<double>& added) {
  Record record = LoopOf(kMindlin, displacement);
  for (std::size_t i = 0; i < added.size(); ++i) record.force[i] -= added[i];
  FitOptions options = With(thresholds);
  options.initial_state = InitialState::kVirgin;
  options.fixed = {{"sigma", kMindlin.tangential_stiffness},
                   {"alpha", kMindlin.shape_exponent},
                   {"slip_force", kMindlin.slip_force},
                   {"force_offset", 0.0},
                   {"displacement_offset", 0.0}};
  std::vector<RecordView> views = {record};
  return Fitter(options).Fit(views, Depth::kIntervals);
}

AdequacyTest TestWith(std::vector<DepartureFit> fits, double p_value = 1.0) {
  AdequacyTest test;
  test.p_value = p_value;
  test.fits = std::move(fits);
  return test;
}

constexpr std::size_t kSamplesAStroke = 50;

/// Two strokes whose residuals are a fifth of the force.
FitResult TwoStrokes(double durbin_watson) {
  FitResult result;
  result.law = {1.0, 1.0 / 3, 10.0};
  RecordFit& record = result.records.emplace_back();
  record.residual.resize(2 * kSamplesAStroke);
  record.reversals.resize(1);
  record.measures.peak_force = 10.0;
  result.residuals.rms = 2.0;
  result.residuals.durbin_watson = durbin_watson;
  return result;
}

/// True if residuals whose correlation decays to 1/e over so many strokes are reported.
bool IsSlow(const Thresholds& thresholds, double strokes) {
  const double decay = std::exp(-1 / (strokes * static_cast<double>(kSamplesAStroke)));
  return FindSlowResiduals(TwoStrokes(2 - 2 * decay), thresholds).has_value();
}

/// Whether residuals of such a chance are doubted.
bool IsDoubted(const Thresholds& thresholds, double chance) {
  return IsDoubtful(TestWith({}, chance), thresholds);
}

DepartureFit FitWith(double p_value, double delta_aicc) {
  DepartureFit fit;
  fit.p_value = p_value;
  fit.delta_aicc = delta_aicc;
  return fit;
}

std::size_t CausesAmong(const Thresholds& thresholds, std::vector<DepartureFit> fits) {
  return CausesOf(TestWith(std::move(fits)), thresholds).size();
}

/// Whether everything is as the stated value of the threshold makes it.
using Case = std::function<bool(const Thresholds&)>;

// --- normal loads

bool IsLoadSeries(const Thresholds& thresholds, double difference) {
  FitOptions options = With(thresholds);
  options.normal_loads = {100.0, 100.0 * (1 + difference)};
  const Record loop = LoopOf(kMindlin, Cycling(Wave::kSine, kGrossSlip, 1.0, 40));
  return Stages(std::vector<Record>{loop, loop}, options).data.is_load_series;
}

bool LoadIsFollowed(const Thresholds& thresholds, double amplitude) {
  Record loop = LoopOf(kMindlin, Cycling(Wave::kSine, kGrossSlip, 1.0, 40));
  loop.displacement.pop_back();  // whole cycles of the load
  loop.force.pop_back();
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const double phase = 2 * std::numbers::pi * static_cast<double>(i) / 20;
    loop.normal_load.push_back(100.0 * (1 + amplitude * std::sin(phase)));
  }
  return Stages(loop, With(thresholds)).data.load_varies;
}

const std::map<std::string_view, Case>& Cases() {
  static const std::map<std::string_view, Case> cases = {
      {"significance",
       [](const Thresholds& t) {
         const Record record = testing::SprungLoop(kMindlin, 6e7);
         return RigIsFound(t, record, kBelow * 0.05, 1e-4) &&
                !RigIsFound(t, record, kAbove * 0.05, 1e-4);
       }},
      {"shape_effect",
       [](const Thresholds& t) {
         const auto looks_for_a_rig = [&](double effect) {
           const BranchLaw law{4e7, 1.0 / 3 - effect, 40.0};
           return RigIsFound(t, testing::SprungLoop(law, HUGE_VAL), /*p_value=*/0.0,
                             /*variance=*/1.0);
         };
         return !looks_for_a_rig(kBelow * 0.05) && looks_for_a_rig(kAbove * 0.05);
       }},
      {"rigid_beside_rig",
       [](const Thresholds& t) {
         const auto names_alpha = [&](double ratio) {
           return !FoundRigAlternative(Made(), {1e6, ratio * 1e6}, t).parameters.empty();
         };
         return names_alpha(kBelow * 30) && !names_alpha(kAbove * 30);
       }},
      {"poor_misfit",
       [](const Thresholds& t) {
         return MisfitOf(t, kBelow * 0.02, 0.9) == "none" &&
                MisfitOf(t, kAbove * 0.02, 0.9) == "systematic_residual";
       }},
      {"quantitative_misfit",
       [](const Thresholds& t) {
         return UseAt(t, kBelow * 0.05) == Use::kQuantitative &&
                UseAt(t, kAbove * 0.05) == Use::kIndicative;
       }},
      {"failing_misfit",
       [](const Thresholds& t) {
         return MisfitOf(t, kBelow * 0.15, 0.9) == "systematic_residual" &&
                MisfitOf(t, kAbove * 0.15, 0.9) == "no_model_fits";
       }},
      {"repeats_when_poor",
       [](const Thresholds& t) {
         return MisfitOf(t, 0.05, kBelow * 0.3) == "none" &&
                MisfitOf(t, 0.05, kAbove * 0.3) == "systematic_residual";
       }},
      {"repeats_when_failing",
       [](const Thresholds& t) {
         return MisfitOf(t, 0.2, kBelow * 0.1) == "none" &&
                MisfitOf(t, 0.2, kAbove * 0.1) == "no_model_fits";
       }},
      {"main_stroke",
       [](const Thresholds& t) {
         // Strokes of 1, 0.6 and 0.9 of the longest, there and back.
         History displacement = {0.0};
         for (const double top : {1.0, 0.6, 0.9, 1.0}) {
           for (int i = 1; i <= 20; ++i) displacement.push_back(3e-6 * top * i / 20);
           for (int i = 19; i >= 0; --i) displacement.push_back(3e-6 * top * i / 20);
         }
         Generator generator(2);
         std::vector<double> noise;
         for (std::size_t i = 0; i < displacement.size(); ++i) noise.push_back(Normal(generator));
         return Evaluated(t, displacement, noise).records[0].structure.strokes == 3;
       }},
      {"same_directions",
       [](const Thresholds& t) {
         return KindOf(t, kBelow * 0.6, 0, 0.5) == "asymmetric" &&
                KindOf(t, kAbove * 0.6, 0, 0.5) == "same_on_return" &&
                KindOf(t, 0, -kBelow * 0.6, 0.5) == "asymmetric" &&
                KindOf(t, 0, -kAbove * 0.6, 0.5) == "mirrored";
       }},
      {"early_in_stroke",
       [](const Thresholds& t) {
         return KindOf(t, 0, 0, kBelow * 0.25) == "one_sided_early" &&
                KindOf(t, 0, 0, kAbove * 0.25) == "asymmetric" &&
                KindOf(t, 0, -0.9, kBelow * 0.25) == "mirrored_early" &&
                KindOf(t, 0, -0.9, kAbove * 0.25) == "mirrored";
       }},
      {"path_excess",
       [](const Thresholds& t) {
         return !WayIsTooLong(t, kBelow * 0.25) && WayIsTooLong(t, kAbove * 0.25);
       }},
      {"energy_difference",
       [](const Thresholds& t) {
         return !EnergyContradicts(t, kBelow * 0.2, 0) && EnergyContradicts(t, kAbove * 0.2, 0);
       }},
      {"energy_errors",
       [](const Thresholds& t) {
         return EnergyContradicts(t, 0.5, 0.5 / (kAbove * 5)) &&
                !EnergyContradicts(t, 0.5, 0.5 / (kBelow * 5));
       }},
      {"widest_ratio",
       [](const Thresholds& t) {
         return !IsWide(t, 0, 1.0, kBelow * 9) && IsWide(t, 0, 1.0, kAbove * 9) &&
                !IsWide(t, 2, 0.5, kBelow * 4.5) && IsWide(t, 2, 0.5, kAbove * 4.5);
       }},
      {"widest_shape",
       [](const Thresholds& t) {
         // Of an α of 2, twice as wide.
         return !IsWide(t, 1, 0.5, 0.5 + kBelow * 2) && IsWide(t, 1, 0.5, 0.5 + kAbove * 2);
       }},
      {"doubt",
       [](const Thresholds& t) {
         return IsDoubted(t, kBelow * 0.005) && !IsDoubted(t, kAbove * 0.005);
       }},
      {"cause",
       [](const Thresholds& t) {
         const auto causes = [&](double p_value) {
           return CausesAmong(t, {FitWith(p_value, -20)});
         };
         return causes(kBelow * 1e-3) == 1 && causes(kAbove * 1e-3) == 0;
       }},
      {"rival_cause",
       [](const Thresholds& t) {
         const auto causes = [&](double share) {
           DepartureFit best = FitWith(1e-9, -90);
           best.explains = 0.6;
           DepartureFit other = FitWith(1e-9, -30);
           other.explains = share * best.explains;
           return CausesAmong(t, {other, best});
         };
         return causes(kBelow * 0.5) == 1 && causes(kAbove * 0.5) == 2;
       }},
      {"simpler_cause",
       [](const Thresholds& t) {
         // Of a power of the speed and a viscous force, which is a part of it, one is left.
         const auto left = [&](double share) {
           const auto fit_of = [](std::string_view code, double explains) {
             DepartureFit fit = FitWith(1e-9, -90);
             while (Departures()[fit.departure].code != code) ++fit.departure;
             fit.explains = explains;
             return fit;
           };
           const std::vector<DepartureFit> causes = CausesOf(
               TestWith({fit_of("speed_power", 0.3), fit_of("viscous_force", share * 0.3)}), t);
           return causes.size() == 1 ? Departures()[causes[0].departure].code : "both";
         };
         return left(kBelow * 0.85) == "speed_power" && left(kAbove * 0.85) == "viscous_force";
       }},
      {"noise_memory",
       [](const Thresholds& t) { return IsSlow(t, kAbove * 0.5) && !IsSlow(t, kBelow * 0.5); }},
      {"rival_past",
       [](const Thresholds& t) {
         return PastIsUndecided(-kBelow * 10, t) && !PastIsUndecided(kAbove * 10, t);
       }},
      {"mobilised_by_asymptote",
       [](const Thresholds& t) { return IsExtrapolated(t, 0.7) && !IsExtrapolated(t, 0.95); }},
      {"rival_law",
       [](const Thresholds& t) {
         return LawIsUndecided(-kBelow * 10, t) && !LawIsUndecided(kAbove * 10, t);
       }},
      {"seen_loop",
       [](const Thresholds& t) {
         return !LoopIsSeen(t, kBelow * 0.1) && LoopIsSeen(t, kAbove * 0.1);
       }},
      {"load_difference",
       [](const Thresholds& t) {
         return !IsLoadSeries(t, kBelow * 0.01) && IsLoadSeries(t, kAbove * 0.01);
       }},
      {"load_variation",
       [](const Thresholds& t) {
         return !LoadIsFollowed(t, kBelow * 0.01) && LoadIsFollowed(t, kAbove * 0.01);
       }},
      {"prior_distance",
       [](const Thresholds& t) {
         return !PriorIsContradicted(t, kBelow * 3.0) && PriorIsContradicted(t, kAbove * 3.0);
       }},

  };
  return cases;
}

TEST(ThresholdTable, HasARowForEachMemberInTheirOrder) {
  ASSERT_EQ(ThresholdTable().size() * sizeof(double), sizeof(Thresholds));
  const Thresholds thresholds;
  const auto* first = reinterpret_cast<const double*>(&thresholds);
  for (std::size_t i = 0; i < ThresholdTable().size(); ++i) {
    const ThresholdRow& row = ThresholdTable()[i];
    EXPECT_EQ(&(thresholds.*row.value), first + i) << row.name;
    EXPECT_FALSE(row.name.empty() || row.unit.empty() || row.meaning.empty() || row.reason.empty())
        << row.name;
  }
}

TEST(SlowResiduals, ThatForgetNothingRememberAsLongAsTheRecord) {
  const auto strokes = [](double durbin_watson) {
    return FindSlowResiduals(TwoStrokes(durbin_watson), Thresholds{})->Number("strokes");
  };
  EXPECT_EQ(strokes(0.0), 2.0);
  EXPECT_EQ(strokes(1e-30), 2.0);
  // A correlation of 1/e after one and a half strokes.
  EXPECT_NEAR(*strokes(2 - 2 * std::exp(-1 / 1.5 / kSamplesAStroke)), 1.5, 1e-9);
}

TEST(ThresholdTable, RowsDecideWhereTheySayAndTwiceOrHalfOfThemElsewhere) {
  for (const auto& [name, decides] : Cases()) {
    const auto row = std::ranges::find(ThresholdTable(), name, &ThresholdRow::name);
    ASSERT_NE(row, ThresholdTable().end()) << name;
    EXPECT_TRUE(decides(Thresholds{})) << name;
    for (const double factor : {2.0, 0.5}) {
      Thresholds moved;
      moved.*(row->value) *= factor;
      EXPECT_FALSE(decides(moved)) << name << ' ' << factor;
    }
  }
}

}  // namespace
}  // namespace mindahl::identification::thresholds_test
