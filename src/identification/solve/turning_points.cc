#include "identification/solve/turning_points.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>

namespace mindahl::identification {
namespace {

using SparseColumns = Eigen::SparseMatrix<double>;

/// Derivatives by overshoots, of the few that have any.
using SparseGradient = std::vector<std::pair<std::size_t, double>>;

void Add(SparseGradient& to, double factor, const SparseGradient& of) {
  for (const auto& [k, value] : of) {
    const auto at = std::ranges::find(to, k, &std::pair<std::size_t, double>::first);
    if (at == to.end()) {
      to.emplace_back(k, factor * value);
    } else {
      at->second += factor * value;
    }
  }
}

/// +1 where a record's reversal is a maximum, −1 where it is a minimum.
double SenseOfTurn(const ScaledRecord& record, std::size_t reversal) {
  const bool is_last = reversal + 1 == record.reversals.size();
  const std::size_t next = is_last ? record.size() - 1 : record.reversals[reversal + 1];
  return record.displacement[record.reversals[reversal]] > record.displacement[next] ? 1.0 : -1.0;
}

/// Where each record's turning points lie among its samples, and their senses.
struct Turns {
  std::vector<double> sense;
  std::size_t highest = 0;  // the turn at the record's greatest displacement
  std::size_t lowest = 0;
  bool turns_highest = false;  // is it a turn?
  bool turns_lowest = false;
};

Turns TurnsOf(const ScaledRecord& record) {
  Turns turns;
  const std::span<const double> x = record.displacement;
  const auto [least, greatest] = std::ranges::minmax(x);
  for (std::size_t j = 0; j < record.reversals.size(); ++j) {
    const std::size_t i = record.reversals[j];
    turns.sense.push_back(SenseOfTurn(record, j));
    if (x[i] == greatest) {
      turns.highest = j;
      turns.turns_highest = true;
    }
    if (x[i] == least) {
      turns.lowest = j;
      turns.turns_lowest = true;
    }
  }
  return turns;
}

/// The motion of the branches' origins, and of the forces there over Tc, with the overshoots.
struct BranchMotion {
  SparseGradient origin;
  SparseGradient force;
};

std::vector<BranchMotion> MotionOf(const models::LoadingPath& path, const ScaledRecord& record,
                                   std::size_t first,
                                   const models::OriginSensitivity& sensitivity) {
  const Turns turns = TurnsOf(record);
  const std::size_t initial = path.branches.size() - record.reversals.size();
  SparseGradient highest;
  SparseGradient lowest;
  if (turns.turns_highest) highest = {{first + turns.highest, 1.0}};
  if (turns.turns_lowest) lowest = {{first + turns.lowest, -1.0}};
  std::vector<BranchMotion> motion(path.branches.size());
  for (std::size_t b = 0; b < path.branches.size(); ++b) {
    const models::Branch& branch = path.branches[b];
    BranchMotion& own = motion[b];
    if (b >= initial) {
      own.origin = {{first + b - initial, turns.sense[b - initial]}};
    } else if (branch.start == models::BranchStart::kSteadyCentre) {
      Add(own.origin, 0.5, highest);
      Add(own.origin, 0.5, lowest);
    } else if (branch.start != models::BranchStart::kUnloaded && b > 0) {
      // The first turns of a steady loop are at the extremes of the record.
      Add(own.origin, 1.0, branch.direction > 0 ? lowest : highest);
    } else if (branch.start == models::BranchStart::kSteadyExtreme) {
      Add(own.origin, 1.0, branch.direction > 0 ? lowest : highest);
      Add(own.force, sensitivity.per_amplitude[b] / 2, highest);
      Add(own.force, -sensitivity.per_amplitude[b] / 2, lowest);
    }
    if (branch.start != models::BranchStart::kReversal) continue;
    const BranchMotion& parent = motion[static_cast<std::size_t>(branch.parent)];
    Add(own.force, sensitivity.gain[b], parent.force);
    Add(own.force, -sensitivity.slope[b], parent.origin);
    Add(own.force, sensitivity.slope[b], own.origin);
  }
  return motion;
}

}  // namespace

double LongestOvershoot(const ScaledRecord& record, std::size_t reversal) {
  const std::size_t i = record.reversals[reversal];
  const auto& x = record.displacement;
  return std::max(std::abs(x[i] - x[i - 1]), std::abs(x[i + 1] - x[i]));
}

namespace {

/// Extremum beyond x₀ of the polynomial through samples first … last about it; from three samples
/// the parabola's. Newton's form, and his method from the middle.
double SmoothOvershoot(std::span<const double> x, std::span<const double> t, std::size_t i,
                       std::size_t first, std::size_t last) {
  constexpr std::size_t kMost = 5;
  constexpr int kSteps = 6;  // a parabola takes one, a quartic about a turn three or four
  std::array<double, kMost> c{};
  const std::size_t count = last - first + 1;
  std::copy_n(x.begin() + static_cast<std::ptrdiff_t>(first), count, c.begin());
  for (std::size_t order = 1; order < count; ++order) {
    for (std::size_t k = count - 1; k >= order; --k) {
      c[k] = (c[k] - c[k - 1]) / (t[first + k] - t[first + k - order]);
    }
  }
  const auto evaluate = [&](double at) {
    std::array<double, 3> p{};  // value, first derivative, half the second
    for (std::size_t k = count; k-- > 0;) {
      const double step = at - t[first + k];
      p[2] = p[2] * step + p[1];
      p[1] = p[1] * step + p[0];
      p[0] = p[0] * step + c[k];
    }
    return p;
  };
  double at = t[i];
  for (int k = 0; k < kSteps; ++k) {
    const auto p = evaluate(at);
    const double next = std::clamp(at - p[1] / (2 * p[2]), t[i - 1], t[i + 1]);
    if (next == at) break;
    at = next;
  }
  return std::abs(evaluate(at)[0] - x[i]);
}

/// On which side of its outermost sample the motion turns: where the neighbour is the nearer one.
bool TurnsBefore(std::span<const double> x, std::size_t i, double sense) {
  return sense * (x[i - 1] - x[i + 1]) > 0;
}

/// Beyond x₀ of where the lines through two samples before the turn and two after it meet; empty
/// where the turn is not sharp.
std::optional<double> SharpOvershoot(std::span<const double> x, std::span<const double> t,
                                     std::size_t i, double sense) {
  const std::size_t a = TurnsBefore(x, i, sense) ? i - 1 : i;  // the last before the turn
  const std::size_t b = a + 1;
  if (a < 2 || b + 2 >= x.size()) return {};
  const auto velocity = [&](std::size_t k) { return (x[k + 1] - x[k]) / (t[k + 1] - t[k]); };
  const double rising = velocity(a - 1);
  const double falling = velocity(b);
  const double at_turn = std::abs(rising - falling);
  const double beside = std::abs(rising - velocity(a - 2)) + std::abs(velocity(b + 1) - falling);
  // Of a parabola they are equal, of a triangle there is nothing beside the turn.
  if (!(beside < at_turn / 2)) return {};
  const double since = (x[b] - x[a] - falling * (t[b] - t[a])) / (rising - falling);
  return sense * (x[a] + rising * since - x[i]);
}

}  // namespace

double OvershootOfMotion(const ScaledRecord& record, std::size_t reversal) {
  const std::size_t i = record.reversals[reversal];
  const std::span<const double> x = record.displacement;
  const std::span<const double> t = record.time;
  const std::optional<double> sharp = SharpOvershoot(x, t, i, SenseOfTurn(record, reversal));
  // Five samples where they lie on the two strokes that meet here.
  const std::size_t before = reversal > 0 ? record.reversals[reversal - 1] : 0;
  const bool is_last = reversal + 1 == record.reversals.size();
  const std::size_t after = is_last ? x.size() - 1 : record.reversals[reversal + 1];
  const std::size_t reach = i >= before + 2 && i + 2 <= after ? 2 : 1;
  const double overshoot = sharp ? *sharp : SmoothOvershoot(x, t, i, i - reach, i + reach);
  return std::clamp(std::isfinite(overshoot) ? overshoot : 0.0, 0.0,
                    LongestOvershoot(record, reversal));
}

std::vector<double> LongestOvershoots(const ScaledRecords& data) {
  std::vector<double> longest;
  for (const ScaledRecord& record : data.records) {
    for (std::size_t k = 0; k < record.reversals.size(); ++k) {
      longest.push_back(LongestOvershoot(record, k));
    }
  }
  return longest;
}

std::unique_ptr<TurnedRecords> PutInTurningPoints(const ScaledRecords& data,
                                                  std::span<const double> overshoot) {
  std::pmr::memory_resource* memory = std::pmr::get_default_resource();
  auto turned = std::make_unique<TurnedRecords>(
      TurnedRecords{data.WithoutRecords(memory), {}, {overshoot.begin(), overshoot.end()}});
  turned->data.counted = data.counted;
  turned->data.records.reserve(data.records.size());
  turned->reversals.resize(data.records.size());
  std::size_t next_overshoot = 0;
  for (std::size_t r = 0; r < data.records.size(); ++r) {
    const ScaledRecord& record = data.records[r];
    ScaledRecord& target = turned->data.records.emplace_back(record.WithoutSamples(memory));
    const std::span<const double> x = record.displacement;
    std::size_t copied = 0;
    const auto copy_until = [&](std::size_t end) {
      target.Append(record, copied, end);
      target.inserted.resize(target.size(), 0);
      copied = end;
    };
    for (std::size_t k = 0; k < record.reversals.size(); ++k) {
      const std::size_t i = record.reversals[k];
      const double sense = SenseOfTurn(record, k);
      copy_until(TurnsBefore(x, i, sense) ? i : i + 1);
      turned->reversals[r].push_back(target.size());
      target.Append(record, i);
      target.displacement.back() = x[i] + sense * overshoot[next_overshoot++];
      target.root_weight.back() = 0.0;
      target.counts.back() = 0;
      target.inserted.push_back(1);
    }
    copy_until(x.size());
    target.reversals = turned->reversals[r];
  }
  return turned;
}

TurningPointColumns::TurningPointColumns(const Problem& problem, std::span<const double> theta,
                                         Response& response) {
  const LawPoint point = PointAt(problem, theta);
  const double slip_force = std::exp(theta[kSlipForce]);
  std::vector<Eigen::Triplet<double>> entries;
  std::size_t first = 0;  // overshoot of the record
  std::size_t row = 0;
  models::OriginSensitivity sensitivity;
  for (std::size_t r = 0; r < problem.data->records.size(); ++r) {
    const ScaledRecord& record = problem.data->records[r];
    const models::LoadingPath& path = response.PathOf(r, theta);
    response.DifferentiateByOrigins(point, r, sensitivity);
    const std::vector<BranchMotion> motion = MotionOf(path, record, first, sensitivity);
    for (const models::BranchRun& run : path.runs) {
      const BranchMotion& branch = motion[static_cast<std::size_t>(run.branch)];
      for (std::size_t i = run.begin; i < run.end; ++i) {
        const double weight = slip_force * record.root_weight[i] * record.load;
        if (weight == 0) continue;
        const auto add = [&](double factor, const SparseGradient& gradient) {
          for (const auto& [k, value] : gradient) {
            entries.emplace_back(static_cast<int>(row + i), static_cast<int>(k),
                                 weight * factor * value);
          }
        };
        add(sensitivity.sample_gain[i], branch.force);
        add(-sensitivity.sample_slope[i], branch.origin);
      }
    }
    first += record.reversals.size();
    row += record.size();
  }
  columns_.resize(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(first));
  columns_.setFromTriplets(entries.begin(), entries.end());
  // A turn without samples after it has an empty column.
  SparseColumns normal = columns_.transpose() * columns_;
  for (Eigen::Index k = 0; k < normal.cols(); ++k) {
    double& own = normal.coeffRef(k, k);
    constexpr double kRidge = 1e-14;
    own = own > 0 ? own * (1 + kRidge) : 1.0;
  }
  normal.makeCompressed();
  normal_.compute(normal);
}

void TurningPointColumns::ProjectOut(Eigen::Ref<Eigen::VectorXd> column) const {
  const Eigen::VectorXd share = normal_.solve(Eigen::VectorXd(columns_.transpose() * column));
  column -= columns_ * share;
}

namespace {

/// Normal equations of the parameters (dense) and the overshoots (sparse).
struct ArrowSystem {
  std::vector<std::size_t> free;
  Eigen::MatrixXd jacobian;
  SparseColumns overshoots;
  Eigen::VectorXd residual;
};

ArrowSystem Linearise(const Problem& problem, std::span<const double> theta, Response& response) {
  ArrowSystem system;
  system.free.assign(problem.parameters.free().begin(), problem.parameters.free().end());
  const auto rows = static_cast<Eigen::Index>(problem.size());
  system.jacobian.resize(rows, static_cast<Eigen::Index>(system.free.size()));
  system.residual.resize(rows);
  response.Bind(problem);
  Differentiate(problem, theta, response, system.free, {system.residual.data(), problem.size()},
                {system.jacobian.data(), static_cast<std::size_t>(system.jacobian.size())});
  system.overshoots = TurningPointColumns(problem, theta, response).columns();
  return system;
}

struct ArrowStep {
  Eigen::VectorXd dense;
  Eigen::VectorXd sparse;
  double predicted = 0.0;
  bool found = false;
};

/// (H + μ·diag H)·s = −g over what is not frozen, overshoots eliminated first.
ArrowStep SolveArrow(const ArrowSystem& system, double damping,
                     std::span<const unsigned char> dense_frozen,
                     std::span<const unsigned char> sparse_frozen) {
  Eigen::MatrixXd jacobian = system.jacobian;
  for (Eigen::Index j = 0; j < jacobian.cols(); ++j) {
    if (dense_frozen[static_cast<std::size_t>(j)] != 0) jacobian.col(j).setZero();
  }
  SparseColumns overshoots = system.overshoots;
  for (Eigen::Index k = 0; k < overshoots.cols(); ++k) {
    if (sparse_frozen[static_cast<std::size_t>(k)] == 0) continue;
    for (SparseColumns::InnerIterator entry(overshoots, k); entry; ++entry) entry.valueRef() = 0.0;
  }
  constexpr double kRidge = 1e-14;  // for directions without effect
  const auto damp = [&](double own) { return own > 0 ? own * (1 + damping + kRidge) : 1.0; };
  SparseColumns sparse = overshoots.transpose() * overshoots;
  for (Eigen::Index k = 0; k < sparse.cols(); ++k) sparse.coeffRef(k, k) = damp(sparse.coeff(k, k));
  sparse.makeCompressed();
  ArrowStep step;
  const Eigen::SimplicialLDLT<SparseColumns> eliminated(sparse);
  if (eliminated.info() != Eigen::Success) return step;
  const Eigen::MatrixXd cross = overshoots.transpose() * jacobian;
  const Eigen::VectorXd sparse_right = -(overshoots.transpose() * system.residual);
  const Eigen::VectorXd dense_right = -(jacobian.transpose() * system.residual);
  Eigen::MatrixXd dense = jacobian.transpose() * jacobian;
  for (Eigen::Index j = 0; j < dense.cols(); ++j) dense(j, j) = damp(dense(j, j));
  const Eigen::MatrixXd solved_cross = eliminated.solve(cross);
  const Eigen::VectorXd solved_right = eliminated.solve(sparse_right);
  const Eigen::LDLT<Eigen::MatrixXd> schur(dense - cross.transpose() * solved_cross);
  step.dense = schur.solve(dense_right - cross.transpose() * solved_right);
  step.sparse = solved_right - solved_cross * step.dense;
  const Eigen::VectorXd left = system.residual + jacobian * step.dense + overshoots * step.sparse;
  step.predicted = system.residual.squaredNorm() - left.squaredNorm();
  step.found = step.dense.allFinite() && step.sparse.allFinite();
  return step;
}

double CostAt(const Problem& problem, std::span<const double> theta, Response& response,
              std::vector<double>& residual) {
  residual.resize(problem.size());
  EvaluateResidual(problem, theta, response, residual);
  double cost = 0.0;
  for (const double value : residual) cost += value * value;
  return cost;
}

}  // namespace

TurningPointStep StepTurningPoints(const Problem& problem, const Solution& solution,
                                   std::span<const double> overshoot, Response& response) {
  const std::vector<double> longest = LongestOvershoots(*problem.data);
  const std::unique_ptr<TurnedRecords> turned = PutInTurningPoints(*problem.data, overshoot);
  Problem at_samples = problem;
  at_samples.data = &turned->data;
  const ArrowSystem system = Linearise(at_samples, solution.theta, response);
  const std::vector<unsigned char> none(std::max(system.free.size(), longest.size()), 0);
  const ArrowStep step = SolveArrow(system, 0.0, none, none);
  TurningPointStep result;
  if (!step.found) return {.left = system.residual, .overshoot = longest};
  result.left = system.residual + system.jacobian * step.dense + system.overshoots * step.sparse;
  for (std::size_t k = 0; k < longest.size(); ++k) {
    result.overshoot.push_back(
        std::clamp(overshoot[k] + step.sparse[static_cast<Eigen::Index>(k)], 0.0, longest[k]));
  }
  return result;
}

TurningPointFit FitTurningPoints(const Problem& problem, const Solution& start,
                                 std::vector<double> overshoot, const SolverOptions& options,
                                 Response& response) {
  constexpr double kMostDamping = 1e12;
  const std::vector<double> longest = LongestOvershoots(*problem.data);
  TurningPointFit fit{PutInTurningPoints(*problem.data, overshoot), start};
  Problem turned = problem;
  turned.data = &fit.records->data;
  std::vector<double> force;
  double cost = CostAt(turned, fit.solution.theta, response, force);
  double damping = 1e-3;
  fit.solution.converged = false;
  fit.solution.iterations = start.iterations;
  fit.solution.termination = "The solver made its maximum number of iterations.";
  // Below it residuals are rounding errors: a few more steps take the last digits.
  const double floor = static_cast<double>(problem.data->counted) * kRoundingRms * kRoundingRms;
  constexpr int kLastSteps = 3;
  int steps_below = 0;
  bool moved = true;
  ArrowSystem system;
  for (int iteration = 0; iteration < options.max_iterations; ++iteration) {
    ++fit.solution.iterations;
    if (moved) system = Linearise(turned, fit.solution.theta, response);
    const Eigen::VectorXd dense_gradient = system.jacobian.transpose() * system.residual;
    const Eigen::VectorXd sparse_gradient = system.overshoots.transpose() * system.residual;
    std::vector<unsigned char> dense_frozen(system.free.size(), 0);
    std::vector<unsigned char> sparse_frozen(longest.size(), 0);
    for (std::size_t j = 0; j < system.free.size(); ++j) {
      const Parameter& parameter = problem.parameters[system.free[j]];
      const double at = fit.solution.theta[system.free[j]];
      const double slope = dense_gradient[static_cast<Eigen::Index>(j)];
      if ((at <= parameter.lower && slope > 0) || (at >= parameter.upper && slope < 0)) {
        dense_frozen[j] = 1;
      }
    }
    for (std::size_t k = 0; k < longest.size(); ++k) {
      const double slope = sparse_gradient[static_cast<Eigen::Index>(k)];
      const double at = fit.records->overshoot[k];
      if ((at <= 0 && slope > 0) || (at >= longest[k] && slope < 0)) sparse_frozen[k] = 1;
    }
    const ArrowStep step = SolveArrow(system, damping, dense_frozen, sparse_frozen);
    if (!step.found) {
      damping *= 10;
      if (damping > kMostDamping) break;
      moved = false;
      continue;
    }
    std::vector<double> theta = fit.solution.theta;
    bool any = false;
    const auto moves = [&](double from, double to) {
      return std::abs(to - from) >
             options.parameter_tolerance * (std::abs(from) + options.parameter_tolerance);
    };
    for (std::size_t j = 0; j < system.free.size(); ++j) {
      const Parameter& parameter = problem.parameters[system.free[j]];
      double& value = theta[system.free[j]];
      const double from = value;
      value = std::clamp(from + step.dense[static_cast<Eigen::Index>(j)], parameter.lower,
                         parameter.upper);
      any = any || moves(from, value);
    }
    std::vector<double> trial(longest.size());
    for (std::size_t k = 0; k < longest.size(); ++k) {
      const double from = fit.records->overshoot[k];
      trial[k] = std::clamp(from + step.sparse[static_cast<Eigen::Index>(k)], 0.0, longest[k]);
      any = any || moves(from, trial[k]);
    }
    if (cost <= floor) ++steps_below;
    if (!any || step.predicted <= options.function_tolerance * cost || steps_below > kLastSteps) {
      fit.solution.converged = true;
      fit.solution.termination = "No step can lower the cost by more than the function tolerance.";
      break;
    }
    std::unique_ptr<TurnedRecords> records = PutInTurningPoints(*problem.data, trial);
    turned.data = &records->data;
    const double trial_cost = CostAt(turned, theta, response, force);
    moved = trial_cost < cost;
    if (moved) {
      fit.records = std::move(records);
      fit.solution.theta = std::move(theta);
      cost = trial_cost;
      damping = std::max(damping / 10, 1e-14);
      continue;
    }
    turned.data = &fit.records->data;
    damping *= 10;
    if (damping > kMostDamping) {
      fit.solution.converged = true;
      fit.solution.termination = "No step lowers the cost.";
      break;
    }
  }
  fit.solution.sum_of_squares = cost;
  for (const std::size_t p : problem.parameters.free()) {
    fit.solution.side[p] = SideOf(problem.parameters[p], fit.solution.theta[p]);
  }
  fit.records->data.turns_are_fitted = true;
  return fit;
}

}  // namespace mindahl::identification
