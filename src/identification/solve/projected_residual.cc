#include "identification/solve/projected_residual.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "identification/solve/sums.h"

namespace mindahl::identification {

// JᵀJ of unit columns = PᵀLDLᵀP; the rows are √D·Lᵀ·P, and those of the residual √D⁻¹·L⁻¹·P·Jᵀr.
template <int P>
CompressedResidual<P>::CompressedResidual(const Eigen::MatrixXd& normal,
                                          const Eigen::VectorXd& gradient, double cost,
                                          std::span<const unsigned char> frozen) {
  // Pivots of unit columns below it are rounding: the direction has no effect.
  constexpr double kNoEffect = 1e-15;
  using Square = Eigen::Matrix<double, P, P>;
  using Vector = Eigen::Matrix<double, P, 1>;
  const Eigen::Index count = gradient.size();
  Vector norms(count);
  Vector slopes = gradient;
  Square correlation = normal;
  for (Eigen::Index j = 0; j < count; ++j) {
    const bool is_frozen = !frozen.empty() && frozen[static_cast<std::size_t>(j)] != 0;
    norms[j] = !is_frozen && normal(j, j) > 0 ? std::sqrt(normal(j, j)) : 0.0;
    const double inverse = norms[j] > 0 ? 1 / norms[j] : 0.0;
    slopes[j] *= inverse;
    correlation.row(j) *= inverse;
    correlation.col(j) *= inverse;
  }
  const Eigen::LDLT<Square> factors(correlation);
  const Vector pivots = factors.vectorD();
  const Eigen::PermutationMatrix<P, P> permutation(factors.transpositionsP());
  Vector explained = permutation * slopes;
  factors.matrixL().solveInPlace(explained);
  const Square scales = norms.asDiagonal();
  const Square permuted = permutation * scales;
  jacobian_.setZero(count + 1, count);
  jacobian_.topRows(count) = factors.matrixU() * permuted;
  residual_.setZero(count + 1);
  for (Eigen::Index k = 0; k < count; ++k) {
    const double root = pivots[k] > kNoEffect ? std::sqrt(pivots[k]) : 0.0;
    jacobian_.row(k) *= root;
    residual_[k] = root > 0 ? explained[k] / root : 0.0;
  }
  residual_[count] = std::sqrt(std::max(cost - residual_.squaredNorm(), 0.0));
}

template class CompressedResidual<1>;
template class CompressedResidual<2>;
template class CompressedResidual<3>;
template class CompressedResidual<Eigen::Dynamic>;

namespace {

// Bounds of σ/Tc and Tc/k in units of the data: a straight line, and a branch that is vertical; a
// rigid rig, and one in which the contact is rigid.
const double kLowestLogRate = std::log(1e-4);
const double kHighestLogRate = std::log(1e9);
const double kLowestLogTravel = std::log(1e-9);
const double kHighestLogTravel = std::log(1e3);

/// Grows the buffer to at least `size` elements; never shrinks it. Contents are unspecified.
void GrowTo(std::size_t size, std::vector<double>& buffer) {
  if (buffer.size() < size) buffer.resize(size);
}

/// Returns ln of the largest force of a steady loop about its middle, below which Tc has no loop.
double LeastLogSlipForce(const Problem& problem) {
  constexpr double kShortOfSlip = 1e-9;
  double largest = 0.0;
  for (std::size_t r = 0; r < problem.data->records.size(); ++r) {
    if (problem.state.Of(r) != models::InitialState::kSteady) continue;
    const ScaledRecord& record = problem.data->records[r];
    const auto [low, high] = std::ranges::minmax(record.excitation());
    largest = std::max(largest, (high - low) / 2);
  }
  return std::log(largest) + kShortOfSlip;  // −∞ where none is steady
}

bool IsLinear(const Parameter& parameter) { return parameter.term->column != Regressor::kNone; }

/// True if a coordinate's derivative is one column of t for all samples.
bool IsOneColumn(const Problem& problem, const SearchedParameter& searched) {
  const bool is_of_all = problem.data->records.size() == 1 ||
                         problem.parameters[searched.parameter].term->scope == Scope::kContact;
  const std::span<const Sensitivity> summands = searched.sensitivity.all();
  return is_of_all && summands.size() == 1 && summands[0].column != nullptr &&
         !summands[0].by_log_load;
}

}  // namespace

void ProjectedResidual::Bind(const Problem& problem, Response& response) {
  problem_ = &problem;
  response_ = &response;
  response.Bind(problem);
  samples_ = problem.size();
  held_.assign(problem.parameters.size(), 0);
  for (const std::size_t p : problem.parameters.with_prior()) held_[p] = 1;  // not eliminated
  theta_.resize(problem.parameters.size());
  for (std::size_t p = 0; p < problem.parameters.size(); ++p) {
    theta_[p] = problem.parameters[p].theta;
  }
  GrowTo(4 * samples_, of_samples_);
  std::size_t used = 0;
  for (std::span<double>* part : {&measured_, &weight_, &response_values_, &residual_}) {
    *part = std::span(of_samples_).subspan(used++ * samples_, samples_);
  }
  ChooseSearched();
  FactoriseColumns();
}

void ProjectedResidual::ChooseSearched() {
  const Parameters& parameters = problem_->parameters;
  const Parameter& stiffness = parameters[kStiffness];
  const Parameter& slip_force = parameters[kSlipForce];
  const Parameter& rig = parameters[kRig];
  const auto is_tied = [](const Parameter& parameter) {
    return parameter.fixed || parameter.bounded_by_user || parameter.has_prior();
  };
  scale_is_linear_ = is_forced()
                         ? !is_tied(stiffness)
                         : !slip_force.fixed && !slip_force.has_prior() && !is_tied(stiffness) &&
                               !(parameters.has_rig() && is_tied(rig));
  searched_.clear();
  const auto eliminate = [&](std::size_t p, double lower, double upper, double LawPoint::*point,
                             std::span<double> ResponseColumns::*column) {
    SearchedParameter& searched = searched_.emplace_back(
        SearchedParameter{.parameter = p, .lower = lower, .upper = upper, .eliminated = point});
    searched.sensitivity.summands[0].column = column;
    searched.sensitivity.count = 1;
  };
  if (scale_is_linear_ && !is_forced()) {
    eliminate(kStiffness, kLowestLogRate, kHighestLogRate, &LawPoint::log_rate,
              &ResponseColumns::log_rate);
    if (parameters.has_rig()) {
      eliminate(kRig, kLowestLogTravel, kHighestLogTravel, &LawPoint::log_travel,
                &ResponseColumns::log_spring_travel);
    }
  }
  for (const std::size_t p : {kStiffness, kSlipForce, kRig}) {
    const bool is_eliminated = is_forced() ? scale_is_linear_ && p == kStiffness : scale_is_linear_;
    if (is_eliminated || parameters[p].fixed) continue;
    const double lower = is_forced() && p == kSlipForce
                             ? std::max(slip_force.lower, LeastLogSlipForce(*problem_))
                             : parameters[p].lower;
    searched_.push_back({.parameter = p,
                         .lower = lower,
                         .upper = parameters[p].upper,
                         .sensitivity = SensitivityTo(*problem_, p)});
  }
  for (const std::size_t p : parameters.free()) {
    const bool is_searched = p == kShape || p >= kLoadExponent;
    if (!is_searched || (IsLinear(parameters[p]) && !parameters[p].has_prior())) continue;
    searched_.push_back({.parameter = p,
                         .lower = parameters[p].lower,
                         .upper = parameters[p].upper,
                         .sensitivity = SensitivityTo(*problem_, p)});
  }
  // Derivatives of t are written where they are needed; those of several parameters, or of none
  // alone, behind the rest.
  bases_.clear();
  place_of_base_.clear();
  for (const SearchedParameter& searched : searched_) {
    for (const Sensitivity& summand : searched.sensitivity.all()) {
      if (summand.column == nullptr || std::ranges::find(bases_, summand.column) != bases_.end()) {
        continue;
      }
      bases_.push_back(summand.column);
      const auto owner = std::ranges::find_if(searched_, [&](const SearchedParameter& other) {
        return IsOneColumn(*problem_, other) &&
               other.sensitivity.summands[0].column == summand.column;
      });
      place_of_base_.push_back(static_cast<std::size_t>(owner - searched_.begin()));
    }
  }
  std::size_t places = searched_.size();
  for (std::size_t& place : place_of_base_) {
    if (place == searched_.size()) place = places++;
  }
  GrowTo(std::max<std::size_t>(places, 1) * samples_, derivatives_);
  const auto count = static_cast<Eigen::Index>(searched_.size());
  normal_.resize(count, count);
  gradient_.resize(count);
}

void ProjectedResidual::FactoriseColumns() {
  std::size_t row = 0;
  for (const ScaledRecord& record : problem_->data->records) {
    const std::span<const double> measured = record.response();
    for (std::size_t i = 0; i < record.size(); ++i, ++row) {
      weight_[row] = record.root_weight[i];
      measured_[row] = measured[i];
    }
  }
  columns_.Factorise(*problem_, held_, theta_, weight_, measured_);
}

void ProjectedResidual::ReleaseLinear() {
  bool any = false;
  for (std::size_t p = 0; p < held_.size(); ++p) {
    const unsigned char held = problem_->parameters[p].has_prior() ? 1 : 0;
    any = any || held_[p] != held;
    held_[p] = held;
  }
  if (any) FactoriseColumns();
}

bool ProjectedResidual::HoldPassed(std::span<double> theta) {
  for (const std::size_t p : columns_.parameters()) {
    const Parameter& parameter = problem_->parameters[p];
    if (theta[p] >= parameter.lower && theta[p] <= parameter.upper) continue;
    theta[p] = std::clamp(theta[p], parameter.lower, parameter.upper);
    held_[p] = 1;
    theta_[p] = theta[p];
    FactoriseColumns();
    return true;
  }
  return false;
}

LawPoint ProjectedResidual::PointOf(std::span<const double> u) {
  bool columns_move = false;
  for (std::size_t j = 0; j < searched_.size(); ++j) {
    const std::size_t p = searched_[j].parameter;
    if (searched_[j].eliminated != nullptr) continue;
    const bool moves = ShapesColumns(*problem_, p) || IsLinear(problem_->parameters[p]);
    columns_move = columns_move || (theta_[p] != u[j] && moves);
    theta_[p] = u[j];
  }
  if (columns_move) FactoriseColumns();
  LawPoint point = PointAt(*problem_, theta_);
  for (std::size_t j = 0; j < searched_.size(); ++j) {
    if (searched_[j].eliminated != nullptr) point.*searched_[j].eliminated = u[j];
  }
  return point;
}

void ProjectedResidual::Load(std::span<const double> theta, std::span<double> u) const {
  const LawPoint point = PointAt(*problem_, theta);
  for (std::size_t j = 0; j < searched_.size(); ++j) {
    const SearchedParameter& s = searched_[j];
    const double value = s.eliminated != nullptr ? point.*s.eliminated : theta[s.parameter];
    u[j] = std::clamp(value, s.lower, s.upper);
  }
}

void ProjectedResidual::Store(std::span<const double> u, std::span<double> theta) const {
  for (const std::size_t p : {kStiffness, kSlipForce, kRig}) {
    if (problem_->parameters[p].fixed) theta[p] = theta_[p];
  }
  const double log_scale = std::log(scale_);
  if (!is_forced() && !problem_->parameters[kSlipForce].fixed) theta[kSlipForce] = log_scale;
  for (std::size_t j = 0; j < searched_.size(); ++j) {
    const SearchedParameter& s = searched_[j];
    theta[s.parameter] = s.eliminated == &LawPoint::log_rate     ? u[j] + log_scale
                         : s.eliminated == &LawPoint::log_travel ? log_scale - u[j]
                                                                 : u[j];
  }
  if (is_forced() && scale_is_linear_) theta[kStiffness] = theta[kSlipForce] - log_scale;
  columns_.Solve(scale_, theta);
}

/// Returns the bounds of the factor of t, from those of Tc, or of σ for a displacement.
std::pair<double, double> ProjectedResidual::BoundsOfScale(double log_rate) const {
  if (is_forced()) {
    const Parameter& stiffness = problem_->parameters[kStiffness];
    return {std::exp(-log_rate - stiffness.upper), std::exp(-log_rate - stiffness.lower)};
  }
  const Parameter& slip_force = problem_->parameters[kSlipForce];
  return {std::exp(slip_force.lower), std::exp(slip_force.upper)};
}

/// Computes, from t, which is there without weights: projections, its factor and the residual.
/// @returns the sum of squares; infinity where t is that of no displacement
double ProjectedResidual::Regress(double log_rate, bool is_free, double held_scale) {
  Weigh(response_values_, 1.0, weight_);
  columns_.ProjectResponse(response_values_);
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
  const double cost = Dot(residual_, residual_) + problem_->parameters.PriorCost(theta_);
  return std::isnan(cost) ? std::numeric_limits<double>::infinity() : cost;
}

double ProjectedResidual::Evaluate(std::span<const double> u) {
  const LawPoint point = PointOf(u);
  response_->Evaluate(point, response_values_);
  return Regress(point.log_rate, scale_is_linear_, std::exp(LogScaleAt(*problem_, theta_)));
}

double ProjectedResidual::EvaluateFreely(const LawPoint& at, std::span<double> theta) {
  response_->Evaluate(at, response_values_);
  const std::size_t of_scale = is_forced() ? kStiffness : kSlipForce;
  const bool fixed = problem_->parameters[of_scale].fixed;
  const double held = is_forced() ? -at.log_rate - theta_[kStiffness] : theta_[kSlipForce];
  const double cost = Regress(at.log_rate, !fixed, std::exp(held));
  if (!fixed && !scale_is_free_) return std::numeric_limits<double>::infinity();
  if (is_forced()) theta[kSlipForce] = -at.log_rate;
  theta[of_scale] = is_forced() ? -at.log_rate - std::log(scale_) : std::log(scale_);
  columns_.Solve(scale_, theta);
  return cost;
}

/// t, and the derivatives of scale·t over the scale by what is searched, without weights.
void ProjectedResidual::DifferentiateResponse(const LawPoint& point) {
  ResponseColumns wanted;
  for (std::size_t b = 0; b < bases_.size(); ++b) wanted.*bases_[b] = Derivative(place_of_base_[b]);
  response_->Differentiate(point, response_values_, wanted);
  // Sums first, as a column that is a parameter's own is changed where it stands.
  for (const bool is_own : {false, true}) {
    for (std::size_t j = 0; j < searched_.size(); ++j) {
      if (IsOneColumn(*problem_, searched_[j]) != is_own) continue;
      const std::span<const Sensitivity> summands = searched_[j].sensitivity.all();
      const std::span<double> column = Derivative(j);
      if (is_own) {
        const double factor = summands[0].factor;
        if ((wanted.*summands[0].column).data() != column.data()) {
          std::ranges::copy(wanted.*summands[0].column, column.begin());
        }
        if (factor != 1) {
          for (double& value : column) value *= factor;
        }
        continue;
      }
      std::ranges::fill(column, 0.0);
      const Parameter& parameter = problem_->parameters[searched_[j].parameter];
      std::size_t row = 0;
      for (std::size_t r = 0; r < problem_->data->records.size(); ++r) {
        const ScaledRecord& record = problem_->data->records[r];
        const std::size_t begin = row;
        row += record.size();
        if (parameter.term->scope == Scope::kRecord && parameter.record != r) continue;
        for (const Sensitivity& summand : summands) {
          // Summands proportional to t move the scale, where that is eliminated.
          if (summand.column == nullptr && scale_is_linear_) continue;
          const std::span<const double> of =
              summand.column == nullptr ? response_values_ : wanted.*summand.column;
          const double factor = summand.factor * (summand.by_log_load ? record.log_load : 1.0);
          for (std::size_t i = begin; i < row; ++i) column[i] += factor * of[i];
        }
      }
    }
  }
}

/// Fills the derivatives by linear parameters that are searched and by what shapes linear columns,
/// over the scale and without weights, at the linear parameters that were eliminated.
void ProjectedResidual::DifferentiateColumns() {
  const auto moves_columns = [&](const SearchedParameter& searched) {
    return ShapesColumns(*problem_, searched.parameter) ||
           IsLinear(problem_->parameters[searched.parameter]);
  };
  if (std::ranges::none_of(searched_, moves_columns)) return;
  std::vector<double> theta = theta_;
  columns_.Solve(scale_, theta);
  for (std::size_t j = 0; j < searched_.size(); ++j) {
    if (!moves_columns(searched_[j])) continue;
    const std::size_t p = searched_[j].parameter;
    std::size_t row = 0;
    for (std::size_t r = 0; r < problem_->data->records.size(); ++r) {
      const std::size_t size = problem_->data->records[r].size();
      const std::span<double> column = Derivative(j).subspan(row, size);
      if (IsLinear(problem_->parameters[p])) {
        AddColumn(*problem_, p, r, theta, 1 / scale_, column);
      } else {
        AddDerivativeOfColumns(*problem_, p, r, theta, 1 / scale_, column);
      }
      row += size;
    }
  }
}

double ProjectedResidual::Linearise(std::span<const double> u) {
  const LawPoint point = PointOf(u);
  DifferentiateResponse(point);
  const double cost =
      Regress(point.log_rate, scale_is_linear_, std::exp(LogScaleAt(*problem_, theta_)));
  DifferentiateColumns();
  const double square = scale_is_free_ ? Dot(response_values_, response_values_) : 0.0;
  for (std::size_t j = 0; j < searched_.size(); ++j) {
    const std::span<double> column = Derivative(j);
    Weigh(column, scale_, weight_);
    columns_.ProjectOut(column);
    if (square > 0) {
      AddMultiple(column, -Dot(response_values_, column) / square, response_values_);
    }
    const auto row = static_cast<Eigen::Index>(j);
    gradient_[row] = Dot(column, residual_);
    for (std::size_t k = 0; k <= j; ++k) {
      const auto other = static_cast<Eigen::Index>(k);
      normal_(row, other) = normal_(other, row) = Dot(column, Derivative(k));
    }
    const Parameter& parameter = problem_->parameters[searched_[j].parameter];
    if (!parameter.has_prior()) continue;
    const double weight = parameter.prior_root_weight * parameter.prior_root_weight;
    normal_(row, row) += weight;
    gradient_[row] += weight * (u[j] - parameter.prior_theta);
  }
  return cost;
}

}  // namespace mindahl::identification
