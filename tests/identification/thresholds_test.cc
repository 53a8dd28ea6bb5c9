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

/// The argument at which a function that falls, or grows, passes 0, on a scale of logarithms.
double ZeroOf(double low, double high, const std::function<double(double)>& function) {
  const bool grows = function(high) > function(low);
  for (int i = 0; i < 40; ++i) {
    const double middle = std::sqrt(low * high);
    ((function(middle) > 0) == grows ? high : low) = middle;
  }
  return std::sqrt(low * high);
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

/// Of a cycled contact with α = 1, that comes so near to Tc.
bool AsymmetryIsUntold(const Thresholds& thresholds, double never_slips) {
  FitResult result = Made();
  result.model = &Model("mindlin-dahl");
  result.initial_state = InitialState::kSteady;
  result.law.shape_exponent = 1.0;
  result.records[0].measures.amplitude =
      -std::log(never_slips) * result.law.slip_force / result.law.tangential_stiffness;
  ParameterEstimate& asymmetry = result.parameters.emplace_back();
  asymmetry.name = "asymmetry";
  asymmetry.status = ParameterStatus::kFree;
  return FindUntoldAsymmetry(result, thresholds).has_value();
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

/// A push and a way back, of a contact that was unloaded away from the first sample [of X].
bool PastIsUnknown(const Thresholds& thresholds, double away) {
  History displacement;
  for (int i = 0; i <= 40; ++i) displacement.push_back(1e-6 * i / 40);
  for (int i = 39; i >= 0; --i) displacement.push_back(1e-6 * i / 40);
  Stages stages(LoopOf(kMindlin, displacement));
  Solution solution = stages.Solve();
  const ScaledRecord& record = stages.data.records[0];
  const auto [lowest, highest] = std::ranges::minmax(record.displacement);
  solution.theta[stages.problem.parameters.PositionOf("displacement_offset", 0)] =
      record.displacement.front() + away * (highest - lowest) / 2;
  return FindUnknownPast(stages.problem, solution, thresholds).has_value();
}

/// Cycles of so many samples, in step with the motion and apart from each other.
bool HasFewPlaces(const Thresholds& thresholds, std::size_t samples_a_cycle) {
  History displacement;
  for (std::size_t i = 0; i < 10 * samples_a_cycle; ++i) {
    const double phase = (static_cast<double>(i) + 0.3) / static_cast<double>(samples_a_cycle);
    displacement.push_back(3e-6 * std::sin(2 * std::numbers::pi * phase));
  }
  Stages stages(LoopOf(kMindlin, displacement));
  return FindFewPlaces(stages.problem, thresholds).has_value();
}

/// Places at which ten samples a cycle are, of which every other cycle is moved by so much of half
/// the range.
double PlacesOfMovedCycles(double moved) {
  constexpr double kReach = 3e-6;
  History displacement;
  for (std::size_t i = 0; i < 100; ++i) {
    const double phase = (static_cast<double>(i) + 0.3) / 10.0;
    const double shift = (i / 10) % 2 == 0 ? 0.0 : moved;
    displacement.push_back(kReach * (std::sin(2 * std::numbers::pi * phase) + shift));
  }
  Stages stages(LoopOf(kMindlin, displacement));
  const std::optional<Finding> found = FindFewPlaces(stages.problem, {});
  return found ? *found->Number("places") : 0.0;
}

TEST(FindFewPlaces, MergesPlacesWithinHalfAPercentOfTheRange) {
  const double places = PlacesOfMovedCycles(0.0);
  ASSERT_GT(places, 0.0);
  EXPECT_EQ(PlacesOfMovedCycles(2 * 0.0035), places);
  EXPECT_NE(PlacesOfMovedCycles(2 * 0.008), places) << "twenty are not few";
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

double SumOfSquaresWith(const Record& record, const FitOptions& options) {
  return Stages(record, options).Solve().sum_of_squares;
}

/// A loop with known noise, for what is asked of its slip force.
class SlipForceCase {
 public:
  SlipForceCase(const Thresholds& thresholds, const Record& record, FitOptions options = {})
      : stages_(record, WithThresholds(std::move(options), thresholds)), best_(stages_.Solve()) {}

  /// Standard error of ln θ at unit variance.
  double UnitError(std::size_t parameter) { return EstimatesAt(1.0).ErrorOfTheta(parameter); }
  bool NeedsProfile(double variance, double peak_share) {
    return NeedsSlipForceProfile({stages_.problem, best_, NoiseAt(variance), EstimatesAt(variance)},
                                 peak_share, stages_.options, stages_.buffers);
  }
  bool IsOpenAbove(double variance) {
    return ProfileSlipForce({stages_.problem, best_, NoiseAt(variance), EstimatesAt(variance)},
                            stages_.options, stages_.buffers)
        .open_above;
  }
  bool RigidPasses(double variance) {
    return StiffnessIsOpenAbove({stages_.problem, best_, NoiseAt(variance), EstimatesAt(variance)},
                                stages_.options, stages_.buffers);
  }
  [[nodiscard]] double sum_of_squares() const { return best_.sum_of_squares; }
  [[nodiscard]] double ValueOf(std::size_t parameter, double shift) const {
    return stages_.problem.parameters[parameter].ToValue(best_.theta[parameter] + shift);
  }
  [[nodiscard]] double force() const { return stages_.data.force; }

 private:
  static FitOptions WithThresholds(FitOptions options, const Thresholds& thresholds) {
    options.thresholds = thresholds;
    return options;
  }
  [[nodiscard]] Noise NoiseAt(double variance) const {
    return KnownNoise(variance, stages_.data.counted);
  }
  Estimates EstimatesAt(double variance) {
    return {stages_.problem,         best_, NoiseAt(variance), {}, stages_.options.thresholds,
            stages_.buffers.response};
  }

  Stages stages_;
  Solution best_;
};

constexpr double kTwoSided = 1.959963984540054;

const Record& SlippingLoop() {
  static const Record record = LoopOf(kMindlin, Cycling(Wave::kSine, 1.3 * kGrossSlip, 2.0, 120));
  return record;
}

/// σ and Tc at the ends of the interval of ln Tc: 2 ln Λ over its critical value, less one.
double DepartureFromParabola(double half, double unit_error) {
  const double variance = std::pow(half / (kTwoSided * unit_error), 2);
  const double best = SumOfSquaresWith(SlippingLoop(), {});
  double most = 0.0;
  for (const double side : {-1.0, 1.0}) {
    FitOptions held;
    held.fixed["slip_force"] = kMindlin.slip_force * std::exp(side * half);
    const double ratio = (SumOfSquaresWith(SlippingLoop(), held) - best) / variance;
    most = std::max(most, std::abs(ratio / (kTwoSided * kTwoSided) - 1));
  }
  return most;
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

const ModelScore* Score(const ModelSelection& selection, std::string_view model, bool rig) {
  const auto found = std::ranges::find_if(selection.scores, [&](const ModelScore& score) {
    return score.model->name == model && score.rig == rig;
  });
  return found == selection.scores.end() ? nullptr : &*found;
}

FitOptions Virgin(const Thresholds& thresholds = {}) {
  FitOptions options = With(thresholds);
  options.initial_state = InitialState::kVirgin;
  return options;
}

bool RepeatsByChance(const Thresholds& thresholds, double chance) {
  // White noise and a wave of such a size that it passes for noise once in 1/chance.
  const History displacement = Cycling(Wave::kSine, 3e-6, 6.0, 200);
  const auto residuals = [&](double size) {
    Generator generator(3);
    std::vector<double> values;
    for (const double x : displacement) {
      values.push_back(Normal(generator) + size * std::sin(2e6 * x));
    }
    return values;
  };
  const std::vector<unsigned char> counts(displacement.size(), 1);
  const double size = ZeroOf(1e-3, 10, [&](double trial) {
    const ResidualStructure structure =
        DescribeStructure(displacement, FindReversals(displacement, 0.0), residuals(trial), counts,
                          {.main_stroke = 0.75, .repeat_chance = chance});
    return structure.repeatable_share > 0 ? 1.0 : -1.0;
  });
  const FitResult fit = Evaluated(thresholds, displacement, residuals(size));
  return fit.records[0].structure.repeatable_share > 0;
}

/// Are turning points looked for that may move a parameter by so many standard errors?
bool TurnsAreTried(const Thresholds& thresholds, double shift) {
  const Record dense = LoopOf(kMindlin, Cycling(Wave::kSine, kGrossSlip, 3.0, 400));
  const auto largest_shift = [&](double noise, const Thresholds& tried) {
    Record record;
    Generator generator(5);
    for (std::size_t i = 2; i < dense.size(); i += 8) {
      record.displacement.push_back(dense.displacement[i]);
      record.force.push_back(dense.force[i] + noise * Normal(generator));
    }
    Stages stages(record, Virgin(tried));
    const Solution best = stages.Solve();
    if (best.theta.empty()) return std::pair(0.0, false);  // noise alone has no sign of the force
    const ScaledRecord& data = stages.data.records[0];
    double longest = 0.0;
    for (std::size_t k = 0; k < data.reversals.size(); ++k) {
      longest = std::max(longest, OvershootOfMotion(data, k));
    }
    // As if the whole record were as stiff as its virgin branch begins.
    const double count = static_cast<double>(data.size());
    const double rms = std::sqrt(best.sum_of_squares / count);
    const double said = std::sqrt(count) * std::exp(best.theta[kStiffness]) * longest / rms;
    const bool is_tried =
        FitAtTurningPoints(stages.problem, best, stages.options, stages.buffers).has_value();
    return std::pair(said, is_tried);
  };
  const double noise = ZeroOf(
      1e-2, 1e4, [&](double trial) { return largest_shift(trial, Thresholds()).first - shift; });
  return largest_shift(noise, thresholds).second;
}

/// Has each of two records a noise of its own, where noise of one variance makes theirs so unlike
/// with that chance?
bool NoiseDiffersAt(const Thresholds& thresholds, double chance) {
  const auto records = [](double ratio) {
    Generator generator(5);
    const Record loop = LoopOf(kMindlin, Cycling(Wave::kSine, kGrossSlip, 2.0, 100));
    return std::vector<Record>{WithForceNoise(loop, 0.4, generator),
                               WithForceNoise(loop, 0.4 * ratio, generator)};
  };
  const auto chance_of = [&](double ratio) {
    Stages stages(records(ratio), Virgin());
    const Solution best = stages.Solve();
    const Eigen::VectorXd residual = stages.ResidualsAt(best.theta);
    return ChanceOfOneNoise(stages.problem, {residual.data(), stages.problem.size()});
  };
  // From where the second is the louder one.
  const double ratio =
      ZeroOf(1.1, 4.0, [&](double trial) { return std::log(chance_of(trial) / chance); });
  FitOptions options = Virgin(thresholds);
  options.thresholds.turning_point_shift = 1e9;  // they stay at the samples, as in the stages
  const FitResult fit = Fit(records(ratio), options);
  return fit.records[0].response_noise != fit.records[1].response_noise;
}

/// 2 ln Λ of a rig, for a loop in one that hardly gives way.
bool RigOfGainIsRedundant(const Thresholds& thresholds, double gain) {
  const auto record_in = [](double compliance) {
    const History displacement = Cycling(Wave::kSine, 2 * kGrossSlip, 1.3, 100);
    std::vector<double> force(displacement.size());
    const FrictionModel& model = Model("mindlin");
    EvaluateForce(model, kMindlin, testing::PathOf(model, displacement), displacement, force,
                  {1 / compliance});
    Generator generator(4);  // no rig gains anything where there is none
    return WithForceNoise(MakeRecord(displacement, force), 0.01 * kMindlin.slip_force, generator);
  };
  const auto rms = [](const Record& record, bool rig) {
    FitOptions options = Virgin();
    options.model = &Model("mindlin");
    if (rig) options.terms.emplace_back("rig_stiffness");
    return SumOfSquaresWith(record, options);
  };
  const double compliance = ZeroOf(1e-12, 1e-8, [&](double trial) {
    const Record record = record_in(trial);
    return static_cast<double>(record.size()) * std::log(rms(record, false) / rms(record, true)) -
           gain;
  });
  FitOptions options = Virgin(thresholds);
  options.fixed["alpha"] = 1.0 / 3;
  const Record record = record_in(compliance);
  return Score(SelectModel({&record, 1}, options, {.folds = 2}), "mindlin", true)->redundant;
}

bool ShapeIsThatOfJenkins(const Thresholds& thresholds, double lowest_shape) {
  Generator generator(13);
  const Record record = WithForceNoise(
      LoopOf({4e7, 0.0, 40.0}, Cycling(Wave::kSine, 2e-6, 1.3, 100)), 1.0, generator);
  FitOptions options = Virgin(thresholds);
  options.bounds["alpha"] = {lowest_shape, 5.0};
  const ModelSelection selection = SelectModel({&record, 1}, options, {.folds = 2});
  const ModelScore& score = *Score(selection, "mindlin-dahl", false);
  EXPECT_TRUE(score.at_bound) << "the case needs it";
  return score.redundant;
}

bool KnownTogether(const Thresholds& thresholds, double reach) {
  FitOptions options = Virgin(thresholds);
  const BranchLaw law{4e7, 0.5, 40.0};
  const SeriesSpring rig{6e7};
  const History displacement =
      Cycling(Wave::kSine, reach * GrossSlipDisplacement(law, rig), 1.3, 200);
  std::vector<double> force(displacement.size());
  const FrictionModel& model = Model("mindlin-dahl");
  EvaluateForce(model, law, testing::PathOf(model, displacement), displacement, force, rig);
  Generator generator(17);
  const Record record = WithForceNoise(MakeRecord(displacement, force), 0.01, generator);
  const ModelSelection selection = SelectModel({&record, 1}, options, {.folds = 2});
  return Score(selection, "mindlin-dahl", true)->remark.find("only together") != std::string::npos;
}

/// Whether the force's noise is told by samples with four fifths of it and no others.
bool NoiseIsToldByItsOwnSamples(const Thresholds& thresholds) {
  constexpr double kDither = 1e-8;  // [m]
  Generator generator(19);
  Record record = LoopOf(kMindlin, Cycling(Wave::kSine, 2 * kGrossSlip, 4.0, 200));
  double noise = 0.0;
  for (std::size_t i = 0; i < record.size(); ++i) {
    noise = 0.8 * noise + 0.6 * Normal(generator);
    record.force[i] += 0.2 * noise;
    record.displacement[i] += kDither * Normal(generator);
  }
  FitOptions options = Virgin(thresholds);
  options.preparation.displacement_noise = kDither;
  Stages stages(record, options);
  const auto [weights, solution] = testing::FitWeighted(stages);
  const Eigen::VectorXd residual = stages.ResidualsAt(solution.theta);
  std::vector<unsigned char> counts;
  for (const double share : weights.force_share) counts.push_back(share * share >= 0.8 ? 1 : 0);
  const std::span<const double> series(residual.data(), counts.size());
  const std::span<const unsigned char> mask(counts);
  const double expected = static_cast<double>(record.size()) /
                          EstimateAutocorrelation({&series, 1}, {&mask, 1}).SquaredCorrelations();

  std::vector<RecordView> views = {record};
  Fitter fitter(options);
  const FitResult& fit = fitter.Fit(views, Depth::kIntervals);
  const ResidualStructure& structure = fit.records[0].structure;
  const double repeating =
      1 + structure.repeatable_share * (static_cast<double>(structure.strokes) - 1);
  return std::abs(fit.residuals.effective_samples * repeating / expected - 1) < 1e-3;
}

/// Whether a fit is taken to absorb of autocorrelated noise what it does, to half of the samples.
bool AbsorbsToOneHalf(const Thresholds& thresholds) {
  Stages stages(SlippingLoop(), With(thresholds));
  const Solution best = stages.Solve();
  const auto parameters = static_cast<double>(stages.problem.parameters.free().size());
  Noise noise = KnownNoise(1.0, 1000);
  noise.is_known = false;
  noise.autocorrelation = testing::FirstOrder(0.9);
  const auto estimates = [&] {
    return Estimates(stages.problem, best, noise, {}, thresholds, stages.buffers.response);
  };
  const double absorbed = estimates().local().absorbed;
  bool holds = true;
  for (const double share : {kBelow * 0.5, kAbove * 0.5}) {
    noise.samples = static_cast<std::size_t>(std::lround(absorbed / share));
    const auto count = static_cast<double>(noise.samples);
    const double expected = (count - parameters) / (count - std::min(absorbed, 0.5 * count));
    holds = holds && std::abs(estimates().variance() / expected - 1) < 1e-9;
  }
  return holds;
}

bool SlipForceIsOpenBelow25(const Thresholds& thresholds) {
  // Tc held at twenty times the largest force costs so much over the variance.
  const Record record = LoopOf(kMindlin, Cycling(Wave::kSine, 0.5 * kGrossSlip, 1.5, 100));
  SlipForceCase loop(thresholds, record);
  FitOptions held;
  held.fixed["slip_force"] = 20 * loop.force();
  const double cost = SumOfSquaresWith(record, held) - loop.sum_of_squares();
  return loop.IsOpenAbove(cost / (kBelow * 25.0)) && !loop.IsOpenAbove(cost / (kAbove * 25.0));
}

bool ProfilesBeyondAnErrorOfOneTenth(Thresholds thresholds) {
  thresholds.parabola_departure = 1e9;  // asks for none
  SlipForceCase loop(thresholds, SlippingLoop());
  const double unit = kTwoSided * loop.UnitError(kSlipForce);
  const auto needs = [&](double half) {
    return loop.NeedsProfile(std::pow(half / unit, 2), /*peak_share=*/1.0);
  };
  return !needs(kBelow * 0.1) && needs(kAbove * 0.1);
}

bool ProfilesWhereTheParabolaIsOffBy15Percent(Thresholds thresholds) {
  thresholds.parabola_error = 1e9;
  SlipForceCase loop(thresholds, SlippingLoop());
  const double error = loop.UnitError(kSlipForce);
  const auto needs = [&](double departure) {
    const double half = ZeroOf(
        1e-3, 0.5, [&](double trial) { return DepartureFromParabola(trial, error) - departure; });
    return loop.NeedsProfile(std::pow(half / (kTwoSided * error), 2), 1.0);
  };
  return !needs(kBelow * 0.15) && needs(kAbove * 0.15);
}

bool ProfilesBelowNineTenthsOfSlip(const Thresholds& thresholds) {
  SlipForceCase loop(thresholds, SlippingLoop());
  const double variance = std::pow(1e-3 / (kTwoSided * loop.UnitError(kSlipForce)), 2);
  return loop.NeedsProfile(variance, kBelow * 0.9) && !loop.NeedsProfile(variance, kAbove * 0.9);
}

bool TriesARigidContactBeyondAnErrorOf03(const Thresholds& thresholds) {
  // One sample of a branch, at four fifths of its way to slip, tells σ. There the force lacks
  // 0.2^1.5 of Tc, and 1.5·0.8·√0.2 by ln σ: a rigid contact is a sixth of the tangent away, and
  // passes where the error of ln σ is above a twelfth.
  FitOptions options = Virgin();
  options.fixed = {{"alpha", 1.0 / 3}, {"force_offset", 0.0}, {"displacement_offset", 0.0}};
  SlipForceCase loop(thresholds, LoopOf(kMindlin, Cycling(Wave::kTriangle, 8 * kGrossSlip, 4, 20)),
                     options);
  const double unit = kTwoSided * loop.UnitError(kStiffness);
  const auto passes = [&](double half) { return loop.RigidPasses(std::pow(half / unit, 2)); };
  return !passes(kBelow * 0.3) && passes(kAbove * 0.3);
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
  const Stages stages(SlippingLoop(), With(thresholds));
  const auto judge = [&](double p_value) {
    return JudgeAdequacy(stages.problem, {}, {TestWith({}, p_value), {}, {}}, With(thresholds), {});
  };
  // The chance that is judged is some multiple of the test's.
  constexpr double kSmall = 1e-6;
  const double multiple = judge(kSmall).p_value / kSmall;
  return judge(chance / multiple).verdict != AdequacyVerdict::kAdequate;
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

/// Swings of which the second is wider by such a share.
bool IsOfOneAmplitude(const Thresholds& thresholds, double share) {
  History displacement = {0.9, 1.0, 0.5, 0.0, -0.5, -1.0, -0.5, 0.0, 0.5, 1.0 + 2 * share, 0.9};
  for (double& x : displacement) x *= 1e-6;
  const Stages stages(LoopOf(kMindlin, displacement), With(thresholds), InitialState::kSteady);
  return HasOneAmplitude(stages.problem, thresholds);
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
      {"indistinguishable",
       [](const Thresholds& t) {
         const Record record = testing::SprungLoop({4e7, 0.2, 40.0}, HUGE_VAL);
         FitOptions rig;
         rig.terms = {"rig_stiffness"};
         rig.fixed["alpha"] = 1.0 / 3;
         const double cost = SumOfSquaresWith(record, rig) - SumOfSquaresWith(record, {});
         return RigIsFound(t, record, 0.0, cost / (kBelow * 4.0)) &&
                !RigIsFound(t, record, 0.0, cost / (kAbove * 4.0));
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
      {"repeat_chance",
       [](const Thresholds& t) {
         return RepeatsByChance(t, kBelow * 1e-3) && !RepeatsByChance(t, kAbove * 1e-3);
       }},
      {"noise_differs",
       [](const Thresholds& t) {
         return NoiseDiffersAt(t, kBelow * 0.01) && !NoiseDiffersAt(t, kAbove * 0.01);
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
      {"trend_size",
       [](const Thresholds& t) {
         return !IsWorthSaying({-kBelow * 0.01 * 3, 0, 0}, 3, t) &&
                IsWorthSaying({-kAbove * 0.01 * 3, 0, 0}, 3, t);
       }},
      {"trend_chance",
       [](const Thresholds& t) {
         return IsWorthSaying({1, 0.1, kBelow * 0.01}, 3, t) &&
                !IsWorthSaying({1, 0.1, kAbove * 0.01}, 3, t);
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
      {"open_slip_force", SlipForceIsOpenBelow25},
      {"parabola_error", ProfilesBeyondAnErrorOfOneTenth},
      {"parabola_departure", ProfilesWhereTheParabolaIsOffBy15Percent},
      {"parabola_mobilised", ProfilesBelowNineTenthsOfSlip},
      {"rigid_error", TriesARigidContactBeyondAnErrorOf03},
      {"turning_point_shift",
       [](const Thresholds& t) {
         return !TurnsAreTried(t, kBelow * 0.2) && TurnsAreTried(t, kAbove * 0.2);
       }},
      {"force_noise_share", NoiseIsToldByItsOwnSamples},
      {"most_absorbed", AbsorbsToOneHalf},
      {"redundant_gain",
       [](const Thresholds& t) {
         return RigOfGainIsRedundant(t, kBelow * 0.01) && !RigOfGainIsRedundant(t, kAbove * 0.01);
       }},
      {"jenkins_shape",
       [](const Thresholds& t) {
         return ShapeIsThatOfJenkins(t, kBelow * 0.01) && !ShapeIsThatOfJenkins(t, kAbove * 0.01);
       }},
      {"known_together",
       [](const Thresholds& t) { return KnownTogether(t, 0.6) && !KnownTogether(t, 3.0); }},
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
      {"fewest_places",
       [](const Thresholds& t) { return HasFewPlaces(t, 10) && !HasFewPlaces(t, 22); }},
      {"starts_unloaded",
       [](const Thresholds& t) {
         return !PastIsUnknown(t, kBelow * 0.02) && PastIsUnknown(t, kAbove * 0.02);
       }},
      {"mobilised_by_asymptote",
       [](const Thresholds& t) { return IsExtrapolated(t, 0.7) && !IsExtrapolated(t, 0.95); }},
      {"one_amplitude",
       [](const Thresholds& t) {
         return IsOfOneAmplitude(t, kBelow * 0.01) && !IsOfOneAmplitude(t, kAbove * 0.01);
       }},
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
      {"visible_noise",
       [](const Thresholds& t) {
         return !NoiseIsInDisplacement(kBelow * 0.002, 0.0, t) &&
                NoiseIsInDisplacement(kAbove * 0.002, 0.0, t);
       }},
      {"noisier_displacement",
       [](const Thresholds& t) {
         return !NoiseIsInDisplacement(kBelow * 0.05, 0.01, t) &&
                NoiseIsInDisplacement(kAbove * 0.05, 0.01, t);
       }},
      {"prior_distance",
       [](const Thresholds& t) {
         return !PriorIsContradicted(t, kBelow * 3.0) && PriorIsContradicted(t, kAbove * 3.0);
       }},
      {"never_slips",
       [](const Thresholds& t) {
         return !AsymmetryIsUntold(t, kBelow * 0.01) && AsymmetryIsUntold(t, kAbove * 0.01);
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

TEST(ThresholdTable, HasACaseForEachRowAndNoOther) {
  EXPECT_EQ(Cases().size(), ThresholdTable().size());
  for (const ThresholdRow& row : ThresholdTable()) {
    EXPECT_TRUE(Cases().contains(row.name)) << row.name << " may be moved unnoticed";
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

class Threshold : public ::testing::TestWithParam<ThresholdRow> {};

TEST_P(Threshold, DecidesWhereItSays) {
  const auto found = Cases().find(GetParam().name);
  ASSERT_NE(found, Cases().end());
  EXPECT_TRUE(found->second(Thresholds{}));
}

TEST_P(Threshold, TwiceOrHalfOfItDecidesAnother) {
  const auto found = Cases().find(GetParam().name);
  ASSERT_NE(found, Cases().end());
  for (const double factor : {2.0, 0.5}) {
    Thresholds moved;
    moved.*GetParam().value *= factor;
    EXPECT_FALSE(found->second(moved)) << factor;
  }
}

INSTANTIATE_TEST_SUITE_P(Rows, Threshold,
                         ::testing::ValuesIn(ThresholdTable().begin(), ThresholdTable().end()),
                         [](const auto& row) { return std::string(row.param.name); });

}  // namespace
}  // namespace mindahl::identification::thresholds_test
