#include "convert/refit.h"

#include <ceres/cost_function.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <utility>

#include "convert/bouc_wen_shape.h"
#include "core/least_of.h"
#include "mindahl/models/steady_loop.h"

namespace mindahl::convert {

ReferenceLoops::ReferenceLoops(const ModelLaw& contact, const std::vector<double>& amplitudes)
    : contact_(contact) {
  constexpr std::size_t kPlaces = 65;
  for (const double amplitude : amplitudes) {
    Loop& loop = loops_.emplace_back();
    loop.amplitude = amplitude;
    loop.distance.resize(kPlaces);
    loop.force.resize(kPlaces);
    for (std::size_t i = 0; i < kPlaces; ++i) {
      loop.distance[i] = 2 * amplitude * (static_cast<double>(i) / (kPlaces - 1));
    }
    EvaluateRisingBranch(contact, amplitude, loop.distance, loop.force);
    loop.weight = 1 / models::SteadyPeakForce(*contact.model, contact.law, amplitude);
    for (double& force : loop.force) force *= loop.weight;
  }
}

template <typename Response>
ReferenceLoops::Regression ReferenceLoops::Regress(const Response& t, double rate) const {
  double squares = 0.0;
  double product = 0.0;
  double total = 0.0;
  for (const Loop& loop : loops_) {
    std::vector<double> response(loop.distance.size());
    t(rate, loop, response);
    for (std::size_t i = 0; i < response.size(); ++i) {
      const double scaled = loop.weight * response[i];
      squares += scaled * scaled;
      product += scaled * loop.force[i];
      total += loop.force[i] * loop.force[i];
    }
  }
  return {product / squares, total - product * product / squares};
}

template <typename Response>
double ReferenceLoops::BestRate(const Response& t) const {
  // From where the contact itself bends: two decades to either side.
  const double centre = std::log(contact_.law.tangential_stiffness / contact_.law.slip_force);
  const double reach = std::log(100.0);
  constexpr int kPlaces = 40;
  return std::exp(LeastOf([&](double log_rate) { return Regress(t, std::exp(log_rate)).cost; },
                          centre - reach, centre + reach, kPlaces));
}

ModelLaw ReferenceLoops::Fit(const models::FrictionModel& model, double shape_exponent) const {
  const auto t = [&](double rate, const Loop& loop, std::span<double> response) {
    EvaluateRisingBranch(ModelLaw{&model, {rate, shape_exponent, 1.0}}, loop.amplitude,
                         loop.distance, response);
  };
  const double rate = BestRate(t);
  const double slip_force = Regress(t, rate).slip_force;
  return {&model, {rate * slip_force, shape_exponent, slip_force}};
}

BoucWenLaw ReferenceLoops::FitBoucWen(double beta) const {
  const auto response_of = [](const BoucWenShape& shape) {
    return [&shape](double rate, const Loop& loop, std::span<double> response) {
      const BoucWenShape::Loop steady = shape.LoopOf(rate * loop.amplitude);
      for (std::size_t i = 0; i < response.size(); ++i) {
        response[i] = shape.Rising(steady, rate * loop.distance[i]);
      }
    };
  };
  const auto cost_of = [&](double log_exponent) {
    const BoucWenShape shape(std::exp(log_exponent), beta);
    const auto t = response_of(shape);
    return Regress(t, BestRate(t)).cost;
  };
  constexpr int kPlaces = 8;
  const double exponent = std::exp(LeastOf(cost_of, 0.0, std::log(20.0), kPlaces));
  const BoucWenShape shape(exponent, beta);
  const auto t = response_of(shape);
  const double rate = BestRate(t);
  const double slip_force = Regress(t, rate).slip_force;
  return {
      .stiffness = rate * slip_force, .slip_force = slip_force, .exponent = exponent, .beta = beta};
}

using methods::IwanElements;
using models::BranchLaw;

namespace {

/// More elements than this are not searched for: they are placed where many are best, and a search
/// costs the cube of their number.
constexpr std::size_t kMostSearched = 64;

/// A contact's virgin curve, displacements over the largest amplitude and forces over the slip
/// force.
class Curve {
 public:
  Curve(const BranchLaw& law, double largest) : law_(law), largest_(largest) {}

  [[nodiscard]] double Force(double x) const {
    return models::BackboneForce(law_, largest_ * x) / law_.slip_force;
  }
  [[nodiscard]] double Slope(double x) const {
    return models::BackboneSlope(law_, largest_ * x) * (largest_ / law_.slip_force);
  }
  /// Returns the places where √u, u = 1 − force, falls evenly from 1 to what it is at the last.
  [[nodiscard]] std::vector<double> EvenCorners(double last, std::size_t count) const {
    const double yield = law_.slip_force / law_.tangential_stiffness / largest_;
    const double beta = 1 - law_.shape_exponent;
    const double force = Force(last);
    const double log_root =
        (force < 0.5 ? std::log1p(-force)
                     : std::log(models::BackboneRemaining(law_, largest_ * last))) /
        2;
    const double fall = std::expm1(log_root);
    std::vector<double> corners;
    for (std::size_t j = 1; j < count; ++j) {
      const double log_u =
          2 * std::log1p(fall * (static_cast<double>(j) / static_cast<double>(count)));
      corners.push_back(-yield * (beta == 0 ? log_u : std::expm1(beta * log_u) / beta));
    }
    corners.push_back(last);
    return corners;
  }

 private:
  BranchLaw law_;
  double largest_;
};

/// Elements in the units of a Curve: each is a spring that slips from its displacement on.
struct Elements {
  Eigen::ArrayXd stiffness;
  Eigen::ArrayXd slip;

  [[nodiscard]] double Force(double x) const { return (stiffness * slip.min(x)).sum(); }
};

/// Returns elements whose virgin curve is the polygon with these corners, from the origin, which
/// lies above the contact's curve as the best of many straight lines do: a segment h of a curve f
/// is fitted best |f''|h²/12 above its chord, and the loop 2p(d/2) − p(X) by that and as much again
/// as at X. Nothing where it does not rise ever less steeply.
std::optional<Elements> BestOfMany(const Curve& curve, const std::vector<double>& corners) {
  const std::size_t n = corners.size();
  std::vector<double> force(n);
  std::vector<double> slope(n + 1);
  const auto from = [&](std::size_t j) { return j == 0 ? 0.0 : corners[j - 1]; };
  const auto find_slopes = [&] {
    for (std::size_t j = 0; j < n; ++j) {
      slope[j] = (force[j] - (j == 0 ? 0.0 : force[j - 1])) / (corners[j] - from(j));
    }
  };
  std::ranges::transform(corners, force.begin(), [&](double x) { return curve.Force(x); });
  find_slopes();
  slope[n] = curve.Slope(corners.back());
  std::vector<double> above(n);
  for (std::size_t j = 0; j < n; ++j) {
    const double after = j + 1 < n ? corners[j + 1] : 2 * corners[j] - from(j);
    above[j] = (slope[j] - slope[j + 1]) * (after - from(j)) / 24;
  }
  if (slope[n] == 0) above.back() = 0.0;  // the contact slips from there on, at its slip force
  for (std::size_t j = 0; j < n; ++j) force[j] += above[j] + above.back();
  find_slopes();
  slope[n] = 0.0;
  Elements elements{Eigen::ArrayXd(n), Eigen::ArrayXd(n)};
  for (std::size_t j = 0; j < n; ++j) {
    const auto at = static_cast<Eigen::Index>(j);
    elements.slip(at) = corners[j];
    elements.stiffness(at) = slope[j] - slope[j + 1];
    if (!(elements.stiffness(at) > 0 && corners[j] > from(j))) return std::nullopt;
  }
  return elements;
}

/// Holds the contact's loops at the middles of cells, which are finer near the corners.
class Loops {
 public:
  Loops(const ModelLaw& contact, const BranchLaw& masing, const Curve& curve,
        std::vector<double> amplitudes, const std::vector<double>& corners)
      : curve_(curve),
        largest_(*std::ranges::max_element(amplitudes)),
        slip_force_(masing.slip_force) {
    std::ranges::sort(amplitudes);
    const std::size_t cells = std::max<std::size_t>(16, 256 / corners.size());
    std::vector<double> edges = {0.0};
    const auto subdivide = [&](double to) {
      const double from = edges.back();
      for (std::size_t i = 1; i <= cells; ++i) {
        edges.push_back(std::lerp(from, to, static_cast<double>(i) / static_cast<double>(cells)));
      }
    };
    for (const double corner : corners) subdivide(corner);
    if (corners.back() < 1) subdivide(1);
    for (const double amplitude : amplitudes) edges.push_back(amplitude / largest_);
    std::ranges::sort(edges);
    edges.erase(std::ranges::unique(edges).begin(), edges.end());
    for (std::size_t i = 1; i < edges.size(); ++i) {
      middle_.push_back((edges[i - 1] + edges[i]) / 2);
      width_.push_back(edges[i] - edges[i - 1]);
    }
    for (const double amplitude : amplitudes) Add(contact, amplitude);
  }

  /// Places the corners of the nearest polygon to leading order, the last given: with a density
  /// proportional to (W·f''²)^{1/5}, W the weight of the loops that come so far.
  [[nodiscard]] std::vector<double> GoodCorners(double last, std::size_t count) const {
    std::vector<double> corners;
    std::vector<double> reached = {0.0};
    std::size_t cells = 0;
    double from = 0.0;
    for (; cells < middle_.size() && middle_[cells] < last; ++cells) {
      const double to = middle_[cells] + width_[cells] / 2;
      double weight = 0.0;
      for (const Loop& loop : loops_) {
        if (middle_[cells] < loop.amplitude) weight += loop.weight;
      }
      reached.push_back(reached.back() + std::pow(weight, 0.2) * std::pow(width_[cells], 0.6) *
                                             std::pow(curve_.Slope(from) - curve_.Slope(to), 0.4));
      from = to;
    }
    std::size_t cell = 0;
    for (std::size_t j = 1; j < count; ++j) {
      const double wanted = reached.back() * (static_cast<double>(j) / static_cast<double>(count));
      while (cell + 1 < cells && reached[cell + 1] < wanted) ++cell;
      const double share = (wanted - reached[cell]) / (reached[cell + 1] - reached[cell]);
      corners.push_back(middle_[cell] + (share - 0.5) * width_[cell]);
    }
    corners.push_back(last);
    return corners;
  }

  [[nodiscard]] std::size_t residuals() const {
    std::size_t count = 0;
    for (const Loop& loop : loops_) count += loop.force.size();
    return count;
  }

  /// Differences of force 2p(d/2) − p(X) − T, each with the root of its share of the mean square.
  /// @param residual      one per cell of each loop
  /// @param by_stiffness  row-major derivatives; null where they are not wanted
  /// @param by_slip       of the first `columns` elements, likewise
  void Evaluate(const Elements& elements, double* residual, double* by_stiffness, double* by_slip,
                Eigen::Index columns) const {
    using Row = Eigen::Map<Eigen::ArrayXd>;
    const Eigen::Index count = elements.slip.size();
    std::vector<double> force(middle_.size());
    std::ranges::transform(middle_, force.begin(), [&](double x) { return elements.Force(x); });
    Eigen::Index row = 0;
    for (const Loop& loop : loops_) {
      const double peak = elements.Force(loop.amplitude);
      const Eigen::ArrayXd reached = elements.slip.min(loop.amplitude);
      for (std::size_t i = 0; i < loop.force.size(); ++i, ++row) {
        const double root = std::sqrt(loop.weight * width_[i]);
        const double x = middle_[i];
        residual[row] = root * (2 * force[i] - peak - loop.force[i]);
        if (by_stiffness != nullptr) {
          Row(by_stiffness + row * count, count) = root * (2 * elements.slip.min(x) - reached);
        }
        if (by_slip != nullptr) {
          const auto slip = elements.slip.head(columns);
          Row(by_slip + row * columns, columns) =
              root * elements.stiffness.head(columns) *
              (2 * (slip < x).cast<double>() - (slip < loop.amplitude).cast<double>());
        }
      }
    }
  }

  /// Returns the mean square difference of force.
  [[nodiscard]] double Cost(const Elements& elements) const {
    Eigen::ArrayXd residual(residuals());
    Evaluate(elements, residual.data(), nullptr, nullptr, 0);
    return residual.square().sum();
  }

 private:
  struct Loop {
    double amplitude;
    double weight;              // of a difference's square and a width
    std::vector<double> force;  // at the middles of its cells
  };

  void Add(const ModelLaw& contact, double amplitude) {
    Loop& loop = loops_.emplace_back();
    loop.amplitude = amplitude / largest_;
    std::vector<double> distance;
    for (std::size_t i = 0; i < middle_.size() && middle_[i] < loop.amplitude; ++i) {
      distance.push_back(2 * largest_ * middle_[i]);
    }
    loop.force.resize(distance.size());
    EvaluateRisingBranch(contact, amplitude, distance, loop.force);
    const double peak =
        models::SteadyPeakForce(*contact.model, contact.law, amplitude) / slip_force_;
    loop.weight = 1 / (loop.amplitude * peak * peak);
    for (double& force : loop.force) force /= slip_force_;
  }

  Curve curve_;
  double largest_;
  double slip_force_;
  std::vector<double> middle_;
  std::vector<double> width_;
  std::vector<Loop> loops_;
};

/// The residuals as Ceres asks for them, by the stiffnesses and the displacements at slip; the last
/// of these is held where it is no parameter.
class LoopDifference : public ceres::CostFunction {
 public:
  LoopDifference(const Loops& loops, const Elements& start, Eigen::Index free_slips)
      : loops_(loops), elements_(start), free_slips_(free_slips) {
    set_num_residuals(static_cast<int>(loops.residuals()));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(start.slip.size()));
    if (free_slips > 0) mutable_parameter_block_sizes()->push_back(static_cast<int>(free_slips));
  }

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    using Values = Eigen::Map<const Eigen::ArrayXd>;
    Elements elements = elements_;
    elements.stiffness = Values(parameters[0], elements.stiffness.size());
    if (free_slips_ > 0) elements.slip.head(free_slips_) = Values(parameters[1], free_slips_);
    loops_.Evaluate(elements, residuals, jacobians == nullptr ? nullptr : jacobians[0],
                    jacobians == nullptr || free_slips_ == 0 ? nullptr : jacobians[1], free_slips_);
    return true;
  }

 private:
  const Loops& loops_;
  Elements elements_;
  Eigen::Index free_slips_;
};

/// Returns the elements of least cost that a search from these finds.
/// @param last_sticks  the last slips at the largest amplitude and not before
Elements Search(const Loops& loops, Elements elements, bool last_sticks) {
  const Eigen::Index count = elements.slip.size();
  const Eigen::Index free_slips = last_sticks ? count - 1 : count;
  ceres::Problem problem;
  std::vector<double*> blocks = {elements.stiffness.data()};
  if (free_slips > 0) blocks.push_back(elements.slip.data());
  problem.AddResidualBlock(new LoopDifference(loops, elements, free_slips), nullptr, blocks);
  for (int j = 0; j < static_cast<int>(count); ++j) {
    problem.SetParameterLowerBound(blocks[0], j, 0.0);
    if (j >= free_slips) continue;
    problem.SetParameterLowerBound(blocks[1], j, 0.0);
    problem.SetParameterUpperBound(blocks[1], j, 1.0);
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.max_num_iterations = 200;
  options.function_tolerance = 1e-8;
  options.gradient_tolerance = std::numeric_limits<double>::min();
  options.parameter_tolerance = std::numeric_limits<double>::epsilon();
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  return elements;
}

/// Returns elements in SI units, those that slip first first; nothing where one has no stiffness,
/// no displacement at slip or that of another.
/// @param last_sticks  the last has what the others leave of the contact's slip force
std::optional<IwanElements> InOrder(const Elements& elements, const BranchLaw& law, double largest,
                                    bool last_sticks) {
  std::vector<std::pair<double, double>> sorted;
  sorted.reserve(static_cast<std::size_t>(elements.slip.size()));
  for (Eigen::Index j = 0; j < elements.slip.size(); ++j) {
    sorted.emplace_back(elements.slip(j), elements.stiffness(j));
  }
  std::ranges::sort(sorted);
  IwanElements made;
  double left = 1.0;
  double last = 0.0;
  for (const auto& [slip, stiffness] : sorted) {
    if (!(slip > last && stiffness > 0)) return std::nullopt;
    last = slip;
    double slip_force = stiffness * slip;
    if (last_sticks && made.size() + 1 == sorted.size()) slip_force = std::max(slip_force, left);
    left -= slip_force;
    made.stiffness.push_back(stiffness * law.slip_force / largest);
    made.slip_force.push_back(slip_force * law.slip_force);
  }
  return made;
}

Elements Scaled(const IwanElements& elements, const BranchLaw& law, double largest) {
  using Values = Eigen::Map<const Eigen::ArrayXd>;
  const auto size = static_cast<Eigen::Index>(elements.size());
  const Values stiffness(elements.stiffness.data(), size);
  const Values slip_force(elements.slip_force.data(), size);
  return {stiffness * (largest / law.slip_force), slip_force / stiffness / largest};
}

}  // namespace

IwanElements RefitElements(const ModelLaw& contact, const BranchLaw& masing,
                           const std::vector<double>& amplitudes, std::size_t elements) {
  IwanElements tangents =
      methods::MakeIwanElements(masing, elements, methods::IwanSpacing::kOptimal);
  if (tangents.size() < elements) return tangents;
  const double largest = *std::ranges::max_element(amplitudes);
  const Curve curve(masing, largest);
  const double slip = models::GrossSlipDisplacement(masing) / largest;
  // The last sticks up to the largest amplitude, or it slips before: in partial slip a limit of all
  // that is below the contact's, for a little less of error.
  constexpr double kBeforeTheEnd = 0.95;
  const Loops loops(contact, masing, curve, amplitudes,
                    curve.EvenCorners(std::min(slip, 1.0), elements));
  const auto largest_difference = [&](const IwanElements& of) {
    double difference = 0.0;
    for (const double amplitude : amplitudes) {
      difference = std::max(difference, CompareLoops(of, contact, amplitude).force);
    }
    return difference;
  };
  const double allowed = largest_difference(tangents);
  IwanElements best = tangents;
  const double of_tangents = loops.Cost(Scaled(tangents, masing, largest));
  double least = of_tangents;
  const auto try_from = [&](const std::vector<double>& corners, bool sticks) {
    const std::optional<Elements> start = BestOfMany(curve, corners);
    if (!start) return;
    const Elements fitted = elements <= kMostSearched ? Search(loops, *start, sticks) : *start;
    if (sticks && fitted.Force(1) > 1) return;  // it would hold more than the contact
    const double cost = loops.Cost(fitted);
    const std::optional<IwanElements> made = InOrder(fitted, masing, largest, sticks);
    if (made && cost < least && largest_difference(*made) <= allowed) {
      least = cost;
      best = *made;
    }
  };
  for (const bool sticks : {true, false}) {
    if (!sticks && slip >= 1 && elements > 1 && least < of_tangents) break;
    const double last = sticks ? 1.0 : slip < 1 ? slip : kBeforeTheEnd;
    try_from(loops.GoodCorners(last, elements), sticks);
    // Near slip the nearest in the mean can be far at one place, and those of even differences not.
    std::vector<double> even = curve.EvenCorners(std::min(last, slip), elements);
    even.back() = last;
    try_from(even, sticks);
  }
  return best;
}

}  // namespace mindahl::convert
