#include "mindahl/identification/thresholds.h"

#include "identification/diagnosis/adequacy.h"
#include "identification/diagnosis/diagnosis.h"
#include "identification/diagnosis/hull.h"
#include "identification/gram/omitted_terms.h"
#include "identification/inference/estimates.h"
#include "identification/inference/noise.h"
#include "identification/inference/profile.h"
#include "identification/stages.h"
#include "mindahl/identification/model_comparison.h"
#include "mindahl/models/steady_loop.h"
#include "support/prelude.h"

// What each threshold decides: a case a row, whose expectations are written for the value that the
// row states, and which no longer hold when it is twice or half of it.
namespace mindahl::identification::thresholds_test {
namespace {

constexpr BranchLaw kMindlin{4e7, 1.0 / 3, 40.0};
constexpr double kGrossSlip = 1.5e-6;  // [m]
/// What is tested lies this much to either side of a threshold.
constexpr double kBelow = 0.75;
constexpr double kAbove = 1.33;

FitOptions With(const Thresholds& thresholds) { return {.thresholds = thresholds}; }

// --- diagnosis: pure functions of a result made by hand

/// At gross slip.
FitResult Made() { return testing::MadeFit(/*peak_force=*/20.0); }

Use UseAt(const Thresholds& thresholds, double misfit) {
  FitResult result = Made();
  result.adequacy.misfit = misfit * result.PeakForce();
  GradeUse(thresholds, result);
  return result.adequacy.use;
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
  return IsLoopSeen(result, thresholds);
}

// --- tests and profiles on stages

/// A rig tried for a loop of another shape, at a variance of the noise given by hand.
/// The interval of α beside a rig that is found; empty where none is.
std::optional<Ends> ShapeBesideRig(const Thresholds& thresholds, const Record& record,
                                   double variance) {
  Stages stages(record, With(thresholds));
  const Solution best = stages.Solve();
  const Noise noise = KnownNoise(variance, stages.data.counted);
  const Estimates estimates = testing::EstimatesOf(stages, best, noise);
  ParameterEstimates parameters = ValuesOf(stages.problem, best);
  parameters[kShape].upper95 = parameters[kShape].value;
  if (IncludeCompliantRig(estimates, parameters).empty()) return {};
  return Ends{.lower = parameters[kShape].lower95, .upper = parameters[kShape].upper95};
}

// --- verdicts

/// Two strokes whose residuals are a share of the force, and whose correlation decays to 1/e over
/// so many strokes.
bool IsSlow(const Thresholds& thresholds, double strokes, double misfit = 0.2) {
  constexpr std::size_t kSamplesAStroke = 50;
  FitResult result = Made();
  result.records[0].residual.resize(2 * kSamplesAStroke);
  result.records[0].counts.resize(2 * kSamplesAStroke, 1);
  result.records[0].reversals.resize(1);
  result.residuals.rms = misfit * result.PeakForce();
  result.residuals.durbin_watson =
      2 - 2 * std::exp(-1 / (strokes * static_cast<double>(kSamplesAStroke)));
  return AreUnlikeNoise(result, thresholds);
}

/// Residuals that are white but for what they carry over to the next stroke.
bool IsCarriedOver(const Thresholds& thresholds, double correlation) {
  FitResult result = Made();
  result.residuals.durbin_watson = 2.0;
  result.records[0].structure.carried_over = correlation;
  result.residuals.rms = 0.2 * result.PeakForce();
  return AreUnlikeNoise(result, thresholds);
}

/// Whether residuals of such a chance are doubted.
bool IsDoubted(const Thresholds& thresholds, double chance) {
  FitResult result = Made();
  result.adequacy.p_value = chance;
  JudgeAdequacy(/*is_limited=*/false, thresholds, result);
  return result.adequacy.verdict == AdequacyVerdict::kDoubtful;
}

OmittedTerm FitWith(double p_value, double delta_aicc) {
  OmittedTerm fit;
  fit.p_value = p_value;
  fit.delta_aicc = delta_aicc;
  return fit;
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

using Row = std::pair<double Thresholds::*, Case>;
const std::vector<Row>& Cases() {
  static const std::vector<Row> cases = {
      {&Thresholds::rigid_beside_rig,
       [](const Thresholds& t) {
         const auto widens_alpha = [&](double ratio) {
           const BranchLaw law{4e7, 1.0 / 3, 40.0};
           const Record loop = testing::SprungLoop(law, law.tangential_stiffness / ratio);
           const std::optional<Ends> shape = ShapeBesideRig(t, loop, /*variance=*/1.0);
           return shape && *shape->upper > 0.3;
         };
         return widens_alpha(kBelow * 30) && !widens_alpha(kAbove * 30);
       }},
      {&Thresholds::failing_misfit,
       [](const Thresholds& t) {
         return UseAt(t, kBelow * 0.15) == Use::kIndicative &&
                UseAt(t, kAbove * 0.15) == Use::kNone;
       }},
      {&Thresholds::quantitative_misfit,
       [](const Thresholds& t) {
         return UseAt(t, kBelow * 0.05) == Use::kQuantitative &&
                UseAt(t, kAbove * 0.05) == Use::kIndicative;
       }},
      {&Thresholds::main_stroke,
       [](const Thresholds& t) {
         // Strokes of 1, 0.6 and 0.9 of the longest, there and back.
         History displacement = {0.0};
         for (const double top : {1.0, 0.6, 0.9, 1.0}) {
           for (int i = 1; i <= 20; ++i) displacement.push_back(3e-6 * top * i / 20);
           for (int i = 19; i >= 0; --i) displacement.push_back(3e-6 * top * i / 20);
         }
         ScaledRecord record;
         record.displacement.assign(displacement.begin(), displacement.end());
         record.force.resize(displacement.size());
         record.counts.assign(displacement.size(), 1);
         record.reversals = FindReversals(displacement, 0.0);
         return DescribeStructure(record, std::vector<double>(displacement.size(), 1.0), t)
                    .strokes == std::array<std::size_t, 2>{3, 3};
       }},
      {&Thresholds::widest_ratio,
       [](const Thresholds& t) {
         return !IsWide(t, 0, 1.0, kBelow * 9) && IsWide(t, 0, 1.0, kAbove * 9) &&
                !IsWide(t, 2, 0.5, kBelow * 4.5) && IsWide(t, 2, 0.5, kAbove * 4.5);
       }},
      {&Thresholds::widest_shape,
       [](const Thresholds& t) {
         // Of an α of 2, twice as wide.
         return !IsWide(t, 1, 0.5, 0.5 + kBelow * 2) && IsWide(t, 1, 0.5, 0.5 + kAbove * 2);
       }},
      {&Thresholds::doubt,
       [](const Thresholds& t) {
         return IsDoubted(t, kBelow * 0.005) && !IsDoubted(t, kAbove * 0.005);
       }},
      {&Thresholds::omission_chance,
       [](const Thresholds& t) {
         const auto is_included = [&](double chance) {
           Adequacy adequacy;
           adequacy.p_value = chance;
           return MayOmitTerms(adequacy, t);
         };
         return is_included(kBelow * 0.2) && !is_included(kAbove * 0.2);
       }},
      {&Thresholds::rare_chance,
       [](const Thresholds& t) {
         const auto causes = [&](double p_value) {
           return CausesOf({FitWith(p_value, -20)}, t).size();
         };
         return causes(kBelow * 1e-3) == 1 && causes(kAbove * 1e-3) == 0;
       }},
      {&Thresholds::rival,
       [](const Thresholds& t) {
         const auto causes = [&](double share) {
           OmittedTerm best = FitWith(1e-9, -90);
           best.explains = 0.6;
           OmittedTerm other = FitWith(1e-9, -30);
           other.explains = share * best.explains;
           return CausesOf({other, best}, t).size();
         };
         return causes(kBelow * 0.5) == 1 && causes(kAbove * 0.5) == 2;
       }},
      {&Thresholds::noise_memory,
       [](const Thresholds& t) { return IsSlow(t, kAbove * 0.5) && !IsSlow(t, kBelow * 0.5); }},
      {&Thresholds::carried_over,
       [](const Thresholds& t) {
         return IsCarriedOver(t, kAbove * 0.3) && !IsCarriedOver(t, kBelow * 0.3);
       }},
      {&Thresholds::poor_misfit,
       [](const Thresholds& t) {
         return IsSlow(t, 1.0, kAbove * 0.02) && !IsSlow(t, 1.0, kBelow * 0.02);
       }},
      {&Thresholds::seen_loop,
       [](const Thresholds& t) {
         return !LoopIsSeen(t, kBelow * 0.1) && LoopIsSeen(t, kAbove * 0.1);
       }},
      {&Thresholds::load_change,
       [](const Thresholds& t) {
         return !IsLoadSeries(t, kBelow * 0.01) && IsLoadSeries(t, kAbove * 0.01);
       }},
      {&Thresholds::load_change,
       [](const Thresholds& t) {
         return !LoadIsFollowed(t, kBelow * 0.01) && LoadIsFollowed(t, kAbove * 0.01);
       }},

  };
  return cases;
}

TEST(Thresholds, DecideWhereTheySayAndTwiceOrHalfOfThemElsewhere) {
  for (std::size_t row = 0; row < Cases().size(); ++row) {
    const auto& [threshold, decides] = Cases()[row];
    EXPECT_TRUE(decides(Thresholds{})) << row;
    for (const double factor : {2.0, 0.5}) {
      Thresholds moved;
      moved.*threshold *= factor;
      EXPECT_FALSE(decides(moved)) << row << ' ' << factor;
    }
  }
}

}  // namespace
}  // namespace mindahl::identification::thresholds_test
