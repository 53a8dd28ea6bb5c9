#include "other_laws.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <utility>

#include "mindahl/core/error.h"
#include "mindahl/identification/fit.h"
#include "mindahl/methods/iwan.h"
#include "simulation.h"

namespace mindahl::reliability {
namespace {

using identification::FitResult;
using identification::Identifiability;
using identification::ParameterEstimate;
using loop::Record;

/// What is common to all loops.
struct Setting {
  double slip_force = 1.0;  ///< [N]
  double travel = 1.0;      ///< [m]: Tc/σ
  double amplitude = 1.0;   ///< [m]
  Record dense;             ///< motion with kDense times the samples; force still 0
};

constexpr std::size_t kDense = 16;

Setting DrawSetting(Draws& draws) {
  Setting setting;
  setting.slip_force = draws.LogUniform(1e-2, 1e3);
  setting.travel = draws.LogUniform(1e-7, 1e-3);
  setting.amplitude = setting.travel * draws.LogUniform(6.0, 25.0);
  const std::size_t cycles = 3 + draws.Index(4);
  const std::size_t samples = kDense * (200 + draws.Index(301));
  const bool is_sine = draws.Index(2) == 0;
  for (std::size_t i = 0; i <= cycles * samples; ++i) {
    const double turns = static_cast<double>(i) / static_cast<double>(samples);
    const double sine = std::sin(2 * std::numbers::pi * turns);
    // The same turning points: a triangle is the arcsine of the sine.
    const double wave = is_sine ? sine : 2 / std::numbers::pi * std::asin(sine);
    setting.dense.time.push_back(turns);
    setting.dense.displacement.push_back(setting.amplitude * wave);
  }
  setting.dense.force.resize(setting.dense.displacement.size());
  return setting;
}

/// Speed [amplitudes a cycle] on the way to a sample.
double SpeedAt(const Setting& setting, std::size_t i) {
  const std::size_t k = std::max<std::size_t>(i, 1);
  const Record& dense = setting.dense;
  return std::abs(dense.displacement[k] - dense.displacement[k - 1]) /
         (dense.time[k] - dense.time[k - 1]) / setting.amplitude;
}

constexpr double kFastest = 2 * std::numbers::pi;  // of a sine [amplitudes a cycle]

/// Force at a place of the last stroke, from where the motion last passed the middle.
double MiddleForce(const Record& dense) {
  std::size_t i = dense.size() - 1;
  const auto is_past = [&](std::size_t k) {
    return dense.displacement[k - 1] * dense.displacement[k] <= 0;
  };
  // The record ends in the middle of its motion.
  for (i -= 2; i > 1 && !is_past(i); --i) {
  }
  return std::abs(dense.force[dense.size() - 1] - dense.force[i]) / 2;
}

/// From the stiffness at the last reversal to that of the chord to where the force has changed by a
/// tenth of the gap: chords fall in proportion to that change, to first order. Nothing where the
/// contact stands still there.
std::optional<Range> StiffnessAfterReversal(const Record& dense, double plateau) {
  std::size_t turn = dense.size() - 2;
  while (turn > 1 && (dense.displacement[turn + 1] - dense.displacement[turn]) *
                             (dense.displacement[turn] - dense.displacement[turn - 1]) >
                         0) {
    --turn;
  }
  const auto change_at = [&](std::size_t i) {
    return std::abs(dense.force[i] - dense.force[turn]);
  };
  const auto chord_to = [&](std::size_t i) {
    return (dense.force[i] - dense.force[turn]) /
           (dense.displacement[i] - dense.displacement[turn]);
  };
  const auto reach = [&](double share) {
    std::size_t i = turn + 1;
    while (i + 1 < dense.size() && change_at(i) < share * 2 * plateau) ++i;
    return i;
  };
  const std::size_t near = reach(0.01);
  const std::size_t far = std::max(reach(0.1), near + 1);
  const double at_reversal = chord_to(near) + (chord_to(near) - chord_to(far)) * change_at(near) /
                                                  (change_at(far) - change_at(near));
  if (!std::isfinite(at_reversal)) return std::nullopt;
  return Range{std::min(at_reversal, chord_to(far)), std::max(at_reversal, chord_to(far))};
}

/// A record of every kDense-th sample, with noise and offsets, and what is true of it.
OtherLoop Recorded(const Setting& setting, Draws& draws) {
  OtherLoop loop;
  loop.plateau = MiddleForce(setting.dense);
  loop.stiffness = StiffnessAfterReversal(setting.dense, loop.plateau);
  const double noise = setting.slip_force * draws.LogUniform(0.001, 0.01);
  const double offset = setting.slip_force * draws.Uniform(-1.0, 1.0);
  const double start = setting.amplitude * draws.Uniform(-2.0, 2.0);
  for (std::size_t i = 0; i < setting.dense.size(); i += kDense) {
    loop.record.time.push_back(setting.dense.time[i]);
    loop.record.displacement.push_back(setting.dense.displacement[i] + start);
    loop.record.force.push_back(setting.dense.force[i] + offset + noise * draws.Normal());
  }
  return loop;
}

double Stribeck(double speed, double excess, double scale) {
  return 1 + excess * std::exp(-(speed / scale) * (speed / scale));
}

/// dz/dx = 1 − sgn(ẋ)·z/g(ẋ), exact over a step of constant speed; F = z.
OtherLoop LuGre(Draws& draws) {
  Setting setting = DrawSetting(draws);
  const double excess = draws.Uniform(0.0, 0.3);
  const double scale = kFastest * draws.Uniform(0.05, 0.5);
  const double stiffness = setting.slip_force / setting.travel;
  Record& dense = setting.dense;
  double force = 0.0;
  for (std::size_t i = 1; i < dense.size(); ++i) {
    const double step = dense.displacement[i] - dense.displacement[i - 1];
    const double limit =
        std::copysign(setting.slip_force * Stribeck(SpeedAt(setting, i), excess, scale), step);
    force = limit + (force - limit) * std::exp(-stiffness * std::abs(step / limit));
    dense.force[i] = force;
  }
  return Recorded(setting, draws);
}

/// dz/dx = 1 − (β·sgn(ẋz) + 1 − β)·|z|ⁿ by the midpoint rule in steps of a hundredth of the travel.
OtherLoop BoucWen(Draws& draws) {
  Setting setting = DrawSetting(draws);
  const double power = draws.Uniform(1.0, 3.0);
  const double beta = draws.Uniform(0.5, 1.0);
  Record& dense = setting.dense;
  const auto slope = [&](double z, double direction) {
    return 1 - (beta * (z * direction > 0 ? 1 : -1) + 1 - beta) * std::pow(std::abs(z), power);
  };
  double z = 0.0;
  for (std::size_t i = 1; i < dense.size(); ++i) {
    const double way = (dense.displacement[i] - dense.displacement[i - 1]) / setting.travel;
    const int steps = 1 + static_cast<int>(100 * std::abs(way));
    const double step = way / steps;
    for (int k = 0; k < steps; ++k) {
      const double half = z + step / 2 * slope(z, way);
      z += step * slope(half, way);
    }
    dense.force[i] = setting.slip_force * z;
  }
  return Recorded(setting, draws);
}

models::BranchLaw MasingLaw(const Setting& setting, Draws& draws) {
  return {setting.slip_force / setting.travel, draws.Uniform(0.0, 1.0), setting.slip_force};
}

/// Masing's law whose force falls with the speed.
OtherLoop FallingWithSpeed(Draws& draws) {
  Setting setting = DrawSetting(draws);
  const double excess = draws.Uniform(0.05, 0.4);
  const double scale = kFastest * draws.Uniform(0.1, 0.6);
  Masing(MasingLaw(setting, draws))(setting.dense.displacement, setting.dense.force);
  for (std::size_t i = 0; i < setting.dense.size(); ++i) {
    setting.dense.force[i] *= Stribeck(SpeedAt(setting, i), excess, scale);
  }
  return Recorded(setting, draws);
}

/// Elements of one stiffness, their slip forces normal with a deviation of a fifth to a half.
OtherLoop SixtyGaussianAsperities(Draws& draws) {
  constexpr std::size_t kAsperities = 60;
  Setting setting = DrawSetting(draws);
  const double deviation = draws.Uniform(0.2, 0.5);
  methods::IwanElements elements;
  for (std::size_t i = 0; i < kAsperities; ++i) {
    elements.stiffness.push_back(setting.slip_force / setting.travel / kAsperities);
    elements.slip_force.push_back(setting.slip_force / kAsperities *
                                  std::max(0.01, 1 + deviation * draws.Normal()));
  }
  methods::EvaluateIwanForce(elements, setting.dense.displacement, setting.dense.force);
  return Recorded(setting, draws);
}

/// A force times 1 + b₁ξ + b₂ξ², other coefficients for either direction.
OtherLoop OfPosition(Draws& draws) {
  Setting setting = DrawSetting(draws);
  std::array<std::array<double, 2>, 2> b{};
  const double size = draws.Uniform(0.05, 0.3);
  for (auto& of_direction : b) {
    for (double& coefficient : of_direction) coefficient = size * draws.Uniform(-1.0, 1.0);
  }
  Record& dense = setting.dense;
  Masing(MasingLaw(setting, draws))(dense.displacement, dense.force);
  for (std::size_t i = 0; i < dense.size(); ++i) {
    // By the sign of the force, so that nothing jumps at a reversal.
    const auto& [linear, quadratic] = b[dense.force[i] > 0 ? 1 : 0];
    const double place = dense.displacement[i] / setting.amplitude;
    dense.force[i] *= 1 + place * (linear + place * quadratic);
  }
  return Recorded(setting, draws);
}

/// A contact that follows the motion by half a gap behind.
OtherLoop WithBacklash(Draws& draws) {
  Setting setting = DrawSetting(draws);
  const double half_gap = setting.amplitude * draws.Uniform(0.01, 0.1);
  std::vector<double> contact;
  double at = 0.0;
  for (const double x : setting.dense.displacement) {
    contact.push_back(at = std::clamp(at, x - half_gap, x + half_gap));
  }
  Masing(MasingLaw(setting, draws))(contact, setting.dense.force);
  OtherLoop loop = Recorded(setting, draws);
  loop.stiffness.reset();
  return loop;
}

/// Elements of one stiffness with the density φ^χ of slip displacements, up to the largest.
OtherLoop PowerLawSpectrum(Draws& draws) {
  constexpr std::size_t kElements = 200;
  Setting setting = DrawSetting(draws);
  const double exponent = draws.Uniform(-0.8, 0.0);
  methods::IwanElements elements;
  double sum = 0.0;
  for (std::size_t i = 0; i < kElements; ++i) {
    const double share = (static_cast<double>(i) + 0.5) / kElements;
    elements.stiffness.push_back(setting.slip_force / setting.travel / kElements);
    elements.slip_force.push_back(std::pow(share, 1 / (exponent + 1)));
    sum += elements.slip_force.back();
  }
  for (double& force : elements.slip_force) force *= setting.slip_force / sum;
  methods::EvaluateIwanForce(elements, setting.dense.displacement, setting.dense.force);
  return Recorded(setting, draws);
}

/// Masing's law with a force of the motion beside it.
template <typename Force>
OtherLoop Beside(Setting setting, Draws& draws, Force force) {
  Record& dense = setting.dense;
  Masing(MasingLaw(setting, draws))(dense.displacement, dense.force);
  for (std::size_t i = 0; i < dense.size(); ++i) dense.force[i] += setting.slip_force * force(i);
  return Recorded(setting, draws);
}

OtherLoop BesideASpring(Draws& draws) {
  const Setting setting = DrawSetting(draws);
  const double size = draws.Uniform(0.05, 0.3);
  return Beside(setting, draws, [&](std::size_t i) {
    return size * setting.dense.displacement[i] / setting.amplitude;
  });
}

OtherLoop BesideADashpot(Draws& draws) {
  const Setting setting = DrawSetting(draws);
  const double size = draws.Uniform(0.05, 0.3);
  OtherLoop loop = Beside(setting, draws, [&](std::size_t i) {
    const std::size_t k = std::max<std::size_t>(i, 1);
    const double step = setting.dense.displacement[k] - setting.dense.displacement[k - 1];
    return std::copysign(size * SpeedAt(setting, i) / kFastest, step);
  });
  loop.stiffness.reset();  // of a triangle the force jumps
  return loop;
}

constexpr std::array<OtherLaw, 9> kLaws = {{
    {"LuGre", Half::kDevelopment, LuGre, "static friction 0 to 30 % above the kinetic"},
    {"Bouc-Wen", Half::kDevelopment, BoucWen, "n of 1 to 3, beta of 0.5 to 1, beta + gamma = 1"},
    {"Stribeck", Half::kDevelopment, FallingWithSpeed,
     "Masing's law, alpha of 0 to 1, whose force falls with the speed by 5 to 40 %"},
    {"sixty Gaussian asperities", Half::kDevelopment, SixtyGaussianAsperities,
     "of one stiffness, slip forces with a deviation of 20 to 50 %"},
    {"friction of the position", Half::kDevelopment, OfPosition,
     "linear and quadratic, up to 5 to 30 % each, other coefficients in either direction"},
    {"backlash", Half::kDevelopment, WithBacklash, "2 to 20 % of the amplitude"},
    {"power-law spectrum", Half::kHeldOut, PowerLawSpectrum,
     "Iwan's elements, exponents of -0.8 to 0"},
    {"spring beside the contact", Half::kHeldOut, BesideASpring,
     "Masing's law, alpha of 0 to 1; 5 to 30 % of Tc at the amplitude"},
    {"dashpot beside the contact", Half::kHeldOut, BesideADashpot,
     "Masing's law, alpha of 0 to 1; 5 to 30 % of Tc at the highest speed of a sine"},
}};

/// Errors and half widths of a parameter, over its truth.
struct Widths {
  std::vector<double> errors;
  std::vector<double> half_widths;
};

double Quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  std::ranges::sort(values);
  const auto last = static_cast<double>(values.size() - 1);
  return values[static_cast<std::size_t>(std::lround(share * last))];
}

void Count(const ParameterEstimate* estimate, const Range& truth, Effective& tally,
           Widths& widths) {
  ++tally.loops;
  const bool is_given =
      estimate != nullptr && estimate->identifiability == Identifiability::kEffective;
  if (!is_given) return;
  ++tally.given;
  const double value = estimate->value;
  const double half_width = (*estimate->upper95 - *estimate->lower95) / 2;
  const double error = std::max({0.0, truth.lowest - value, value - truth.highest});
  widths.errors.push_back(error / truth.highest);
  widths.half_widths.push_back(half_width / truth.highest);
  constexpr double kNarrow = 0.25;  // of the value
  if (*estimate->lower95 <= truth.highest && *estimate->upper95 >= truth.lowest) {
    ++tally.held;
  } else if (half_width <= kNarrow * value) {
    ++tally.narrow;
  }
}

}  // namespace

std::span<const OtherLaw> OtherLaws() { return kLaws; }

EffectiveTally Measure(const OtherLaw& law, std::size_t loops, std::uint64_t seed) {
  EffectiveTally tally;
  Widths of_slip_force;
  Widths of_stiffness;
  for (std::size_t i = 0; i < loops; ++i) {
    Draws draws(seed + i);
    const OtherLoop loop = law.make(draws);
    FitResult fit;
    try {
      fit = identification::Fit({&loop.record, 1});
    } catch (const InvalidArgument&) {
      // Refused: nothing is given.
    }
    if (!fit.converged) fit.parameters.clear();
    if (fit.adequacy.verdict == identification::AdequacyVerdict::kAdequate) {
      ++tally.adequate;
      continue;
    }
    Count(fit.Find("slip_force"), {loop.plateau, loop.plateau}, tally.slip_force, of_slip_force);
    if (loop.stiffness) Count(fit.Find("sigma"), *loop.stiffness, tally.stiffness, of_stiffness);
  }
  for (auto [effective, widths] :
       {std::pair(&tally.slip_force, &of_slip_force), std::pair(&tally.stiffness, &of_stiffness)}) {
    const double error = Quantile(widths->errors, 0.95);
    effective->inflation = error > 0 ? Quantile(widths->half_widths, 0.5) / error : 0.0;
  }
  return tally;
}

}  // namespace mindahl::reliability
