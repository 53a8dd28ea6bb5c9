#include "identification/solve/turning_points.h"

#include <ceres/ceres.h>
#include <ceres/normal_prior.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>

#include "identification/dense.h"
#include "identification/solve/ceres_options.h"

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

/// Locates each record's turning points among its samples, with their directions.
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

/// True if the motion turns before its outermost sample, where the neighbour is the nearer one.
bool TurnsBefore(std::span<const double> x, std::size_t i, double sense) {
  return sense * (x[i - 1] - x[i + 1]) > 0;
}

/// Returns the overshoot beyond x₀ of where the lines through two samples before the turn and two
/// after it meet; empty where the turn is not sharp.
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
  // For a parabola both are equal; for a triangle the velocity changes at the turn only.
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

namespace {

SparseColumns ColumnsOfTurns(const Problem& problem, std::span<const double> theta,
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
  SparseColumns columns(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(first));
  columns.setFromTriplets(entries.begin(), entries.end());
  return columns;
}

}  // namespace

TurningPointColumns::TurningPointColumns(const Problem& problem, std::span<const double> theta,
                                         Response& response)
    : TurningPointColumns(ColumnsOfTurns(problem, theta, response)) {}

TurningPointColumns::TurningPointColumns(const Eigen::SparseMatrix<double>& columns)
    : columns_(columns) {
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

Eigen::VectorXd TurningPointColumns::Fit(const Eigen::VectorXd& column) const {
  return normal_.solve(Eigen::VectorXd(columns_.transpose() * column));
}

void TurningPointColumns::ProjectOut(Eigen::Ref<Eigen::VectorXd> column) const {
  column -= columns_ * Fit(column);
}

namespace {

/// The residuals with their derivatives by the parameters (dense) and the overshoots (sparse).
struct ArrowSystem {
  Eigen::MatrixXd jacobian;
  SparseColumns overshoots;
  Eigen::VectorXd residual;
};

ArrowSystem Linearise(const Problem& problem, std::span<const double> theta, Response& response) {
  ArrowSystem system;
  const auto& free = problem.parameters.free();
  const auto rows = static_cast<Eigen::Index>(problem.size());
  system.jacobian.resize(rows, static_cast<Eigen::Index>(free.size()));
  system.residual.resize(rows);
  response.Bind(problem);
  Differentiate(problem, theta, response, free, {system.residual.data(), problem.size()},
                {system.jacobian.data(), static_cast<std::size_t>(system.jacobian.size())});
  system.overshoots = ColumnsOfTurns(problem, theta, response);
  return system;
}

/// The residuals of all parameters and overshoots, evaluated once for all strokes: Ceres asks each
/// stroke for its rows afterwards.
class TurnedResiduals final : public ceres::EvaluationCallback {
 public:
  TurnedResiduals(const Problem& problem, const Solution& start, std::vector<double> overshoots,
                  Response& response)
      : overshoot(std::move(overshoots)),
        problem_(problem),
        given_(*problem.data),
        theta_(start.theta),
        response_(response) {
    for (const std::size_t p : problem.parameters.free()) free.push_back(theta_[p]);
  }

  void PrepareForEvaluation(bool evaluate_jacobians, bool new_evaluation_point) override {
    if (new_evaluation_point || !records_) {
      records_ = PutInTurningPoints(given_, overshoot);
      problem_.data = &records_->data;
      has_jacobian_ = false;
    }
    const std::vector<double>& theta = Theta();
    if (evaluate_jacobians && !has_jacobian_) {
      system_ = Linearise(problem_, theta, response_);
      has_jacobian_ = true;
    } else if (new_evaluation_point) {
      system_.residual.resize(static_cast<Eigen::Index>(problem_.size()));
      EvaluateResidual(problem_, theta, response_, {system_.residual.data(), problem_.size()});
    }
  }

  /// θ of all parameters, the free ones where Ceres has them.
  const std::vector<double>& Theta() {
    for (std::size_t j = 0; j < free.size(); ++j) theta_[problem_.parameters.free()[j]] = free[j];
    return theta_;
  }
  [[nodiscard]] const ArrowSystem& system() const { return system_; }
  /// The turned records of the last evaluation.
  [[nodiscard]] const ScaledRecords& data() const { return *problem_.data; }
  [[nodiscard]] std::unique_ptr<TurnedRecords> TakeRecords() { return std::move(records_); }

  std::vector<double> free;       // Ceres' parameter blocks: θ of the free parameters, …
  std::vector<double> overshoot;  // … and each of these by itself

 private:
  Problem problem_;  // of the turned records
  const ScaledRecords& given_;
  std::vector<double> theta_;
  Response& response_;
  std::unique_ptr<TurnedRecords> records_;
  ArrowSystem system_;
  bool has_jacobian_ = false;
};

/// The rows of one stroke, which depend on the parameters and on the few overshoots that its
/// branches start from.
class StrokeCost final : public ceres::CostFunction {
 public:
  StrokeCost(const TurnedResiduals& residuals, Eigen::Index begin, Eigen::Index end,
             std::vector<Eigen::Index> overshoots)
      : residuals_(residuals), begin_(begin), overshoots_(std::move(overshoots)) {
    set_num_residuals(static_cast<int>(end - begin));
    if (!residuals.free.empty()) {
      mutable_parameter_block_sizes()->push_back(static_cast<int>(residuals.free.size()));
    }
    mutable_parameter_block_sizes()->resize(
        mutable_parameter_block_sizes()->size() + overshoots_.size(), 1);
  }

  bool Evaluate(double const* const* /*parameters*/, double* residuals,
                double** jacobians) const override {
    using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    const ArrowSystem& system = residuals_.system();
    const Eigen::Index rows = num_residuals();
    Eigen::Map<Eigen::VectorXd>(residuals, rows) = system.residual.segment(begin_, rows);
    // Ceres would print what is no number.
    bool is_finite = Eigen::Map<Eigen::VectorXd>(residuals, rows).allFinite();
    if (jacobians == nullptr) return is_finite;
    const std::size_t dense = residuals_.free.empty() ? 0 : 1;
    if (dense != 0 && jacobians[0] != nullptr) {
      Eigen::Map<RowMajor> dense_rows(jacobians[0], rows, system.jacobian.cols());
      dense_rows = system.jacobian.middleRows(begin_, rows);
      is_finite = is_finite && dense_rows.allFinite();
    }
    for (std::size_t k = 0; k < overshoots_.size(); ++k) {
      if (jacobians[dense + k] == nullptr) continue;
      Eigen::Map<Eigen::VectorXd> column(jacobians[dense + k], rows);
      column.setZero();
      for (SparseColumns::InnerIterator entry(system.overshoots, overshoots_[k]); entry; ++entry) {
        if (entry.row() >= begin_ && entry.row() < begin_ + rows) {
          column[entry.row() - begin_] = entry.value();
        }
      }
      is_finite = is_finite && column.allFinite();
    }
    return is_finite;
  }

 private:
  const TurnedResiduals& residuals_;
  Eigen::Index begin_;
  std::vector<Eigen::Index> overshoots_;
};

/// Adds the residuals of the priors, as one block of all free parameters.
void AddPriors(const Parameters& parameters, std::vector<double>& free,
               ceres::Problem& ceres_problem) {
  if (parameters.with_prior().empty() || free.empty()) return;
  const auto size = static_cast<Eigen::Index>(free.size());
  Eigen::MatrixXd root_weights = Eigen::MatrixXd::Zero(size, size);
  Eigen::VectorXd means = Eigen::VectorXd::Zero(size);
  for (Eigen::Index j = 0; j < size; ++j) {
    const Parameter& parameter = parameters[parameters.free()[static_cast<std::size_t>(j)]];
    root_weights(j, j) = parameter.prior_root_weight;
    means[j] = parameter.prior_theta;
  }
  ceres_problem.AddResidualBlock(new ceres::NormalPrior(root_weights, means), nullptr, free.data());
}

/// First rows of the strokes of all records, and behind the last.
std::vector<Eigen::Index> StrokesOf(const ScaledRecords& data) {
  std::vector<Eigen::Index> first;
  std::size_t row = 0;
  for (const ScaledRecord& record : data.records) {
    first.push_back(static_cast<Eigen::Index>(row));
    for (const std::size_t reversal : record.reversals) {
      if (reversal > 0) first.push_back(static_cast<Eigen::Index>(row + reversal));
    }
    row += record.size();
  }
  first.push_back(static_cast<Eigen::Index>(row));
  return first;
}

}  // namespace

TurningPointStep StepTurningPoints(const Problem& problem, const Solution& solution,
                                   std::span<const double> overshoot, Response& response) {
  const std::vector<double> longest = LongestOvershoots(*problem.data);
  const std::unique_ptr<TurnedRecords> turned = PutInTurningPoints(*problem.data, overshoot);
  Problem at_samples = problem;
  at_samples.data = &turned->data;
  const ArrowSystem system = Linearise(at_samples, solution.theta, response);
  // Overshoots are eliminated first: their matrix is as sparse as the history is shallow, so that
  // the cost grows with their number, not with its square.
  const TurningPointColumns turning(system.overshoots);
  Eigen::MatrixXd jacobian = system.jacobian;
  for (Eigen::Index c = 0; c < jacobian.cols(); ++c) turning.ProjectOut(jacobian.col(c));
  Eigen::VectorXd residual = system.residual;
  turning.ProjectOut(residual);
  const Eigen::VectorXd step = -SolveLeastSquares(jacobian, residual);
  const Eigen::VectorXd of_overshoots = -turning.Fit(system.residual + system.jacobian * step);
  TurningPointStep result{.left = residual + jacobian * step, .overshoot = longest};
  if (!result.left.allFinite() || !of_overshoots.allFinite()) {
    return {.left = system.residual, .overshoot = longest};
  }
  for (std::size_t k = 0; k < longest.size(); ++k) {
    result.overshoot[k] =
        std::clamp(overshoot[k] + of_overshoots[static_cast<Eigen::Index>(k)], 0.0, longest[k]);
  }
  return result;
}

TurningPointFit FitTurningPoints(const Problem& problem, const Solution& start,
                                 std::vector<double> overshoot, const SolverOptions& options,
                                 Response& response) {
  const std::vector<double> longest = LongestOvershoots(*problem.data);
  for (std::size_t k = 0; k < longest.size(); ++k) {
    overshoot[k] = std::clamp(overshoot[k], 0.0, longest[k]);
  }
  TurnedResiduals residuals(problem, start, std::move(overshoot), response);
  residuals.PrepareForEvaluation(/*evaluate_jacobians=*/true, /*new_evaluation_point=*/true);
  const double first_cost = residuals.system().residual.squaredNorm();

  ceres::Problem::Options of_problem;
  of_problem.evaluation_callback = &residuals;
  ceres::Problem ceres_problem(of_problem);
  const std::vector<Eigen::Index> strokes = StrokesOf(residuals.data());
  // The overshoots of a stroke, by the samples that depend on them.
  std::vector<std::vector<Eigen::Index>> of_stroke(strokes.size() - 1);
  const SparseColumns& columns = residuals.system().overshoots;
  for (Eigen::Index k = 0; k < columns.cols(); ++k) {
    for (SparseColumns::InnerIterator entry(columns, k); entry; ++entry) {
      const auto stroke = static_cast<std::size_t>(
          std::ranges::upper_bound(strokes, static_cast<Eigen::Index>(entry.row())) -
          strokes.begin() - 1);
      if (of_stroke[stroke].empty() || of_stroke[stroke].back() != k) {
        of_stroke[stroke].push_back(k);
      }
    }
  }
  for (std::size_t k = 0; k + 1 < strokes.size(); ++k) {
    if (strokes[k + 1] == strokes[k]) continue;
    std::vector<double*> blocks;
    if (!residuals.free.empty()) blocks.push_back(residuals.free.data());
    for (const Eigen::Index o : of_stroke[k]) {
      blocks.push_back(&residuals.overshoot[static_cast<std::size_t>(o)]);
    }
    if (blocks.empty()) continue;
    ceres_problem.AddResidualBlock(
        new StrokeCost(residuals, strokes[k], strokes[k + 1], of_stroke[k]), nullptr, blocks);
  }
  for (std::size_t j = 0; j < residuals.free.size(); ++j) {
    const Parameter& parameter = problem.parameters[problem.parameters.free()[j]];
    residuals.free[j] = std::clamp(residuals.free[j], parameter.lower, parameter.upper);
    const auto place = static_cast<int>(j);
    ceres_problem.SetParameterLowerBound(residuals.free.data(), place, parameter.lower);
    ceres_problem.SetParameterUpperBound(residuals.free.data(), place, parameter.upper);
  }
  for (std::size_t k = 0; k < longest.size(); ++k) {
    if (!ceres_problem.HasParameterBlock(&residuals.overshoot[k])) continue;
    if (!(longest[k] > 0)) {
      ceres_problem.SetParameterBlockConstant(&residuals.overshoot[k]);
      continue;
    }
    ceres_problem.SetParameterLowerBound(&residuals.overshoot[k], 0, 0.0);
    ceres_problem.SetParameterUpperBound(&residuals.overshoot[k], 0, longest[k]);
  }
  AddPriors(problem.parameters, residuals.free, ceres_problem);
  ceres::Solver::Summary summary;
  ceres::Solve(CeresOptionsOf(options, ceres::SPARSE_NORMAL_CHOLESKY), &ceres_problem, &summary);

  TurningPointFit fit{nullptr, start};
  residuals.PrepareForEvaluation(/*evaluate_jacobians=*/false, /*new_evaluation_point=*/true);
  fit.solution.theta = residuals.Theta();
  fit.solution.sum_of_squares =
      residuals.system().residual.squaredNorm() + problem.parameters.PriorCost(fit.solution.theta);
  fit.solution.converged = summary.termination_type == ceres::CONVERGENCE;
  fit.solution.report = {
      .solver = "solve",
      .termination = ceres::TerminationTypeToString(summary.termination_type),
      .message = summary.message,
      .iterations = start.report.iterations + static_cast<int>(summary.iterations.size()),
      .initial_cost = first_cost / 2,
      .final_cost = fit.solution.sum_of_squares / 2};
  for (const std::size_t p : problem.parameters.free()) {
    fit.solution.side[p] = SideOf(problem.parameters[p], fit.solution.theta[p]);
  }
  fit.records = residuals.TakeRecords();
  fit.records->data.turns_are_fitted = true;
  return fit;
}

}  // namespace mindahl::identification
