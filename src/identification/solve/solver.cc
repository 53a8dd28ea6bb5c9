#include "identification/solve/solver.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "identification/solve/sums.h"

namespace mindahl::identification {
namespace {

// Of σ/Tc and Tc/k in units of the data: a straight line, and a branch that is vertical; a rigid
// rig, and one in which the contact is rigid.
const double kLowestLogRate = std::log(1e-4);
const double kHighestLogRate = std::log(1e9);
const double kLowestLogTravel = std::log(1e-9);
const double kHighestLogTravel = std::log(1e3);

/// Room for so many, which is never given back: what is in it is nobody's.
void GrowTo(std::size_t size, std::vector<double>& buffer) {
  if (buffer.size() < size) buffer.resize(size);
}

/// Solves A·x = b in place by Cholesky's rule; false where A is not positive definite.
bool SolveCholesky(std::span<double> a, std::span<double> x) {
  const std::size_t n = x.size();
  for (std::size_t j = 0; j < n; ++j) {
    for (std::size_t k = 0; k < j; ++k) a[j * n + j] -= a[j * n + k] * a[j * n + k];
    if (!(a[j * n + j] > 0)) return false;
    a[j * n + j] = std::sqrt(a[j * n + j]);
    for (std::size_t i = j + 1; i < n; ++i) {
      for (std::size_t k = 0; k < j; ++k) a[i * n + j] -= a[i * n + k] * a[j * n + k];
      a[i * n + j] /= a[j * n + j];
    }
  }
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t k = 0; k < i; ++k) x[i] -= a[i * n + k] * x[k];
    x[i] /= a[i * n + i];
  }
  for (std::size_t i = n; i-- > 0;) {
    for (std::size_t k = i + 1; k < n; ++k) x[i] -= a[k * n + i] * x[k];
    x[i] /= a[i * n + i];
  }
  return true;
}

/// Below it the forces of a steady loop, whose middle is known, are beyond slip.
double LeastLogSlipForce(const Problem& problem) {
  constexpr double kShortOfSlip = 1e-9;
  if (problem.state != models::InitialState::kSteady)
    return -std::numeric_limits<double>::infinity();
  double largest = 0.0;
  for (const ScaledRecord& record : problem.data->records) {
    const auto [low, high] = std::ranges::minmax(record.excitation());
    largest = std::max(largest, (high - low) / 2);
  }
  return std::log(largest) + kShortOfSlip;
}

}  // namespace

void Solver::Bind(const Problem& problem, Response& response) {
  problem_ = &problem;
  response_ = &response;
  response.Bind(problem);
  samples_ = problem.size();
  held_.assign(problem.parameters.size(), 0);
  held_theta_.resize(problem.parameters.size());
  for (std::size_t p = 0; p < problem.parameters.size(); ++p) {
    held_theta_[p] = problem.parameters[p].theta;
  }
  GrowTo(4 * samples_, of_samples_);
  std::size_t used = 0;
  for (std::span<double>* part : {&measured_, &weight_, &response_values_, &residual_}) {
    *part = std::span(of_samples_).subspan(used++ * samples_, samples_);
  }
  ChooseSearched();
  const std::size_t count = searched_.size();
  GrowTo(std::max<std::size_t>(count, 1) * samples_, derivatives_);
  hessian_.resize(count * count);
  matrix_.resize(count * count);
  for (std::vector<double>* buffer : {&gradient_, &step_, &trial_, &u_}) buffer->resize(count);
  frozen_.resize(count);
  OrthogonaliseColumns();
}

bool Solver::Searches(Role role) const {
  return std::ranges::any_of(searched_, [&](const Searched& s) { return s.role == role; });
}

void Solver::ChooseSearched() {
  const Parameters& parameters = problem_->parameters;
  const Parameter& stiffness = parameters[kStiffness];
  const Parameter& slip_force = parameters[kSlipForce];
  const Parameter& rig = parameters[kRig];
  const bool has_rig = parameters.has_rig();
  const auto is_tied = [](const Parameter& parameter) {
    return parameter.fixed || parameter.bounded_by_user;
  };
  searched_.clear();
  if (is_forced()) {
    scale_is_linear_ = !is_tied(stiffness);
    if (!stiffness.fixed && !scale_is_linear_) {
      searched_.push_back({Role::kLogStiffness, kStiffness, stiffness.lower, stiffness.upper});
    }
    if (!slip_force.fixed) {
      searched_.push_back({Role::kLogSlipForce, kSlipForce,
                           std::max(slip_force.lower, LeastLogSlipForce(*problem_)),
                           slip_force.upper});
    }
    SearchTheOthers();
    return;
  }
  scale_is_linear_ = !slip_force.fixed && !is_tied(stiffness) && !(has_rig && is_tied(rig));
  if (scale_is_linear_) {
    searched_.push_back({Role::kLogRate, kStiffness, kLowestLogRate, kHighestLogRate});
    if (has_rig) {
      searched_.push_back({Role::kLogTravel, kRig, kLowestLogTravel, kHighestLogTravel});
    }
  } else {
    if (!stiffness.fixed) {
      searched_.push_back({Role::kLogStiffness, kStiffness, stiffness.lower, stiffness.upper});
    }
    if (!slip_force.fixed) {
      searched_.push_back({Role::kLogSlipForce, kSlipForce, slip_force.lower, slip_force.upper});
    }
    if (has_rig && !rig.fixed) searched_.push_back({Role::kLogRig, kRig, rig.lower, rig.upper});
  }
  SearchTheOthers();
}

/// What is searched in either response: the shape and what is of the path.
void Solver::SearchTheOthers() {
  const Parameters& parameters = problem_->parameters;
  for (const std::size_t p : parameters.free()) {
    const Parameter& parameter = parameters[p];
    if (p == kShape) {
      searched_.push_back({Role::kShapeExponent, p, parameter.lower, parameter.upper});
    } else if (p == kLoadExponent) {
      searched_.push_back({Role::kExponentOfLoad, p, parameter.lower, parameter.upper});
    } else if (parameter.term->entry == Entry::kLaw && p > kLoadExponent) {
      const Role role = parameter.term->name == "lag"         ? Role::kLag
                        : parameter.term->name == "asymmetry" ? Role::kAsymmetry
                                                              : Role::kUnloaded;
      searched_.push_back({role, p, parameter.lower, parameter.upper});
    }
  }
}

/// The columns of the free linear parameters, weighted, by Gram and Schmidt's rule twice; what is
/// measured, less what is held, freed of them.
void Solver::OrthogonaliseColumns() {
  const ScaledRecords& data = *problem_->data;
  std::size_t row = 0;
  for (const ScaledRecord& record : data.records) {
    const std::span<const double> measured = record.response();
    for (std::size_t i = 0; i < record.size(); ++i, ++row) {
      weight_[row] = record.root_weight[i];
      measured_[row] = measured[i];
    }
  }
  columns_.clear();
  const Parameters& parameters = problem_->parameters;
  // A record's own first: they keep to its rows.
  for (const Scope scope : {Scope::kRecord, Scope::kContact}) {
    for (std::size_t p = 0; p < parameters.size(); ++p) {
      const Parameter& parameter = parameters[p];
      if (parameter.term->column == Regressor::kNone || parameter.term->scope != scope) continue;
      const bool is_held = parameter.fixed || held_[p] != 0;
      if (is_held && held_theta_[p] == 0) continue;
      const auto [begin, end] =
          scope == Scope::kRecord ? RowsOf(parameter.record) : std::pair(std::size_t{0}, samples_);
      if (!is_held) columns_.push_back({p, begin, end, 0.0});
      const std::size_t place = columns_.size() - 1;
      if (!is_held) GrowTo(columns_.size() * samples_, basis_);
      if (!is_held) std::ranges::fill(Basis(place), 0.0);
      // What is held is taken off what was measured as it is, which is weighted with the rest.
      const std::span<double> to = is_held ? measured_ : Basis(place);
      const double factor = is_held ? -held_theta_[p] : 1.0;
      std::size_t k = 0;
      for (std::size_t r = 0; r < data.records.size(); ++r) {
        const std::size_t size = data.records[r].size();
        AddColumn(*problem_, p, r, factor, to.subspan(k, size));
        k += size;
      }
      if (!is_held) Weigh(to, 1.0, weight_);
    }
  }
  Weigh(measured_, 1.0, weight_);
  const std::size_t count = columns_.size();
  triangle_.assign(count * count, 0.0);
  measured_projections_.resize(count);
  response_projections_.resize(count);
  for (std::size_t j = 0; j < count; ++j) {
    const std::span<double> column = Basis(j);
    const double norm = std::sqrt(Dot(column, column));
    for (int round = 0; round < 2; ++round) {
      for (std::size_t i = 0; i < j; ++i) {
        triangle_[i * count + j] += TakeOut(column, Basis(i));
      }
    }
    constexpr double kDependent = 1e-12;
    const double left = std::sqrt(Dot(column, column));
    columns_[j].diagonal = left > kDependent * norm ? left : 0.0;
    for (double& value : column) value = columns_[j].diagonal > 0 ? value / left : 0.0;
    if (j > 0 && columns_[j].begin == 0) columns_[j].end = samples_;
  }
  for (std::size_t j = 0; j < count; ++j) {
    measured_projections_[j] = TakeOut(measured_, Basis(j));
  }
}

void Solver::ProjectOut(std::span<double> column) const {
  for (std::size_t j = 0; j < columns_.size(); ++j) {
    const std::size_t begin = columns_[j].begin;
    const std::size_t count = columns_[j].end - begin;
    TakeOut(column.subspan(begin, count), Basis(j).subspan(begin, count));
  }
}

LawPoint Solver::PointOf(std::span<const double> u) const {
  double log_stiffness = held_theta_[kStiffness];
  double log_slip_force = held_theta_[kSlipForce];
  double log_rig = held_theta_[kRig];
  LawPoint point{.shape = held_theta_[kShape],
                 .load_exponent = problem_->parameters.LoadExponentAt(held_theta_),
                 .theta = held_theta_};
  double log_rate = 0.0;
  double log_travel = 0.0;
  for (std::size_t j = 0; j < u.size(); ++j) {
    switch (searched_[j].role) {
      case Role::kLogRate:
        log_rate = u[j];
        break;
      case Role::kLogTravel:
        log_travel = u[j];
        break;
      case Role::kShapeExponent:
        point.shape = u[j];
        break;
      case Role::kUnloaded:
      case Role::kLag:
      case Role::kAsymmetry:
        break;  // in held_theta_
      case Role::kLogStiffness:
        log_stiffness = u[j];
        break;
      case Role::kLogSlipForce:
        log_slip_force = u[j];
        break;
      case Role::kLogRig:
        log_rig = u[j];
        break;
      case Role::kExponentOfLoad:
        point.load_exponent = u[j];
        break;
    }
  }
  if (is_forced()) {
    point.log_rate = -log_slip_force;
    return point;
  }
  point.log_rate = scale_is_linear_ ? log_rate : log_stiffness - log_slip_force;
  point.log_travel = scale_is_linear_ ? log_travel : log_slip_force - log_rig;
  return point;
}

void Solver::Load(std::span<const double> theta, std::span<double> u) {
  for (std::size_t j = 0; j < searched_.size(); ++j) {
    const Searched& s = searched_[j];
    const double value = s.role == Role::kLogRate     ? theta[kStiffness] - theta[kSlipForce]
                         : s.role == Role::kLogTravel ? theta[kSlipForce] - theta[kRig]
                                                      : theta[s.parameter];
    u[j] = std::clamp(value, s.lower, s.upper);
  }
}

void Solver::Store(std::span<const double> u, std::span<double> theta) const {
  if (is_forced()) {
    for (const std::size_t p : {kStiffness, kSlipForce}) {
      if (problem_->parameters[p].fixed) theta[p] = held_theta_[p];
    }
    for (std::size_t j = 0; j < searched_.size(); ++j) theta[searched_[j].parameter] = u[j];
    if (scale_is_linear_) theta[kStiffness] = theta[kSlipForce] - std::log(scale_);
    StoreLinear(scale_, theta);
    return;
  }
  const double log_slip_force = std::log(scale_);
  theta[kSlipForce] =
      problem_->parameters[kSlipForce].fixed ? held_theta_[kSlipForce] : log_slip_force;
  for (std::size_t j = 0; j < searched_.size(); ++j) {
    const Searched& s = searched_[j];
    theta[s.parameter] = s.role == Role::kLogRate     ? u[j] + log_slip_force
                         : s.role == Role::kLogTravel ? log_slip_force - u[j]
                                                      : u[j];
  }
  StoreLinear(scale_, theta);
}

/// R·b = Qᵀ(y − scale·t)
void Solver::StoreLinear(double scale, std::span<double> theta) const {
  const std::size_t count = columns_.size();
  for (std::size_t j = count; j-- > 0;) {
    double right = measured_projections_[j] - scale * response_projections_[j];
    for (std::size_t k = j + 1; k < count; ++k) {
      right -= triangle_[j * count + k] * theta[columns_[k].parameter];
    }
    theta[columns_[j].parameter] = columns_[j].diagonal > 0 ? right / columns_[j].diagonal : 0.0;
  }
}

/// Of the factor of t, by those of Tc, or of a displacement by those of σ.
std::pair<double, double> Solver::BoundsOfScale(double log_rate) const {
  if (is_forced()) {
    const Parameter& stiffness = problem_->parameters[kStiffness];
    return {std::exp(-log_rate - stiffness.upper), std::exp(-log_rate - stiffness.lower)};
  }
  const Parameter& slip_force = problem_->parameters[kSlipForce];
  return {std::exp(slip_force.lower), std::exp(slip_force.upper)};
}

/// From t, which is there without weights: projections, its factor and the residual.
/// @returns the sum of squares; infinity where t is that of no displacement
double Solver::Regress(double log_rate, bool is_free, double held_scale) {
  Weigh(response_values_, 1.0, weight_);
  for (std::size_t j = 0; j < columns_.size(); ++j) {
    const std::size_t begin = columns_[j].begin;
    const std::size_t count = columns_[j].end - begin;
    response_projections_[j] =
        TakeOut(response_values_.subspan(begin, count), Basis(j).subspan(begin, count));
  }
  scale_ = held_scale;
  scale_is_free_ = false;
  if (is_free) {
    const auto [lower, upper] = BoundsOfScale(log_rate);
    const double square = Dot(response_values_, response_values_);
    const double best = square > 0 ? Dot(response_values_, measured_) / square : 0.0;
    scale_ = std::clamp(best, lower, upper);
    scale_is_free_ = scale_ == best;
    if (!(best > 0)) scale_ = lower;
  }
  Subtract(scale_, response_values_, measured_, residual_);
  const double cost = Dot(residual_, residual_);
  return std::isnan(cost) ? std::numeric_limits<double>::infinity() : cost;
}

/// A record's origin moves its own samples only.
/// @param all  ∂t/∂δ₀ of every sample by its own record's, the first of the columns that take it
void Solver::SplitByRecord(std::span<const double> all) {
  if (problem_->data->records.size() == 1) return;
  for (std::size_t j = searched_.size(); j-- > 0;) {
    if (searched_[j].role != Role::kUnloaded) continue;
    const auto [begin, end] = RowsOf(problem_->parameters[searched_[j].parameter].record);
    const std::span<double> column = Derivative(j);
    for (std::size_t i = 0; i < samples_; ++i) column[i] = i >= begin && i < end ? all[i] : 0.0;
  }
}

/// ∂t/∂p = ln(N/N₀)·∂t/∂ln κ, of each record's load.
void Solver::FillLoadExponent(std::span<const double> by_log_rate) {
  for (std::size_t j = 0; j < searched_.size(); ++j) {
    if (searched_[j].role != Role::kExponentOfLoad) continue;
    const std::span<double> column = Derivative(j);
    std::size_t k = 0;
    for (const ScaledRecord& record : problem_->data->records) {
      for (std::size_t i = 0; i < record.size(); ++i, ++k) {
        column[k] = record.log_load * by_log_rate[k];
      }
    }
  }
}

std::pair<std::size_t, std::size_t> Solver::RowsOf(std::size_t record) const {
  std::size_t begin = 0;
  for (std::size_t r = 0; r < record; ++r) begin += problem_->data->records[r].size();
  return {begin, begin + problem_->data->records[record].size()};
}

double Solver::Evaluate(std::span<const double> u, bool with_gradient) {
  for (std::size_t j = 0; j < u.size(); ++j) {
    if (IsOfThePath(searched_[j].role)) held_theta_[searched_[j].parameter] = u[j];
  }
  const LawPoint point = PointOf(u);
  const bool has_rig = problem_->parameters.has_rig();
  double log_slip_force = held_theta_[kSlipForce];
  double log_stiffness = held_theta_[kStiffness];
  for (std::size_t j = 0; j < u.size(); ++j) {
    if (searched_[j].role == Role::kLogSlipForce) log_slip_force = u[j];
    if (searched_[j].role == Role::kLogStiffness) log_stiffness = u[j];
  }
  const double held = std::exp(is_forced() ? log_slip_force - log_stiffness : log_slip_force);
  if (!with_gradient) {
    response_->Evaluate(point, response_values_);
    return Regress(point.log_rate, scale_is_linear_, held);
  }
  if (is_forced()) {
    DifferentiateForced(point);
    return Regress(point.log_rate, scale_is_linear_, held);
  }
  // The derivatives of t first, each in the place of one that needs it.
  ResponseColumns columns;
  const auto wants = [&](Role role) {
    for (std::size_t j = 0; j < searched_.size(); ++j) {
      if (searched_[j].role == role) return Derivative(j);
    }
    return std::span<double>();
  };
  const bool natural = !scale_is_linear_;
  columns.log_rate = natural ? wants(Role::kLogStiffness) : wants(Role::kLogRate);
  columns.shape_exponent = wants(Role::kShapeExponent);
  columns.log_spring_travel = natural ? wants(Role::kLogRig) : wants(Role::kLogTravel);
  const bool tied = natural && Searches(Role::kLogSlipForce);
  const bool lacks_rate = columns.log_rate.empty() && (tied || Searches(Role::kExponentOfLoad));
  if (lacks_rate || (tied && has_rig && columns.log_spring_travel.empty())) {
    // ∂T/∂ln Tc needs both, ∂T/∂p the first; what is not searched goes into scratch behind the
    // rest.
    GrowTo((searched_.size() + 2) * samples_, derivatives_);
    columns.shape_exponent = wants(Role::kShapeExponent);  // the buffer has moved
    columns.log_rate = wants(Role::kLogStiffness);
    columns.log_spring_travel = wants(Role::kLogRig);
    if (columns.log_rate.empty()) columns.log_rate = Derivative(searched_.size());
    if (tied && has_rig && columns.log_spring_travel.empty()) {
      columns.log_spring_travel = Derivative(searched_.size() + 1);
    }
  }
  for (std::size_t j = 0; j < searched_.size(); ++j) {
    if (searched_[j].role == Role::kUnloaded && columns.unloaded.empty()) {
      columns.unloaded = Derivative(j);
    }
  }
  columns.lag = wants(Role::kLag);
  columns.asymmetry = wants(Role::kAsymmetry);
  response_->Differentiate(point, response_values_, columns);
  if (Searches(Role::kExponentOfLoad)) FillLoadExponent(columns.log_rate);
  if (tied) {
    const std::span<double> column = wants(Role::kLogSlipForce);
    for (std::size_t i = 0; i < samples_; ++i) {
      column[i] = response_values_[i] - columns.log_rate[i] +
                  (has_rig ? columns.log_spring_travel[i] : 0.0);
    }
  }
  if (natural && Searches(Role::kLogRig)) {
    for (double& value : wants(Role::kLogRig)) value = -value;
  }
  if (!columns.unloaded.empty()) SplitByRecord(columns.unloaded);
  return Regress(point.log_rate, scale_is_linear_, held);
}

/// d and its derivatives by what is searched, over the scale: Tc is in the rate, and beside a σ
/// that is not eliminated in the scale too.
void Solver::DifferentiateForced(const LawPoint& point) {
  ResponseColumns columns;
  for (std::size_t j = 0; j < searched_.size(); ++j) {
    const Role role = searched_[j].role;
    if (role == Role::kLogSlipForce) columns.log_rate = Derivative(j);
    if (role == Role::kShapeExponent) columns.shape_exponent = Derivative(j);
    if (role == Role::kUnloaded && columns.unloaded.empty()) columns.unloaded = Derivative(j);
  }
  response_->Differentiate(point, response_values_, columns);
  for (std::size_t i = 0; i < columns.log_rate.size(); ++i) {
    columns.log_rate[i] = (scale_is_linear_ ? 0.0 : response_values_[i]) - columns.log_rate[i];
  }
  for (std::size_t j = 0; j < searched_.size(); ++j) {
    if (searched_[j].role != Role::kLogStiffness) continue;
    const std::span<double> column = Derivative(j);
    for (std::size_t i = 0; i < samples_; ++i) column[i] = -response_values_[i];
  }
  if (!columns.unloaded.empty()) SplitByRecord(columns.unloaded);
}

/// JᵀJ and Jᵀr of the derivatives of the projected residual.
void Solver::Linearise(std::span<const double> u) {
  const std::size_t count = u.size();
  const double square = scale_is_free_ ? Dot(response_values_, response_values_) : 0.0;
  for (std::size_t j = 0; j < count; ++j) {
    const std::span<double> column = Derivative(j);
    Weigh(column, scale_, weight_);
    ProjectOut(column);
    if (square > 0) {
      AddMultiple(column, -Dot(response_values_, column) / square, response_values_);
    }
    gradient_[j] = Dot(column, residual_);
    for (std::size_t k = 0; k <= j; ++k) {
      hessian_[j * count + k] = hessian_[k * count + j] = Dot(column, Derivative(k));
    }
  }
}

/// (JᵀJ + μ·diag)·s = −Jᵀr over what is not frozen; false where it has no solution.
bool Solver::Step(double damping, std::span<const unsigned char> frozen,
                  std::span<double> step) const {
  const std::size_t count = step.size();
  for (std::size_t j = 0; j < count; ++j) {
    const double own = hessian_[j * count + j];
    const bool still = frozen[j] != 0 || !(own > 0);
    step[j] = still ? 0.0 : -gradient_[j] / std::sqrt(own);
    for (std::size_t k = 0; k < count; ++k) {
      const double other = hessian_[k * count + k];
      const bool none = still || frozen[k] != 0 || !(other > 0);
      matrix_[j * count + k] = j == k ? (still ? 1.0 : 1.0 + damping)
                               : none ? 0.0
                                      : hessian_[j * count + k] / std::sqrt(own * other);
    }
  }
  if (!SolveCholesky(matrix_, step)) return false;
  for (std::size_t j = 0; j < count; ++j) {
    const double own = hessian_[j * count + j];
    if (own > 0) step[j] /= std::sqrt(own);
  }
  return true;
}

/// By how much the linearised sum of squares falls.
double Solver::Predicted(std::span<const double> step) const {
  const std::size_t count = step.size();
  double change = 0.0;
  for (std::size_t j = 0; j < count; ++j) {
    change += 2 * gradient_[j] * step[j];
    for (std::size_t k = 0; k < count; ++k) {
      change += step[j] * hessian_[j * count + k] * step[k];
    }
  }
  return -change;
}

void Solver::Search(std::span<double> u, const SolverOptions& options, Solution& solution) {
  constexpr double kFirstDamping = 1e-3;
  constexpr double kLeastDamping = 1e-12;
  constexpr double kMostDamping = 1e16;
  constexpr double kSmallestGain = 1e-3;  // of twice the log-likelihood, ...
  constexpr int kSlowSteps = 20;          // ... in as many steps
  const auto longest = [](Role role) {
    constexpr double kLongestStepOfLag = 0.02;  // cycles
    constexpr double kLongestStepOfAsymmetry = 0.25;
    if (role == Role::kLag) return kLongestStepOfLag;
    if (role == Role::kAsymmetry) return kLongestStepOfAsymmetry;
    return role == Role::kUnloaded ? 0.5 : role == Role::kShapeExponent ? 1.0 : 1.5;
  };
  const double floor = static_cast<double>(problem_->data->counted) * kRoundingRms * kRoundingRms;
  double cost = Evaluate(u, /*with_gradient=*/true);
  Linearise(u);
  solution.converged = false;
  solution.iterations = 0;
  solution.termination = "The solver made its maximum number of iterations.";
  bool is_looked_at = true;
  if (!std::isfinite(cost)) {
    solution.termination = "The residuals at the start are not finite.";
    solution.sum_of_squares = cost;
    return;
  }
  double damping = kFirstDamping;
  double growth = 2.0;
  double cost_before = cost;  // kSlowSteps accepted steps ago
  bool at_u = true;           // is what Evaluate() left that of u?
  int accepted = 0;
  while (solution.iterations < options.max_iterations) {
    ++solution.iterations;
    for (std::size_t j = 0; j < u.size(); ++j) {
      const bool outward_below = u[j] <= searched_[j].lower && gradient_[j] > 0;
      const bool outward_above = u[j] >= searched_[j].upper && gradient_[j] < 0;
      frozen_[j] = outward_below || outward_above ? 1 : 0;
    }
    // What is left to gain, if the parabola is right.
    const bool newton = Step(kLeastDamping, frozen_, step_);
    const double left = newton ? Predicted(step_) : std::numeric_limits<double>::infinity();
    if (newton && left <= options.function_tolerance * cost) {
      solution.converged = true;
      solution.termination = "No step can lower the cost by more than the function tolerance.";
      break;
    }
    const bool last = newton && left <= options.last_step * cost && cost > floor;
    if (!last && !Step(damping, frozen_, step_)) {
      damping *= growth;
      growth *= 2;
      if (damping > kMostDamping) break;
      continue;
    }
    double shortening = 1.0;
    for (std::size_t j = 0; j < u.size(); ++j) {
      const double limit = longest(searched_[j].role) *
                           (searched_[j].role == Role::kShapeExponent ? std::max(1.0, u[j]) : 1.0);
      if (std::abs(step_[j]) > limit) shortening = std::min(shortening, limit / std::abs(step_[j]));
    }
    bool moves = false;
    for (std::size_t j = 0; j < u.size(); ++j) {
      trial_[j] = std::clamp(u[j] + shortening * step_[j], searched_[j].lower, searched_[j].upper);
      step_[j] = trial_[j] - u[j];
      moves = moves || std::abs(step_[j]) > options.parameter_tolerance *
                                                (std::abs(u[j]) + options.parameter_tolerance);
    }
    const double predicted = Predicted(step_);
    if (!moves) {
      solution.converged = true;
      solution.termination = "No parameter moves by more than the parameter tolerance.";
      break;
    }
    if (last && options.predicts_last) {
      std::ranges::copy(trial_, u.begin());
      cost = std::max(cost - predicted, 0.0);
      is_looked_at = false;
      solution.converged = true;
      solution.termination = "No step can lower the cost by more than the function tolerance.";
      break;
    }
    const double trial_cost = Evaluate(trial_, /*with_gradient=*/!last);
    const bool better = trial_cost < cost;
    at_u = better;
    if (last) {
      // Taken or not, it could gain next to nothing.
      if (better) {
        std::ranges::copy(trial_, u.begin());
        cost = trial_cost;
      }
      solution.converged = true;
      solution.termination = "No step can lower the cost by more than the function tolerance.";
      break;
    }
    const double gain = cost - trial_cost;
    if (better) {
      const double ratio = predicted > 0 ? gain / predicted : 0.0;
      damping =
          std::max(damping * std::max(1.0 / 3, 1 - std::pow(2 * ratio - 1, 3)), kLeastDamping);
      growth = 2.0;
      std::ranges::copy(trial_, u.begin());
      cost = trial_cost;
      Linearise(u);
      if (++accepted % kSlowSteps == 0) {
        const double rise =
            static_cast<double>(problem_->data->counted) * (cost_before - cost) / cost_before;
        if (rise < kSmallestGain) {
          solution.converged = true;
          solution.termination =
              "Twenty steps together raised twice the log-likelihood by less than 1e-3.";
          break;
        }
        cost_before = cost;
      }
      continue;
    }
    damping = std::max(damping, kFirstDamping * 1e-3) * growth;
    growth *= 2;
    if (damping > kMostDamping || !std::isfinite(growth)) {
      solution.converged = true;
      solution.termination = "No step lowers the cost.";
      break;
    }
  }
  solution.sum_of_squares = at_u ? cost : Evaluate(u, /*with_gradient=*/false);
  if (is_looked_at) solution.residual.assign(residual_.begin(), residual_.end());
}

void Solver::MarkSides(std::span<const double> u, Solution& solution) const {
  const Parameters& parameters = problem_->parameters;
  solution.side.assign(parameters.size(), BoundSide::kInside);
  for (const std::size_t p : parameters.free()) {
    const bool by_search = scale_is_linear_ && !is_forced() && (p == kStiffness || p == kRig);
    if (!by_search) solution.side[p] = SideOf(parameters[p], solution.theta[p]);
  }
  if (!scale_is_linear_ && !is_forced()) return;
  for (std::size_t j = 0; j < u.size(); ++j) {
    const Searched& s = searched_[j];
    const BoundSide side = SideOf(u[j], s.lower, s.upper);
    if (s.role == Role::kLogSlipForce) solution.side[kSlipForce] = side;
    if (s.role == Role::kLogRate && side == BoundSide::kUpper) solution.side[kStiffness] = side;
    if (s.role == Role::kLogRate && side == BoundSide::kLower) {
      solution.side[kSlipForce] = BoundSide::kUpper;  // a straight line
    }
    if (s.role == Role::kLogTravel && side != BoundSide::kInside) {
      solution.side[kRig] = side == BoundSide::kLower ? BoundSide::kUpper : BoundSide::kLower;
    }
  }
}

double Solver::CostAt(std::span<double> theta) {
  Load(theta, u_);
  const double cost = Evaluate(u_, /*with_gradient=*/false);
  Store(u_, theta);
  return cost;
}

double Solver::CostAt(const LawPoint& at, std::span<double> theta) {
  response_->Evaluate(at, response_values_);
  const std::size_t of_scale = is_forced() ? kStiffness : kSlipForce;
  const bool fixed = problem_->parameters[of_scale].fixed;
  const double held =
      is_forced() ? -at.log_rate - held_theta_[kStiffness] : held_theta_[kSlipForce];
  const double cost = Regress(at.log_rate, !fixed, std::exp(held));
  if (!fixed && !scale_is_free_) return std::numeric_limits<double>::infinity();
  if (is_forced()) theta[kSlipForce] = -at.log_rate;
  theta[of_scale] = is_forced() ? -at.log_rate - std::log(scale_) : std::log(scale_);
  StoreLinear(scale_, theta);
  return cost;
}

void Solver::Solve(std::span<const double> start, const SolverOptions& options,
                   Solution& solution) {
  solution.theta.assign(held_theta_.begin(), held_theta_.end());
  solution.residual.clear();
  const auto released = static_cast<bool>(std::ranges::count(held_, 1));
  if (released) {
    std::ranges::fill(held_, 0);
    OrthogonaliseColumns();
  }
  Load(start, u_);
  // Each pass holds one more linear parameter at the bound that it had passed.
  for (std::size_t pass = 0; pass <= problem_->parameters.size(); ++pass) {
    if (searched_.empty()) {
      solution.sum_of_squares = Evaluate(u_, /*with_gradient=*/false);
      solution.residual.assign(residual_.begin(), residual_.end());
      solution.converged = std::isfinite(solution.sum_of_squares);
      solution.termination = "Every parameter that is not linear is fixed.";
    } else {
      Search(u_, options, solution);
    }
    Store(u_, solution.theta);
    bool any = false;
    for (const Column& column : columns_) {
      const Parameter& parameter = problem_->parameters[column.parameter];
      double& theta = solution.theta[column.parameter];
      if (theta >= parameter.lower && theta <= parameter.upper) continue;
      theta = std::clamp(theta, parameter.lower, parameter.upper);
      held_[column.parameter] = 1;
      held_theta_[column.parameter] = theta;
      any = true;
      break;
    }
    if (!any) break;
    OrthogonaliseColumns();
  }
  if (problem_->parameters.free().empty()) solution.termination = "every parameter is fixed";
  solution.converged = solution.converged && std::isfinite(solution.sum_of_squares);
  MarkSides(u_, solution);
}

}  // namespace mindahl::identification
