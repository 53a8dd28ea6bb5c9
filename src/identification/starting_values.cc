#include "identification/starting_values.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>

#include "identification/force_residual.h"
#include "mindahl/models/response.h"

namespace mindahl::identification {

using models::InitialState;

namespace {

constexpr std::array kReaches = {0.02, 0.05, 0.1, 0.2, 0.4, 0.7, 1.0,  // σX/Tc
                                 1.5,  2.5,  4.0, 7.0, 15., 40., 150.};
constexpr std::array kShapeExponents = {0.0, 1.0 / 3.0, 1.0, 2.5};
constexpr std::array kRigRatios = {0.1, 0.5, 2.0, 10.0};  // σ/k_r
constexpr int kSubdivisions = 5;
constexpr int kRefinements = 3;

constexpr double kHighestDrawnShape = 3.0;
constexpr std::size_t kDrawsPerStart = 20;  // the regression refuses some of them

/// Weighted sums for the regression of force on normalised response, one record:
/// force = Tc·t + F₀.
struct Regression {
  double count = 0.0;
  double t = 0.0;
  double tt = 0.0;
  double force = 0.0;
  double t_force = 0.0;
};

Regression Accumulate(std::span<const double> response, const ScaledRecord& record) {
  Regression sums;
  for (std::size_t i = 0; i < response.size(); ++i) {
    const double weight = record.root_weight[i] * record.root_weight[i];
    const double t = record.load_ratio.empty() ? response[i] : response[i] * record.load_ratio[i];
    sums.count += weight;
    sums.t += weight * t;
    sums.tt += weight * t * t;
    sums.force += weight * record.force[i];
    sums.t_force += weight * t * record.force[i];
  }
  return sums;
}

/// Least-squares Tc over all records; an offset of its own for each unless it is fixed.
double RegressSlipForce(std::span<const Regression> records, const ParameterLayout& layout) {
  double numerator = 0.0;
  double denominator = 0.0;
  for (std::size_t r = 0; r < records.size(); ++r) {
    const Regression& sums = records[r];
    const ScaledParameter& offset = layout.parameters()[ParameterLayout::OfRecord(r, kForceOffset)];
    if (offset.fixed) {
      numerator += sums.t_force - offset.theta * sums.t;
      denominator += sums.tt;
    } else {
      numerator += sums.t_force - sums.t * sums.force / sums.count;
      denominator += sums.tt - sums.t * sums.t / sums.count;
    }
  }
  return denominator > 0 ? numerator / denominator : 0.0;
}

class StartingGrid {
 public:
  StartingGrid(const ScaledRecords& data, const ParameterLayout& layout, const FitOptions& options,
               InitialState state)
      : data_(data),
        layout_(layout),
        model_(*options.model),
        state_(state),
        residual_(data, *options.model, state, layout) {}

  /// Paths for one guess of where the contact was unloaded, in the units of each record.
  void SetUnloaded(const std::vector<double>& unloaded) {
    unloaded_ = unloaded;
    paths_.clear();
    for (std::size_t r = 0; r < data_.records.size(); ++r) {
      const ScaledRecord& record = data_.records[r];
      paths_.push_back(
          models::MakeLoadingPath(record.displacement, record.reversals, model_.memory,
                                  {.state = state_, .unloaded_displacement = unloaded_[r]}));
    }
  }

  /// @param reach       σX/Tc of contact and rig together, as the loop shows it
  /// @param rig_ratio   σ/k_r, looked at where there is a rig of unknown stiffness
  [[nodiscard]] StartingPoint At(double reach, double shape_exponent, double rig_ratio) const {
    const std::vector<ScaledParameter>& parameters = layout_.parameters();
    StartingPoint point;
    point.theta.resize(parameters.size());
    for (std::size_t i = 0; i < parameters.size(); ++i) point.theta[i] = parameters[i].theta;
    point.sum_of_squares = std::numeric_limits<double>::infinity();

    const ScaledParameter& rig_stiffness = parameters[kLogRigStiffness];
    models::SeriesSpring rig;  // in units of Tc, which is about 1
    double contact_reach = reach;
    if (layout_.has_rig()) {
      rig.stiffness =
          rig_stiffness.fixed ? std::exp(rig_stiffness.theta) : reach * (1 + rig_ratio) / rig_ratio;
      const double softer = 1 / reach - 1 / rig.stiffness;  // 1/σ_app = 1/σ + 1/k_r
      contact_reach = rig_stiffness.fixed && softer <= 0 ? 10 * reach : 1 / softer;
    }
    std::vector<Regression> sums;
    std::vector<double> t;
    for (std::size_t r = 0; r < data_.records.size(); ++r) {
      const ScaledRecord& record = data_.records[r];
      t.resize(record.force.size());
      models::EvaluateForce(model_, {contact_reach, shape_exponent, 1.0}, paths_[r],
                            record.displacement, t, rig);
      sums.push_back(Accumulate(t, record));
    }
    const ScaledParameter& stiffness = parameters[kLogStiffness];
    const ScaledParameter& slip = parameters[kLogSlipForce];
    double slip_force = slip.fixed        ? std::exp(slip.theta)
                        : stiffness.fixed ? std::exp(stiffness.theta) / contact_reach
                                          : RegressSlipForce(sums, layout_);
    if (!(slip_force > 0)) return point;

    point.theta[kShapeExponent] = shape_exponent;
    if (!slip.fixed) point.theta[kLogSlipForce] = std::log(slip_force);
    if (!stiffness.fixed) point.theta[kLogStiffness] = std::log(contact_reach * slip_force);
    if (layout_.has_rig() && !rig_stiffness.fixed) {
      point.theta[kLogRigStiffness] = std::log(rig.stiffness * slip_force);
    }
    for (std::size_t r = 0; r < data_.records.size(); ++r) {
      const std::size_t offset = ParameterLayout::OfRecord(r, kForceOffset);
      if (!parameters[offset].fixed) {
        point.theta[offset] = (sums[r].force - slip_force * sums[r].t) / sums[r].count;
      }
      const std::size_t unloaded = ParameterLayout::OfRecord(r, kUnloadedDisplacement);
      if (!parameters[unloaded].fixed) point.theta[unloaded] = unloaded_[r];
    }
    for (const std::size_t i : layout_.free()) {
      point.theta[i] = std::clamp(point.theta[i], parameters[i].lower, parameters[i].upper);
    }
    point.sum_of_squares = residual_.SumOfSquares(point.theta);
    return point;
  }

 private:
  const ScaledRecords& data_;
  const ParameterLayout& layout_;
  const models::FrictionModel& model_;
  InitialState state_;
  ForceResidual residual_;
  std::vector<double> unloaded_;
  std::vector<models::LoadingPath> paths_;
};

/// Guesses of where each record's contact was unloaded.
std::vector<std::vector<double>> UnloadedGuesses(const ScaledRecords& data,
                                                 const ParameterLayout& layout,
                                                 InitialState state) {
  std::vector<double> fixed;
  std::vector<double> first;
  std::vector<double> centre(data.records.size(), 0.0);
  std::vector<double> zero;
  bool all_fixed = true;
  for (std::size_t r = 0; r < data.records.size(); ++r) {
    const ScaledParameter& parameter =
        layout.parameters()[ParameterLayout::OfRecord(r, kUnloadedDisplacement)];
    all_fixed = all_fixed && parameter.fixed;
    fixed.push_back(parameter.theta);
    first.push_back(parameter.fixed ? parameter.theta : data.records[r].displacement.front());
    zero.push_back(parameter.fixed ? parameter.theta : parameter.ToTheta(0.0));
  }
  if (state == InitialState::kSteady) return {centre};
  if (all_fixed) return {fixed};
  std::vector<std::vector<double>> guesses = {first, centre};
  const bool zero_is_near = std::ranges::all_of(zero, [](double x) { return std::abs(x) <= 1; });
  if (zero_is_near && zero != first && zero != centre) guesses.push_back(zero);
  return guesses;
}

/// A point of the grid and where it lies there.
struct GridPoint {
  StartingPoint point{.theta = {}, .sum_of_squares = std::numeric_limits<double>::infinity()};
  std::vector<double> unloaded;
  double reach = 0.0;
  double shape_exponent = 0.0;
  double rig_ratio = 0.0;
};

void KeepBetter(GridPoint& best, const StartingGrid& grid, const std::vector<double>& unloaded,
                double reach, double shape_exponent, double rig_ratio) {
  // Where no slip is reached nothing depends on the reach: of equals the last, nearest to slip.
  constexpr double kEqual = 1 + 1e-9;
  StartingPoint point = grid.At(reach, shape_exponent, rig_ratio);
  if (std::isfinite(point.sum_of_squares) &&
      point.sum_of_squares <= kEqual * best.point.sum_of_squares) {
    best = {std::move(point), unloaded, reach, shape_exponent, rig_ratio};
  }
}

/// Looks closer between the best point's neighbours. A Jenkins element that does not slip does not
/// depend on its slip force: a start that is only near the slipping one has no way to it.
void Refine(GridPoint& best, const StartingGrid& grid) {
  double step = std::log(2.5);  // the widest of the grid, but for its far end
  for (int round = 0; round < kRefinements; ++round) {
    const double middle = best.reach;
    for (int i = -kSubdivisions + 1; i < kSubdivisions; ++i) {
      if (i == 0) continue;
      const double reach = middle * std::exp(step * i / kSubdivisions);
      KeepBetter(best, grid, best.unloaded, reach, best.shape_exponent, best.rig_ratio);
    }
    step /= kSubdivisions;
  }
}

/// The same on every platform, unlike std::uniform_real_distribution.
double Uniform(std::mt19937_64& generator, double low, double high) {
  return low + (high - low) * static_cast<double>(generator() >> 11) * 0x1p-53;
}

double LogUniform(std::mt19937_64& generator, double low, double high) {
  return std::exp(Uniform(generator, std::log(low), std::log(high)));
}

/// Adds points drawn over the grid's range until there are as many as the options ask for.
void DrawStarts(std::vector<StartingPoint>& starts, StartingGrid& grid,
                std::span<const std::vector<double>> guesses, const ParameterLayout& layout,
                const FitOptions& options) {
  const ScaledParameter& shape = layout.parameters()[kShapeExponent];
  std::mt19937_64 generator(options.seed);
  for (std::size_t left = kDrawsPerStart * options.starts;
       left > 0 && starts.size() < options.starts; --left) {
    const double reach = LogUniform(generator, kReaches.front(), kReaches.back());
    const double alpha = Uniform(generator, 0.0, kHighestDrawnShape);
    const double rig_ratio = LogUniform(generator, kRigRatios.front(), kRigRatios.back());
    grid.SetUnloaded(guesses[generator() % guesses.size()]);
    StartingPoint point = grid.At(reach, shape.fixed ? shape.theta : alpha, rig_ratio);
    if (!std::isfinite(point.sum_of_squares)) continue;
    point.drawn = true;
    starts.push_back(std::move(point));
  }
}

}  // namespace

std::vector<StartingPoint> FindStartingPoints(const ScaledRecords& data,
                                              const ParameterLayout& layout,
                                              const FitOptions& options, InitialState state) {
  StartingGrid grid(data, layout, options, state);
  const ScaledParameter& shape = layout.parameters()[kShapeExponent];
  std::vector<double> shape_exponents(kShapeExponents.begin(), kShapeExponents.end());
  if (shape.fixed) shape_exponents = {shape.theta};

  const ScaledParameter& rig = layout.parameters()[kLogRigStiffness];
  const bool rig_is_open = layout.has_rig() && !rig.fixed;
  const std::vector<double> rig_ratios =
      rig_is_open ? std::vector<double>(kRigRatios.begin(), kRigRatios.end())
                  : std::vector<double>{1.0};

  // Points that compete: those of one α, or where α is held those of one third of the reaches.
  constexpr std::size_t kThirds = 3;
  const bool by_shape = shape_exponents.size() > 1;
  std::vector<GridPoint> best_of_group(by_shape ? shape_exponents.size() : kThirds);
  const std::vector<std::vector<double>> guesses = UnloadedGuesses(data, layout, state);
  for (const std::vector<double>& unloaded : guesses) {
    grid.SetUnloaded(unloaded);
    for (std::size_t k = 0; k < shape_exponents.size(); ++k) {
      for (std::size_t i = 0; i < kReaches.size(); ++i) {
        GridPoint& best = best_of_group[by_shape ? k : i * kThirds / kReaches.size()];
        for (const double rig_ratio : rig_ratios) {
          KeepBetter(best, grid, unloaded, kReaches[i], shape_exponents[k], rig_ratio);
        }
      }
    }
  }
  std::erase_if(best_of_group,
                [](const GridPoint& best) { return !std::isfinite(best.point.sum_of_squares); });
  std::ranges::sort(best_of_group, {},
                    [](const GridPoint& best) { return best.point.sum_of_squares; });
  if (best_of_group.size() > options.starts) best_of_group.resize(options.starts);

  std::vector<StartingPoint> starts;
  for (GridPoint& best : best_of_group) {
    grid.SetUnloaded(best.unloaded);
    Refine(best, grid);
    starts.push_back(std::move(best.point));
  }
  // Where the whole grid has the wrong sense, so have all draws.
  if (!starts.empty()) DrawStarts(starts, grid, guesses, layout, options);
  for (StartingPoint& point : starts) {
    for (std::size_t i = 0; i < point.theta.size(); ++i) {
      const ScaledParameter& parameter = layout.parameters()[i];
      const auto given = options.start.find(parameter.name);
      if (given != options.start.end() && !parameter.fixed) {
        point.theta[i] = parameter.ToTheta(given->second);
      }
    }
  }
  return starts;
}

}  // namespace mindahl::identification
