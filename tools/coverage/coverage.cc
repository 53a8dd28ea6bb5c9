#include "coverage.h"

#include <algorithm>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <random>
#include <span>
#include <string_view>
#include <utility>

#include "../../tests/support/imposed_force.h"
#include "../../tests/support/joint.h"
#include "../../tests/support/variable_load.h"
#include "mindahl/loop/reversals.h"
#include "mindahl/models/contact_state.h"
#include "mindahl/models/excitation.h"
#include "mindahl/models/response.h"
#include "mindahl/models/steady_loop.h"

namespace mindahl::coverage {

using identification::FitOptions;
using loop::Record;
using models::BranchLaw;

namespace {

/// Box and Muller: the same on every platform.
class Normal {
 public:
  explicit Normal(std::uint64_t seed) : engine_(seed) {}
  double operator()() {
    constexpr double kTwoPi = 6.283185307179586;
    return std::sqrt(-2 * std::log(1 - Uniform())) * std::cos(kTwoPi * Uniform());
  }
  double Uniform() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }

 private:
  std::mt19937_64 engine_;
};

/// A contact of the size of a fretting test, as far as units go.
/// @param load  over the mean
BranchLaw LawOf(const Scenario& scenario, double load = 1.0) {
  return {5e7 * std::pow(load, scenario.load_exponent), scenario.shape_exponent, 20.0 * load};
}

constexpr double kMeanLoad = 50.0;  // [N]

/// Returns half the way of an imposed motion [m]: λ times the gross-slip displacement, or of a law
/// that never slips as a whole times the knee Tc/σ.
double ReachOf(const Scenario& scenario, const BranchLaw& law) {
  return scenario.lambda * (law.shape_exponent < 1 ? GrossSlipDisplacement(law)
                                                   : law.slip_force / law.tangential_stiffness);
}

models::SeriesSpring RigOf(const Scenario& scenario) {
  if (!(scenario.rig > 0)) return {};
  return {scenario.rig * LawOf(scenario).tangential_stiffness};
}

/// Off centre in both channels, so that offsets are to be found.
constexpr double kForceOffset = 3.0;
constexpr double kDisplacementOffset = 2e-7;

constexpr double kFrequency = 1.0;  // [Hz]
constexpr double kTwoPi = 6.283185307179586;

std::vector<double> ForceOn(const BranchLaw& law, std::span<const double> displacement,
                            double asymmetry = 0.0, const models::SeriesSpring& rig = {}) {
  const models::FrictionModel& model = *models::FindFrictionModel("mindlin-dahl");
  std::vector<double> force(displacement.size());
  const models::LoadingPath path = models::MakeLoadingPath(
      displacement, loop::FindReversals(displacement, 0.0), model.memory, {.asymmetry = asymmetry});
  models::EvaluateForce(model, law, path, displacement, force, rig);
  return force;
}

/// The force on the same motion, read 1.5 samples later: midway between two readings. Before the
/// record the contact was at rest.
std::vector<double> LateForce(const BranchLaw& law, std::span<const double> displacement) {
  constexpr std::size_t kHalves = 3;
  std::vector<double> with_middles;
  for (std::size_t i = 0; i < displacement.size(); ++i) {
    if (i > 0) with_middles.push_back((displacement[i - 1] + displacement[i]) / 2);
    with_middles.push_back(displacement[i]);
  }
  const std::vector<double> force = ForceOn(law, with_middles);
  std::vector<double> late;
  for (std::size_t i = 0; i < force.size(); i += 2) {
    late.push_back(i < kHalves ? 0.0 : force[i - kHalves]);
  }
  return late;
}

/// A contact behind a gap of width g that bears no force while it is crossed:
///   δ = x + (g/2)·sgn T,  |δ − x| <= g/2 where T = 0
/// A contact that bears nothing stands still until the gap is closed again on either side.
class ContactBehindGap {
 public:
  ContactBehindGap(models::ContactState contact, double gap)
      : contact_(std::move(contact)), gap_(gap) {}

  /// Moves the far side of the gap on to δ and returns the force there.
  double Move(double displacement) {
    for (const double side : {1.0, -1.0}) {
      const double there = displacement - side * gap_ / 2;
      if (!(side * contact_.Peek(there) > 0)) continue;
      is_open_ = false;
      return contact_.Move(there);
    }
    if (is_open_) return 0.0;
    is_open_ = true;
    const double lower = displacement - gap_ / 2;
    const double upper = displacement + gap_ / 2;
    const double of_lower = contact_.Peek(lower);
    const double of_upper = contact_.Peek(upper);
    double where = of_lower == 0 ? lower : upper;
    if (of_lower < 0 && of_upper > 0) {
      std::uintmax_t steps = 200;
      const auto [below, above] = boost::math::tools::toms748_solve(
          [&](double x) { return contact_.Peek(x); }, lower, upper, of_lower, of_upper,
          boost::math::tools::eps_tolerance<double>(), steps);
      where = std::midpoint(below, above);
    }
    contact_.Move(where);
    return 0.0;
  }

 private:
  models::ContactState contact_;
  double gap_;
  bool is_open_ = true;
};

/// Width of the gap before the contact [m].
double GapOf(const Scenario& scenario) {
  return 0.1 * scenario.lambda * GrossSlipDisplacement(LawOf(scenario));
}

/// Adds what is beside the contact, and the columns that tell it.
void AddBeside(const Scenario& scenario, Record& record) {
  const BranchLaw law = LawOf(scenario);
  const double step = 1 / (kFrequency * static_cast<double>(scenario.samples_per_cycle));
  for (std::size_t i = 0; i < record.size(); ++i) {
    record.time.push_back(step * static_cast<double>(i));
  }
  loop::Covariate column{.name = "pressure", .unit = "bar", .values = {}};
  for (std::size_t i = 0; i < record.size(); ++i) {
    const double phase = kTwoPi * kFrequency * record.time[i];
    column.values.push_back(2 + std::sin(0.37 * phase) * std::cos(2.3 * phase + 1));
    if (scenario.beside == Beside::kViscous) {
      record.force[i] += 0.05 * law.slip_force * std::cos(phase);
    }
    if (scenario.beside == Beside::kCovariate) {
      record.force[i] += 0.2 * law.slip_force * (column.values[i] - 2);
    }
  }
  if (scenario.beside == Beside::kLag) record.force = LateForce(law, record.displacement);
  if (scenario.beside == Beside::kBacklash) {
    ContactBehindGap contact({*models::FindFrictionModel(scenario.model), law}, GapOf(scenario));
    std::ranges::transform(record.displacement, record.force.begin(),
                           [&](double x) { return contact.Move(x); });
  }
  if (scenario.beside == Beside::kCovariate) record.covariates.push_back(std::move(column));
}

/// Time from one reading to the next [s].
double StepOf(const Scenario& scenario) {
  return 1 / (kFrequency * static_cast<double>(scenario.samples_per_cycle));
}

/// The force of a motion that goes on between the readings, 1.5 readings late where that is asked
/// for; before the record the contact was at rest.
Record ReadApart(const Scenario& scenario, const BranchLaw& law) {
  const std::size_t steps = scenario.steps_a_reading;
  const std::vector<double> motion =
      models::MakeExcitation({.amplitude = scenario.lambda * GrossSlipDisplacement(law),
                              .cycles = static_cast<double>(scenario.cycles),
                              .samples_per_cycle = scenario.samples_per_cycle * steps})
          .displacement;
  const std::vector<double> force = ForceOn(law, motion, scenario.asymmetry, RigOf(scenario));
  const std::size_t late = scenario.beside == Beside::kLag ? 3 * steps / 2 : 0;
  Record record;
  for (std::size_t i = 0; i < motion.size(); i += steps) {
    record.displacement.push_back(motion[i]);
    record.force.push_back(i < late ? 0.0 : force[i - late]);
    record.time.push_back(static_cast<double>(i / steps) * StepOf(scenario));
  }
  return record;
}

bool IsForced(const Scenario& scenario) { return scenario.peak_share > 0; }

void LeaveOutFirstCycle(const Scenario& scenario, Record& record) {
  const auto first = static_cast<std::ptrdiff_t>(scenario.samples_per_cycle);
  for (std::vector<double>* column : {&record.force, &record.displacement}) {
    column->erase(column->begin(), column->begin() + first);
  }
}

/// Of an imposed force.
Record ForcedRecord(const Scenario& scenario) {
  const BranchLaw law = LawOf(scenario);
  Record record;
  record.force = models::MakeExcitation({.amplitude = scenario.peak_share * law.slip_force,
                                         .cycles = static_cast<double>(scenario.cycles),
                                         .samples_per_cycle = scenario.samples_per_cycle})
                     .displacement;
  record.displacement =
      testing::DisplacementUnder(*models::FindFrictionModel(scenario.model), law, record.force);
  if (scenario.is_steady) LeaveOutFirstCycle(scenario, record);
  return record;
}

Record DrivenRecord(const Scenario& scenario, double load, bool is_steady) {
  const BranchLaw law = LawOf(scenario, load);
  if (scenario.steps_a_reading > 1) return ReadApart(scenario, law);
  Record record;
  record.displacement = models::MakeExcitation({.amplitude = ReachOf(scenario, law),
                                                .cycles = static_cast<double>(scenario.cycles),
                                                .samples_per_cycle = scenario.samples_per_cycle})
                            .displacement;
  for (std::size_t i = 0; i < record.displacement.size(); ++i) {
    record.displacement[i] = record.displacement[i - i % scenario.dwell];
  }
  if (scenario.load_swing > 0) {
    record.displacement.pop_back();  // whole cycles of the load, whose mean is then its mean
    record.force.resize(record.displacement.size());
    for (std::size_t i = 0; i < record.displacement.size(); ++i) {
      const double cycles =
          static_cast<double>(i) / static_cast<double>(scenario.samples_per_cycle);
      record.normal_load.push_back(kMeanLoad * load *
                                   (1 + scenario.load_swing * std::cos(2 * kTwoPi * cycles)));
    }
    if (scenario.model == "dahl") {
      record.force =
          testing::JointForces(law, scenario.asymmetry, record.displacement, record.normal_load);
      return record;
    }
    testing::EvaluateForceUnderLoad({.friction_coefficient = law.slip_force / (kMeanLoad * load),
                                     .reference_load = kMeanLoad * load,
                                     .reference_stiffness = law.tangential_stiffness,
                                     .shape_exponent = law.shape_exponent},
                                    record.displacement, record.normal_load, record.force);
  } else {
    record.force = ForceOn(law, record.displacement, scenario.asymmetry, RigOf(scenario));
  }
  if (is_steady) LeaveOutFirstCycle(scenario, record);
  if (scenario.beside != Beside::kNothing) AddBeside(scenario, record);
  return record;
}

Record CleanRecord(const Scenario& scenario, double load, bool is_steady) {
  Record record =
      IsForced(scenario) ? ForcedRecord(scenario) : DrivenRecord(scenario, load, is_steady);
  for (double& force : record.force) force += kForceOffset;
  for (double& displacement : record.displacement) displacement += kDisplacementOffset;
  return record;
}

std::vector<Record> CleanRecords(const Scenario& scenario) {
  std::vector<Record> records;
  for (const double load : scenario.loads) {
    const bool is_later = scenario.first_is_virgin && !records.empty();
    records.push_back(CleanRecord(scenario, load, scenario.is_steady || is_later));
  }
  return records;
}

/// Half the way of the motion [m].
double Amplitude(const Scenario& scenario) {
  if (!IsForced(scenario)) return ReachOf(scenario, LawOf(scenario));
  Scenario steady = scenario;
  steady.is_steady = true;
  const auto [low, high] = std::ranges::minmax(ForcedRecord(steady).displacement);
  return (high - low) / 2;
}

/// Of one record [N].
double ForceNoise(const Scenario& scenario, double load = 1.0) {
  if (IsForced(scenario)) return 0.0;
  const BranchLaw law = LawOf(scenario);
  const double of_load = scenario.noise_follows_load ? load : 1.0;
  return of_load * scenario.force_noise *
         models::SteadyPeakForce(*models::FindFrictionModel("mindlin-dahl"), law,
                                 ReachOf(scenario, law));
}

Record NoisyRecord(const Scenario& scenario, double load, const Record& clean, Normal& normal) {
  constexpr double kCorrelation = 0.9;
  Record record = clean;
  const double force_noise = ForceNoise(scenario, load);
  constexpr std::size_t kAveraged = 5;
  std::array<double, kAveraged> recent{};  // of a moving average
  for (double& value : recent) {
    if (scenario.noise == Noise::kMovingAverage) value = force_noise * normal();
  }
  const double displacement_noise = scenario.displacement_noise * Amplitude(scenario);
  double correlated = force_noise * normal();
  double error = 0.0;                     // of the displacement
  const double phase = normal.Uniform();  // of the encoder
  for (std::size_t i = 0; i < record.size(); ++i) {
    const double white = force_noise * normal();
    if (scenario.noise == Noise::kAutoregressive) {
      record.force[i] += correlated;
      correlated = kCorrelation * correlated + std::sqrt(1 - kCorrelation * kCorrelation) * white;
    } else if (scenario.noise == Noise::kMovingAverage) {
      recent[i % kAveraged] = white;
      const double sum = std::accumulate(recent.begin(), recent.end(), 0.0);
      record.force[i] += sum / std::sqrt(static_cast<double>(kAveraged));
    } else {
      record.force[i] += white;
    }
    double& displacement = record.displacement[i];
    if (scenario.noise == Noise::kAnswer) displacement += displacement_noise * normal();
    if (scenario.noise == Noise::kDisplacement) {
      if (i % scenario.dwell == 0) error = displacement_noise * normal();
      displacement += error;
    }
    if (scenario.noise == Noise::kQuantised) {
      displacement =
          displacement_noise * (std::round(displacement / displacement_noise + phase) - phase);
    }
  }
  return record;
}

FitOptions OptionsOf(const Scenario& scenario) {
  FitOptions options;
  if (!scenario.finds_state) {
    options.initial_state =
        scenario.is_steady ? models::InitialState::kSteady : models::InitialState::kVirgin;
  }
  options.model = models::FindFrictionModel(scenario.model);
  if (IsForced(scenario) && !scenario.fits_force) {
    options.preparation.excitation = loop::Channel::kForce;
  }
  if (scenario.loads.size() > 1) {
    for (const double load : scenario.loads) options.normal_loads.push_back(kMeanLoad * load);
  }
  if (scenario.noise == Noise::kDisplacement && scenario.noise_is_known) {
    options.preparation.displacement_noise = scenario.displacement_noise * Amplitude(scenario);
  }
  if (scenario.asymmetry != 0) options.terms.emplace_back("asymmetry");
  // Of a contact that was cycled before it is told by the force's zero alone.
  if (scenario.asymmetry != 0 && scenario.is_steady) options.fixed["force_offset"] = kForceOffset;
  if (scenario.rig > 0) options.terms.emplace_back("rig_stiffness");
  if (scenario.beside == Beside::kLag) options.terms.emplace_back("lag");
  if (scenario.beside == Beside::kBacklash) options.terms.emplace_back("backlash");
  if (scenario.beside == Beside::kViscous) options.terms.emplace_back("viscous");
  if (scenario.beside == Beside::kCovariate) options.covariates.emplace_back("pressure");
  return options;
}

}  // namespace

std::vector<Scenario> Scenarios() {
  constexpr double kWhiteLow = 0.93;
  constexpr double kWhiteHigh = 0.97;
  constexpr double kPartialSlipLow = 0.92;  // Tc is not reached: the likelihood is skewed
  return {
      {.name = "white 1 %, lambda 0.9",
       .lambda = 0.9,
       .lowest_coverage = kWhiteLow,
       .highest_coverage = kWhiteHigh},
      {.name = "white 1 %, lambda 1.2",
       .lambda = 1.2,
       .lowest_coverage = kWhiteLow,
       .highest_coverage = kWhiteHigh},
      {.name = "white 5 %, lambda 2",
       .lambda = 2.0,
       .force_noise = 0.05,
       .lowest_coverage = kWhiteLow,
       .highest_coverage = kWhiteHigh},
      {.name = "white 1 %, alpha 0.7, lambda 1",
       .shape_exponent = 0.7,
       .lambda = 1.0,
       .lowest_coverage = kWhiteLow,
       .highest_coverage = kWhiteHigh},
      {.name = "AR(1) 0.9, 1 %, 3 cycles", .noise = Noise::kAutoregressive},
      {.name = "AR(1) 0.9, 1 %, 10 cycles", .cycles = 10, .noise = Noise::kAutoregressive},
      {.name = "displacement noise 0.5 %",
       .noise = Noise::kDisplacement,
       .force_noise = 0.005,
       .displacement_noise = 0.005},
      {.name = "displacement noise 2 %",
       .noise = Noise::kDisplacement,
       .force_noise = 0.005,
       .displacement_noise = 0.02},
      {.name = "encoder, 100 steps of X",
       .noise = Noise::kQuantised,
       .force_noise = 0.005,
       .displacement_noise = 0.01},
      {.name = "encoder, 50 steps of X",
       .noise = Noise::kQuantised,
       .force_noise = 0.005,
       .displacement_noise = 0.02},
      {.name = "encoder, 200 steps of X",
       .noise = Noise::kQuantised,
       .force_noise = 0.005,
       .displacement_noise = 0.005},
      {.name = "displacement noise 2 %, lambda 0.9",
       .lambda = 0.9,
       .noise = Noise::kDisplacement,
       .force_noise = 0.005,
       .displacement_noise = 0.02},
      {.name = "displacement noise 2 %, not told",
       .noise = Noise::kDisplacement,
       .force_noise = 0.005,
       .displacement_noise = 0.02,
       .noise_is_known = false},
      {.name = "displacement noise 2 %, not told, 1000 samples a cycle: it steps back",
       .samples_per_cycle = 1000,
       .noise = Noise::kDisplacement,
       .force_noise = 0.005,
       .displacement_noise = 0.02,
       .noise_is_known = false},
      {.name = "displacement noise 1 %, readings repeated 3 times",
       .noise = Noise::kDisplacement,
       .force_noise = 0.005,
       .displacement_noise = 0.01,
       .dwell = 3},
      {.name = "three loads, 0.4, 0.8 and 1.8 of the mean, p 1/3",
       .cycles = 2,
       .samples_per_cycle = 100,
       .lowest_coverage = kWhiteLow,
       .highest_coverage = kWhiteHigh,
       .loads = {0.4, 0.8, 1.8}},
      {.name = "three loads, 0.4, 0.8 and 1.8 of the mean, p 1/2, lambda 0.9",
       .lambda = 0.9,
       .cycles = 2,
       .samples_per_cycle = 100,
       .lowest_coverage = kPartialSlipLow,
       .highest_coverage = kWhiteHigh,
       .loads = {0.4, 0.8, 1.8},
       .load_exponent = 0.5},
      {.name = "load varies by 5 % at twice the frequency",
       .lowest_coverage = kWhiteLow,
       .highest_coverage = kWhiteHigh,
       .load_swing = 0.05},
      {.name = "load varies by 30 % at twice the frequency",
       .lowest_coverage = kWhiteLow,
       .highest_coverage = kWhiteHigh,
       .load_swing = 0.3},
      {.name = "near a bound: alpha 0.01", .shape_exponent = 0.01, .lambda = 1.2},
      {.name = "at a bound: alpha 0", .shape_exponent = 0.0, .lambda = 1.2},
      {.name = "white 1 %, late by 1.5 samples: lag fitted",
       .beside = Beside::kLag,
       .lowest_coverage = kWhiteLow,
       .highest_coverage = kWhiteHigh},
      {.name = "white 1 %, behind a gap of X/10: backlash fitted",
       .beside = Beside::kBacklash,
       .lowest_coverage = kWhiteLow,
       .highest_coverage = kWhiteHigh},
      {.name = "white 1 %, viscous 5 % of Tc: fitted",
       .beside = Beside::kViscous,
       .lowest_coverage = kWhiteLow,
       .highest_coverage = kWhiteHigh},
      {.name = "white 1 %, 20 % of Tc by a column: covariate fitted",
       .beside = Beside::kCovariate,
       .lowest_coverage = kWhiteLow,
       .highest_coverage = kWhiteHigh},
      {.name = "white 1 %, asymmetry 0.2 fitted",
       .lowest_coverage = kWhiteLow,
       .highest_coverage = kWhiteHigh,
       .asymmetry = 0.2},
      {.name = "white 1 %, lambda 0.9, asymmetry -0.1 fitted",
       .lambda = 0.9,
       .lowest_coverage = kPartialSlipLow,
       .highest_coverage = kWhiteHigh,
       .asymmetry = -0.1},
      {.name = "white 1 %, steady, force's zero known, asymmetry 0.2 fitted",
       .lowest_coverage = kWhiteLow,
       .highest_coverage = kWhiteHigh,
       .asymmetry = 0.2,
       .is_steady = true},
      {.name = "Dahl's own law, alpha 1, 3 knees, torque of either sign, asymmetry -0.3 fitted",
       .shape_exponent = 1.0,
       .lambda = 3.0,
       .lowest_coverage = kWhiteLow,
       .highest_coverage = kWhiteHigh,
       .asymmetry = -0.3,
       .load_swing = 2.5,
       .model = "dahl"},
      {.name = "four loads, 1 to 2.5 to 5 to 10, noise 1 % of each T*",
       .lowest_coverage = kWhiteLow,
       .highest_coverage = kWhiteHigh,
       .loads = {8.0 / 37, 20.0 / 37, 40.0 / 37, 80.0 / 37},
       .noise_follows_load = true},
      {.name = "virgin test and three steady ones, states not told",
       .lowest_coverage = kWhiteLow,
       .highest_coverage = kWhiteHigh,
       .loads = {1.0, 1.0, 1.0, 1.0},
       .first_is_virgin = true,
       .finds_state = true},
      {.name = "rig of 3 sigma fitted, lambda 1.5", .lambda = 1.5, .rig = 3.0},
      {.name = "rig of 3 sigma stated to 3 %, which is drawn, lambda 1.2",
       .lowest_coverage = 0.93,
       .rig = 3.0,
       .prior = "rig_stiffness",
       .prior_uncertainty = 0.03},
      {.name = "30 samples a cycle, late by 1.5 samples: lag fitted",
       .samples_per_cycle = 30,
       .steps_a_reading = 20,
       .beside = Beside::kLag},
      {.name = "moving average of 5, 1 %", .noise = Noise::kMovingAverage},
      {.name = "alpha 0.02", .shape_exponent = 0.02},
      {.name = "displacement noise 0.1 %, not told, 24 samples a cycle",
       .samples_per_cycle = 24,
       .noise = Noise::kDisplacement,
       .force_noise = 0.001,
       .displacement_noise = 0.001,
       .noise_is_known = false},
      {.name = "displacement noise 0.3 %, not told, 24 samples a cycle",
       .samples_per_cycle = 24,
       .noise = Noise::kDisplacement,
       .force_noise = 0.001,
       .displacement_noise = 0.003,
       .noise_is_known = false},
      {.name = "displacement noise 0.2 %, not told, 60 samples a cycle",
       .samples_per_cycle = 60,
       .noise = Noise::kDisplacement,
       .force_noise = 0.001,
       .displacement_noise = 0.002,
       .noise_is_known = false},
      {.name = "sigma known to 0.3 % before, lambda 0.6",
       .lambda = 0.6,
       .lowest_coverage = kPartialSlipLow,
       .highest_coverage = 1.0,
       .prior = "sigma",
       .prior_uncertainty = 0.003},
      {.name = "alpha known to 5 % before, lambda 0.6",
       .lambda = 0.6,
       .lowest_coverage = kPartialSlipLow,
       .highest_coverage = 1.0,
       .prior = "alpha",
       .prior_uncertainty = 0.05},
      {.name = "imposed force to 0.95 Tc, displacement noise 1 %",
       .noise = Noise::kAnswer,
       .displacement_noise = 0.01,
       .lowest_coverage = kWhiteLow,
       .highest_coverage = kWhiteHigh,
       .peak_share = 0.95},
      {.name = "imposed force to 0.95 Tc, steady, displacement noise 1 %",
       .noise = Noise::kAnswer,
       .displacement_noise = 0.01,
       .lowest_coverage = kWhiteLow,
       .highest_coverage = kWhiteHigh,
       .peak_share = 0.95,
       .is_steady = true},
      // What --noise-in displacement is there for: nothing is promised.
      {.name = "imposed force to 0.95 Tc, displacement noise 1 %, but the force is fitted",
       .noise = Noise::kAnswer,
       .displacement_noise = 0.01,
       .lowest_coverage = 0.0,
       .peak_share = 0.95,
       .fits_force = true},
      {.name = "imposed force to 0.95 Tc, steady, displacement noise 1 %, but the force is fitted",
       .noise = Noise::kAnswer,
       .displacement_noise = 0.01,
       .lowest_coverage = 0.0,
       .peak_share = 0.95,
       .is_steady = true,
       .fits_force = true},
      {.name = "imposed force to 0.8 Tc, displacement noise 0.3 %",
       .noise = Noise::kAnswer,
       .displacement_noise = 0.003,
       .lowest_coverage = kPartialSlipLow,
       .highest_coverage = kWhiteHigh,
       .peak_share = 0.8},
      {.name = "imposed force to 0.95 Tc, Dahl's own law, displacement noise 1 %",
       .noise = Noise::kAnswer,
       .displacement_noise = 0.01,
       .lowest_coverage = kWhiteLow,
       .highest_coverage = kWhiteHigh,
       .peak_share = 0.95,
       .model = "dahl"},
      {.name = "imposed force to 0.95 Tc, Dahl's own law, steady, displacement noise 1 %",
       .noise = Noise::kAnswer,
       .displacement_noise = 0.01,
       .lowest_coverage = kWhiteLow,
       .highest_coverage = kWhiteHigh,
       .peak_share = 0.95,
       .is_steady = true,
       .model = "dahl"},
  };
}

namespace {

double PriorTruth(const Scenario& scenario) {
  if (scenario.prior == "rig_stiffness") return RigOf(scenario).stiffness;
  const BranchLaw law = LawOf(scenario);
  if (scenario.prior == "alpha") return law.shape_exponent;
  return scenario.prior == "sigma" ? law.tangential_stiffness : law.slip_force;
}

/// Takes the logarithm of a positive parameter as normal, and α itself.
identification::Prior PriorAt(const Scenario& scenario, double value) {
  const double of = scenario.prior == "alpha" ? PriorTruth(scenario) : value;
  return {value, scenario.prior_uncertainty * of};
}

}  // namespace

Coverage Measure(const Scenario& scenario, std::size_t loops, std::uint64_t first_seed) {
  const BranchLaw law = LawOf(scenario);
  const bool is_asymmetric = scenario.asymmetry != 0;
  const std::array<double, Coverage::kParameters> truth = {
      law.tangential_stiffness, law.shape_exponent, law.slip_force,
      is_asymmetric                          ? scenario.asymmetry
      : scenario.rig > 0                     ? RigOf(scenario).stiffness
      : scenario.beside == Beside::kLag      ? 1.5 * StepOf(scenario)
      : scenario.beside == Beside::kBacklash ? GapOf(scenario)
                                             : scenario.load_exponent};
  const std::array<std::string_view, Coverage::kParameters> names = {"sigma", "alpha", "slip_force",
                                                                     scenario.FourthParameter()};
  const std::size_t parameters = names.back().empty() ? truth.size() - 1 : truth.size();
  const std::vector<Record> clean = CleanRecords(scenario);
  FitOptions options = OptionsOf(scenario);

  // The bound of Cramér and Rao for white noise of what is fitted: the parabola at the truth.
  std::array<double, Coverage::kParameters> bound{};
  FitOptions known = options;
  known.preparation.displacement_noise.reset();
  if (IsForced(scenario)) {
    known.preparation.excitation = loop::Channel::kForce;
    known.preparation.displacement_noise = scenario.displacement_noise * Amplitude(scenario);
  } else {
    known.force_noise = ForceNoise(scenario);
  }
  if (!scenario.prior.empty()) {
    known.priors[scenario.prior] = PriorAt(scenario, PriorTruth(scenario));
  }
  const identification::FitResult at_truth = identification::Fit(clean, known);
  for (std::size_t k = 0; k < parameters; ++k) {
    bound[k] = at_truth.Find(names[k])->standard_error.value_or(0.0);
  }

  Coverage coverage;
  coverage.loops = loops;
  coverage.parameters = parameters;
  std::array<double, Coverage::kParameters> sum{};
  std::array<double, Coverage::kParameters> squares{};
  std::array<double, Coverage::kParameters> stated{};
  std::array<double, Coverage::kParameters> with_error{};
  for (std::size_t i = 0; i < loops; ++i) {
    Normal normal(first_seed + i);
    std::vector<Record> records;
    for (std::size_t r = 0; r < clean.size(); ++r) {
      records.push_back(NoisyRecord(scenario, scenario.loads[r], clean[r], normal));
    }
    FitOptions of_loop = options;
    if (!scenario.prior.empty()) {
      const double drawn = scenario.prior_uncertainty * normal();
      of_loop.priors[scenario.prior] =
          PriorAt(scenario,
                  PriorTruth(scenario) * (scenario.prior == "alpha" ? 1 + drawn : std::exp(drawn)));
    }
    const identification::FitResult fit = identification::Fit(records, of_loop);
    const bool is_adequate = fit.adequacy.verdict == identification::AdequacyVerdict::kAdequate;
    coverage.doubted += is_adequate ? 0.0 : 1 / static_cast<double>(loops);
    coverage.rejected += fit.adequacy.p_value < 0.05 ? 1 / static_cast<double>(loops) : 0.0;
    for (std::size_t k = 0; k < parameters; ++k) {
      const identification::ParameterEstimate& estimate = *fit.Find(names[k]);
      const bool covers = (!estimate.lower95 || *estimate.lower95 <= truth[k]) &&
                          (!estimate.upper95 || truth[k] <= *estimate.upper95);
      if (covers) ++coverage.covered[k];
      const double error = estimate.value - truth[k];
      sum[k] += error;
      squares[k] += error * error;
      if (estimate.standard_error) {
        stated[k] += *estimate.standard_error * *estimate.standard_error;
        ++with_error[k];
      }
    }
  }
  const auto count = static_cast<double>(loops);
  for (std::size_t k = 0; k < parameters; ++k) {
    const double mean = sum[k] / count;
    const double scatter = std::sqrt(std::max(squares[k] / count - mean * mean, 0.0));
    coverage.covered[k] /= count;
    coverage.error_ratio[k] = std::sqrt(stated[k] / with_error[k]) / scatter;
    coverage.efficiency[k] = bound[k] * bound[k] / (scatter * scatter);
    coverage.bias[k] = mean / scatter;
  }
  return coverage;
}

}  // namespace mindahl::coverage
