#include "convert/jenkins_refit.h"

#include <Eigen/Dense>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <utility>

#include "mindahl/models/steady_loop.h"

namespace mindahl::convert {

using methods::IwanElements;
using models::BranchLaw;

namespace {

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

/// A virgin curve of straight lines from the origin through its corners and level behind the last.
/// A corner has a place and an excess over the contact's curve: two that the loops distinguish,
/// where place and force would move the polygon nearly alike.
struct Polygon {
  std::vector<double> x;
  std::vector<double> excess;
  std::vector<double> p;          // force
  std::vector<double> steepness;  // of the contact's curve

  void Update(const Curve& curve) {
    p.resize(x.size());
    steepness.resize(x.size());
    for (std::size_t j = 0; j < x.size(); ++j) {
      p[j] = curve.Force(x[j]) + excess[j];
      steepness[j] = curve.Slope(x[j]);
    }
  }

  [[nodiscard]] std::size_t size() const { return x.size(); }
  [[nodiscard]] double Slope(std::size_t j) const {
    return j == 0 ? p[0] / x[0] : (p[j] - p[j - 1]) / (x[j] - x[j - 1]);
  }
  [[nodiscard]] bool IsInOrder() const {
    return x.front() > 0 && std::ranges::adjacent_find(x, std::greater_equal<>()) == x.end();
  }
  /// True if it is one of elements: it rises, ever less steeply.
  [[nodiscard]] bool IsOfElements() const {
    double last = std::numeric_limits<double>::infinity();
    for (std::size_t j = 0; j < size(); ++j) {
      const double slope = Slope(j);
      if (!(slope > 0 && slope < last)) return false;
      last = slope;
    }
    return true;
  }
};

/// A point of a polygon: on the segment that ends in corner `end`, or behind the last.
struct Point {
  std::size_t end;
  double share;  // of the segment behind it
};

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

  /// Returns the mean square difference of force.
  [[nodiscard]] double Cost(const Polygon& polygon) const {
    const std::vector<double> force = ForcesAt(polygon, PointsAt(polygon, middle_));
    double cost = 0.0;
    for (const Loop& loop : loops_) {
      const double peak = ForceAt(polygon, PointsAt(polygon, {loop.amplitude}).front());
      for (std::size_t i = 0; i < loop.force.size(); ++i) {
        const double difference = 2 * force[i] - peak - loop.force[i];
        cost += loop.weight * width_[i] * difference * difference;
      }
    }
    return cost;
  }

  /// Returns the polygon with the least cost that is found from this one.
  /// @param last_is_held  the last corner keeps its place
  [[nodiscard]] Polygon Fit(Polygon polygon, bool last_is_held) const;

 private:
  struct Loop {
    double amplitude;
    double weight;              // of a difference's square and a width
    std::vector<double> force;  // at the middles of its cells
  };
  /// The normal equations of a step: band + columns·rank·columnsᵀ.
  struct Normal {
    Eigen::SparseMatrix<double> band;
    Eigen::MatrixXd columns;
    Eigen::MatrixXd inverse_rank;
    Eigen::VectorXd gradient;
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

  /// @param places  rising
  static std::vector<Point> PointsAt(const Polygon& polygon, const std::vector<double>& places) {
    std::vector<Point> points;
    std::size_t j = 0;
    for (const double place : places) {
      while (j < polygon.size() && polygon.x[j] < place) ++j;
      const double from = j == 0 ? 0.0 : polygon.x[j - 1];
      points.push_back({j, j == polygon.size() ? 0.0 : (place - from) / (polygon.x[j] - from)});
    }
    return points;
  }
  static double ForceAt(const Polygon& polygon, const Point& point) {
    if (point.end == polygon.size()) return polygon.p.back();
    return std::lerp(point.end == 0 ? 0.0 : polygon.p[point.end - 1], polygon.p[point.end],
                     point.share);
  }
  static std::vector<double> ForcesAt(const Polygon& polygon, const std::vector<Point>& points) {
    std::vector<double> force;
    force.reserve(points.size());
    for (const Point& point : points) force.push_back(ForceAt(polygon, point));
    return force;
  }
  /// Returns the derivatives of the force there by place and excess of the corners to either side,
  /// of which corner j has the unknowns 2j and 2j + 1.
  static std::array<std::pair<Eigen::Index, double>, 4> GradientAt(const Polygon& polygon,
                                                                   const Point& point) {
    std::array<std::pair<Eigen::Index, double>, 4> gradient{};
    const auto end = static_cast<Eigen::Index>(point.end);
    if (point.end == polygon.size()) {
      gradient[0] = {2 * end - 2, polygon.steepness.back()};
      gradient[1] = {2 * end - 1, 1.0};
      return gradient;
    }
    const double slope = polygon.Slope(point.end);
    gradient[0] = {2 * end, (polygon.steepness[point.end] - slope) * point.share};
    gradient[1] = {2 * end + 1, point.share};
    if (point.end > 0) {
      gradient[2] = {2 * end - 2, (polygon.steepness[point.end - 1] - slope) * (1 - point.share)};
      gradient[3] = {2 * end - 1, 1 - point.share};
    }
    return gradient;
  }

  [[nodiscard]] Normal NormalAt(const Polygon& polygon, bool last_is_held) const;

  Curve curve_;
  double largest_;
  double slip_force_;
  std::vector<double> middle_;
  std::vector<double> width_;
  std::vector<Loop> loops_;
};

Loops::Normal Loops::NormalAt(const Polygon& polygon, bool last_is_held) const {
  const auto unknowns = static_cast<Eigen::Index>(2 * polygon.size());
  const auto loops = static_cast<Eigen::Index>(loops_.size());
  Normal normal;
  normal.columns = Eigen::MatrixXd::Zero(unknowns, 2 * loops);
  normal.inverse_rank = Eigen::MatrixXd::Zero(2 * loops, 2 * loops);
  normal.gradient = Eigen::VectorXd::Zero(unknowns);
  const std::vector<Point> points = PointsAt(polygon, middle_);
  std::vector<double> weight(points.size());
  std::vector<double> pull(points.size());
  const std::vector<double> force = ForcesAt(polygon, points);
  for (Eigen::Index l = 0; l < loops; ++l) {
    const Loop& loop = loops_[static_cast<std::size_t>(l)];
    const Point end = PointsAt(polygon, {loop.amplitude}).front();
    const double peak = ForceAt(polygon, end);
    double total_weight = 0.0;
    double total_pull = 0.0;
    for (std::size_t i = 0; i < loop.force.size(); ++i) {
      const double of_place = loop.weight * width_[i];
      const double difference = 2 * force[i] - peak - loop.force[i];
      weight[i] += 4 * of_place;
      pull[i] += 2 * of_place * difference;
      total_weight += of_place;
      total_pull += of_place * difference;
      for (const auto& [unknown, slope] : GradientAt(polygon, points[i])) {
        normal.columns(unknown, 2 * l) += 2 * of_place * slope;
      }
    }
    for (const auto& [unknown, slope] : GradientAt(polygon, end)) {
      normal.columns(unknown, 2 * l + 1) += slope;
      normal.gradient(unknown) -= total_pull * slope;
    }
    normal.inverse_rank(2 * l, 2 * l) = -total_weight;
    normal.inverse_rank(2 * l, 2 * l + 1) = normal.inverse_rank(2 * l + 1, 2 * l) = -1;
  }
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto gradient = GradientAt(polygon, points[i]);
    for (const auto& [row, slope] : gradient) {
      normal.gradient(row) += pull[i] * slope;
      for (const auto& [column, other] : gradient) {
        entries.emplace_back(static_cast<int>(row), static_cast<int>(column),
                             weight[i] * slope * other);
      }
    }
  }
  if (last_is_held) {
    const Eigen::Index held = unknowns - 2;
    std::erase_if(entries, [&](const auto& at) { return at.row() == held || at.col() == held; });
    entries.emplace_back(static_cast<int>(held), static_cast<int>(held), 1.0);
    normal.columns.row(held).setZero();
    normal.gradient(held) = 0;
  }
  normal.band.resize(unknowns, unknowns);
  normal.band.setFromTriplets(entries.begin(), entries.end());
  return normal;
}

Polygon Loops::Fit(Polygon polygon, bool last_is_held) const {
  constexpr int kSteps = 200;
  constexpr double kConverged = 1e-10;  // of the cost
  constexpr double kMostDamping = 1e12;
  double cost = Cost(polygon);
  double damping = 1e-3;
  for (int step = 0; step < kSteps; ++step) {
    const Normal normal = NormalAt(polygon, last_is_held);
    const Eigen::VectorXd diagonal = normal.band.diagonal();
    double gained = 0.0;
    while (damping < kMostDamping) {
      Eigen::SparseMatrix<double> damped = normal.band;
      for (Eigen::Index i = 0; i < diagonal.size(); ++i) {
        damped.coeffRef(i, i) += damping * diagonal(i);
      }
      const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> band(damped);
      const Eigen::MatrixXd across = band.solve(normal.columns);
      const Eigen::VectorXd along = band.solve(normal.gradient);
      const Eigen::MatrixXd rank = normal.inverse_rank + normal.columns.transpose() * across;
      const Eigen::VectorXd change =
          across * rank.partialPivLu().solve(normal.columns.transpose() * along) - along;
      Polygon moved = polygon;
      for (std::size_t j = 0; j < polygon.size(); ++j) {
        const auto unknown = static_cast<Eigen::Index>(2 * j);
        moved.x[j] += change(unknown);
        moved.excess[j] += change(unknown + 1);
      }
      bool is_allowed = moved.IsInOrder() && moved.x.back() <= 1;
      if (is_allowed) {
        moved.Update(curve_);
        is_allowed = moved.IsOfElements();
      }
      const double moved_cost = is_allowed ? Cost(moved) : std::numeric_limits<double>::infinity();
      if (moved_cost < cost) {
        gained = cost - moved_cost;
        cost = moved_cost;
        polygon = std::move(moved);
        damping /= 4;
        break;
      }
      damping *= 4;
    }
    if (gained <= kConverged * cost) break;
  }
  return polygon;
}

Polygon Through(const Curve& curve, const std::vector<double>& corners) {
  Polygon polygon;
  polygon.x = corners;
  polygon.excess.resize(corners.size());
  polygon.Update(curve);
  return polygon;
}

Polygon PolygonOf(const IwanElements& elements, const BranchLaw& law, double largest) {
  Polygon polygon;
  double slipped = 0.0;
  double stiffness = std::reduce(elements.stiffness.begin(), elements.stiffness.end());
  for (std::size_t j = 0; j < elements.size(); ++j) {
    const double x = elements.slip_force[j] / elements.stiffness[j];
    polygon.x.push_back(x / largest);
    polygon.p.push_back((slipped + stiffness * x) / law.slip_force);
    slipped += elements.slip_force[j];
    stiffness -= elements.stiffness[j];
  }
  return polygon;
}

IwanElements ElementsOf(const Polygon& polygon, const BranchLaw& law, double largest,
                        bool last_sticks) {
  IwanElements elements;
  double left = 1.0;
  for (std::size_t j = 0; j < polygon.size(); ++j) {
    const bool is_last = j + 1 == polygon.size();
    const double stiffness = polygon.Slope(j) - (is_last ? 0.0 : polygon.Slope(j + 1));
    double slip_force = stiffness * polygon.x[j];
    if (is_last && last_sticks) slip_force = std::max(slip_force, left);
    left -= slip_force;
    elements.stiffness.push_back(stiffness * law.slip_force / largest);
    elements.slip_force.push_back(slip_force * law.slip_force);
  }
  return elements;
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
  const double of_tangents = loops.Cost(PolygonOf(tangents, masing, largest));
  double least = of_tangents;
  const auto try_from = [&](const std::vector<double>& corners, bool sticks) {
    Polygon start = Through(curve, corners);
    if (!start.IsInOrder() || !start.IsOfElements()) return;
    const Polygon fitted = loops.Fit(std::move(start), sticks);
    if (sticks && fitted.p.back() > 1) return;  // it would hold more than the contact
    const double cost = loops.Cost(fitted);
    const IwanElements refitted = ElementsOf(fitted, masing, largest, sticks);
    if (cost < least && largest_difference(refitted) <= allowed) {
      least = cost;
      best = refitted;
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
