#include "mindahl/convert/conversion.h"

#include <fmt/args.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <map>
#include <numeric>
#include <variant>

#include "core/text.h"
#include "mindahl/core/error.h"
#include "mindahl/models/steady_loop.h"

namespace mindahl::convert {

using methods::IwanElements;
using models::FindFrictionModel;

namespace {

constexpr std::array kMasing = {
    ParameterRow{"sigma", "k", "N/m", "stiffness at the start of a branch"},
    ParameterRow{"alpha", "alpha", "-", "shape exponent"},
    ParameterRow{"slip_force", "Tc", "N", "slip force"}};
constexpr std::array kDahl = {ParameterRow{"sigma", "k", "N/m", "dT/dx at T = 0"}, kMasing[1],
                              kMasing[2]};
constexpr std::array kLuGre = {
    ParameterRow{"sigma0", "k", "N/m", "bristles' stiffness"},
    ParameterRow{"Fc", "Tc", "N", "Coulomb's force, and the static one"}};
constexpr std::array kBoucWen = {ParameterRow{"k", "k", "N/m", "stiffness k of force = k z"},
                                 ParameterRow{"n", "n", "-", "exponent"},
                                 ParameterRow{"beta", "beta", "1/m^n", "factor of |z|^n sgn(z dx)"},
                                 ParameterRow{"gamma", "gamma", "1/m^n", "of |z|^n"},
                                 ParameterRow{"slip_force", "Tc", "N", "k (beta + gamma)^(-1/n)"}};
constexpr std::array kElements = {ParameterRow{"sigma", "k", "N/m", "sum of the stiffnesses"},
                                  ParameterRow{"slip_force", "Tc", "N", "sum of the slip forces"}};
constexpr std::array kLammps = {ParameterRow{"kt", "k", "N/m", "of tangential linear_history"},
                                ParameterRow{"slip_force", "Tc", "N", "Coulomb's limit"},
                                ParameterRow{"mu", "mu", "-", "friction, Tc/N"}};

constexpr std::array kTargets = {
    TargetRow{"masing", "Masing's law (mindlin-dahl)", Form::kMasing, kMasing,
              "--model mindlin-dahl --sigma {k} --alpha {alpha} --slip-force {Tc}"},
    TargetRow{"dahl", "Dahl's own law", Form::kDahl, kDahl,
              "--model dahl --sigma {k} --alpha {alpha} --slip-force {Tc}"},
    TargetRow{"lugre", "LuGre without rate: Dahl's law of α = 1", Form::kExponential, kLuGre,
              "sigma0 = {k}\nsigma1 = 0\nsigma2 = 0\nFc = {Tc}\nFs = {Tc}"},
    TargetRow{"bouc-wen", "Bouc's and Wen's law", Form::kBoucWen, kBoucWen,
              "# OpenSees, force in N and displacement in m: tag alpha ko n gamma beta Ao deltaA "
              "deltaNu deltaEta\n"
              "uniaxialMaterial BoucWen 1 0.0 {k} {n} {gamma} {beta} 1.0 0.0 0.0 0.0"},
    TargetRow{"iwan", "Jenkins elements in parallel", Form::kElements, kElements,
              "# OpenSees, force in N and displacement in m: tag, stiffness, displacement at slip"},
    TargetRow{"lammps", "a tangential spring with Coulomb's limit", Form::kSpring, kLammps,
              "# LAMMPS, pair_style granular in SI units, behind the normal model of pair_coeff\n"
              "tangential linear_history {k} 0.0 {mu}"},
};

SteadyLaw LawOf(const ModelLaw& contact, Form form, const ConversionOptions& options) {
  const double amplitude = options.amplitude;
  const bool is_masing = contact.model->memory == models::Memory::kReturnPoint;
  const models::FrictionModel& masing = *FindFrictionModel("mindlin-dahl");
  const models::FrictionModel& dahl = *FindFrictionModel("dahl");
  const auto masing_law = [&] {
    return is_masing ? contact.law : models::MasingEquivalent(contact.law, amplitude);
  };
  switch (form) {
    case Form::kMasing:
      return ModelLaw{&masing, masing_law()};
    case Form::kDahl:
      return ModelLaw{&dahl,
                      is_masing ? models::DahlEquivalent(contact.law, amplitude) : contact.law};
    case Form::kExponential:
      return ModelLaw{&dahl, SamePeakAndEnergy(contact, amplitude, dahl, 1.0)};
    case Form::kBoucWen:
      return BoucWenOf(contact, amplitude);
    case Form::kElements:
      return methods::MakeIwanElements(masing_law(), options.elements);
    case Form::kSpring:
      break;
  }
  return ModelLaw{&masing, SamePeakAndEnergy(contact, amplitude, masing, 0.0)};
}

/// Returns the amplitudes [m] at which the error is looked at, in order from X to a hundred times
/// as much, or to a hundredth. Where two loops bend elsewhere, the error has a lobe from one corner
/// to the next: the corners are among the places, and kBetween between any two of them.
std::vector<double> PlacesFrom(double amplitude, bool is_up, std::span<const double> corners) {
  constexpr double kReach = 100.0;
  constexpr int kSteps = 20;
  constexpr int kBetween = 3;
  constexpr double kClosest = 5e-3;  // of a corner to the place before it, relative
  std::vector<double> ways;          // factors by which the amplitude grows or falls
  for (int i = 1; i <= kSteps; ++i) ways.push_back(std::pow(kReach, i / double{kSteps}));
  for (const double corner : corners) {
    const double way = is_up ? corner / amplitude : amplitude / corner;
    if (way > 1 && way < kReach) ways.push_back(way);
  }
  std::ranges::sort(ways);
  std::vector<double> places = {amplitude};
  double last = 1.0;
  for (const double way : ways) {
    if (way < last * (1 + kClosest)) continue;
    last = way;
    const double from = places.back();
    const double to = is_up ? amplitude * way : amplitude / way;
    for (int j = 1; j <= kBetween + 1; ++j) {
      places.push_back(std::lerp(from, to, static_cast<double>(j) / (kBetween + 1)));
    }
  }
  return places;
}

/// Returns the last amplitude from X on up to which an error is within the tolerance, also at its
/// largest between the places.
template <typename Error>
double EdgeOf(const Error& error, double tolerance, std::span<const double> places) {
  constexpr int kHalvings = 10;
  constexpr int kBits = 16;
  constexpr double kNear = 0.5;  // of the tolerance: a lobe below has none that passes it
  const auto edge_between = [&](double inside, double outside) {
    for (int j = 0; j < kHalvings; ++j) {
      const double middle = std::midpoint(inside, outside);
      (error(middle) <= tolerance ? inside : outside) = middle;
    }
    return inside;
  };
  std::array errors = {0.0, error(places[0])};  // at the last two places
  for (std::size_t k = 1; k < places.size(); ++k) {
    const double next = error(places[k]);
    if (next > tolerance) return edge_between(places[k - 1], places[k]);
    if (errors[1] >= std::max({errors[0], next, kNear * tolerance})) {
      const double before = places[k > 1 ? k - 2 : 0];
      const auto between = [&](double part) { return std::lerp(before, places[k], part); };
      const auto [part, negative] = boost::math::tools::brent_find_minima(
          [&](double at) { return -error(between(at)); }, 0.0, 1.0, kBits);
      if (-negative > tolerance) return edge_between(before, between(part));
    }
    errors = {errors[1], next};
  }
  return places.back();
}

/// Returns the values of a law that are known, by their keys.
std::map<std::string_view, double> ValuesOf(const SteadyLaw& law,
                                            const ConversionOptions& options) {
  std::map<std::string_view, double> values;
  if (const auto* bouc_wen = std::get_if<BoucWenLaw>(&law)) {
    const auto& [stiffness, slip_force, exponent] = *bouc_wen;
    // γ and β of dz/dx = A − |z|ⁿ(γ + β·sgn(z·ẋ)) with A = 1 and z = T/k: over z*ⁿ, z* = Tc/k.
    values = {{"k", stiffness}, {"Tc", slip_force}, {"n", exponent}};
    values["beta"] = values["gamma"] = 0.5 * std::pow(stiffness / slip_force, exponent);
  } else if (const auto* elements = std::get_if<IwanElements>(&law)) {
    values["k"] = std::accumulate(elements->stiffness.begin(), elements->stiffness.end(), 0.0);
    values["Tc"] = std::accumulate(elements->slip_force.begin(), elements->slip_force.end(), 0.0);
  } else {
    const auto& [stiffness, shape_exponent, slip_force] = std::get<ModelLaw>(law).law;
    values = {{"k", stiffness}, {"alpha", shape_exponent}, {"Tc", slip_force}};
  }
  if (options.normal_load) values["mu"] = values["Tc"] / *options.normal_load;
  return values;
}

/// Returns the lines that the target reads.
std::vector<std::string> LinesOf(const SteadyLaw& law, const TargetRow& target,
                                 const std::map<std::string_view, double>& values) {
  fmt::dynamic_format_arg_store<fmt::format_context> store;
  for (const auto& [key, value] : values) {
    store.push_back(fmt::arg(std::string(key).c_str(), value));
  }
  const std::string text = fmt::vformat(target.lines, store);
  const std::vector<std::string_view> parts = PartsOf(text, '\n');
  std::vector<std::string> lines(parts.begin(), parts.end());
  if (const auto* elements = std::get_if<IwanElements>(&law)) {
    std::string tags;
    for (std::size_t j = 0; j < elements->size(); ++j) {
      lines.push_back(fmt::format("uniaxialMaterial ElasticPP {} {} {}", j + 1,
                                  elements->stiffness[j],
                                  elements->slip_force[j] / elements->stiffness[j]));
      tags += fmt::format(" {}", j + 1);
    }
    lines.push_back(fmt::format("uniaxialMaterial Parallel {}{}", elements->size() + 1, tags));
  }
  return lines;
}

}  // namespace

std::span<const TargetRow> Targets() { return kTargets; }

Conversion Convert(const ModelLaw& contact, const TargetRow& target,
                   const ConversionOptions& options) {
  models::Validate(contact.law);
  RequirePositive("amplitude [m]", options.amplitude);
  if (!(options.tolerance > 0 && options.tolerance < 1)) {
    ThrowInvalid("tolerance [-]", options.tolerance, "must be in (0, 1)");
  }
  if (options.normal_load) RequirePositive("--normal-load [N]", *options.normal_load);
  if (options.normal_load && target.form != Form::kSpring) {
    throw InputError("--normal-load has no effect unless --to is lammps: leave it out");
  }
  if (options.elements != ConversionOptions().elements && target.form != Form::kElements) {
    throw InputError("--elements has no effect unless --to is iwan: leave it out");
  }
  Conversion conversion;
  conversion.law = LawOf(contact, target.form, options);
  conversion.at_amplitude = CompareLoops(conversion.law, contact, options.amplitude);
  const auto error = [&](double amplitude) {
    const LoopError at = CompareLoops(conversion.law, contact, amplitude);
    return std::max(at.force, std::abs(at.energy));
  };
  if (error(options.amplitude) <= options.tolerance) {
    std::vector<double> corners = LoopOf(conversion.law, options.amplitude).corners;
    const std::vector<double> own = LoopOf(contact, options.amplitude).corners;
    corners.insert(corners.end(), own.begin(), own.end());
    // An element slips from the amplitude on at which the whole branch, of 2X, is as long.
    for (double& corner : corners) corner /= 2;
    const auto edge = [&](bool is_up) {
      return EdgeOf(error, options.tolerance, PlacesFrom(options.amplitude, is_up, corners));
    };
    conversion.within = {edge(false), edge(true)};
  }
  const std::map<std::string_view, double> values = ValuesOf(conversion.law, options);
  for (const ParameterRow& row : target.parameters) {
    if (values.contains(row.key)) conversion.parameters.push_back({row, values.at(row.key)});
  }
  if (target.form != Form::kSpring || options.normal_load) {
    conversion.input_lines = LinesOf(conversion.law, target, values);
  }
  return conversion;
}

}  // namespace mindahl::convert
