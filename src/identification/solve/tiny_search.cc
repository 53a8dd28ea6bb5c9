#include "identification/solve/tiny_search.h"

#include <ceres/tiny_solver.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "identification/solve/projected_residual.h"

namespace mindahl::identification {

void TinySearch::Start(ProjectedResidual& of, const SolverOptions& with, double rounding) {
  residual_ = &of;
  options_ = with;
  count_ = of.searched().size();
  floor_ = rounding;
  trial_is_linearised_ = trial_is_predicted_ = false;
  clamped_.assign(count_, 0);
  at_.resize(count_);
  raw_.resize(count_);
  trial_.resize(count_);
}

void TinySearch::KnowsLinearised(std::span<const double> u, double cost) {
  trial_.assign(u.begin(), u.end());
  trial_cost_ = cost;
  trial_is_linearised_ = true;
  trial_is_predicted_ = false;
}

bool TinySearch::IsEvaluatedAt(std::span<const double> u) const {
  return std::equal(u.begin(), u.end(), trial_.begin());
}

double TinySearch::EndOfSearch() const {
  return std::sqrt(cost_ * (1 + options_.function_tolerance / 2));
}

void TinySearch::Clamp(const double* x, std::vector<double>& to) const {
  const std::span<const SearchedParameter> searched = residual_->searched();
  for (std::size_t j = 0; j < count_; ++j) {
    to[j] = std::clamp(x[j], searched[j].lower, searched[j].upper);
  }
}

bool TinySearch::IsTooLong(std::size_t j, double step) const {
  const LawSensitivity& sensitivity = residual_->searched()[j].sensitivity;
  const double limit =
      sensitivity.longest_step * (sensitivity.step_grows_with_theta ? std::max(1.0, raw_[j]) : 1.0);
  return std::abs(step) > limit;
}

bool TinySearch::IsAllowed(const double* x, double& residual) {
  bool is_number = true;
  for (std::size_t j = 0; j < count_; ++j) {
    is_number = is_number && std::isfinite(x[j]);
    goes_on_ = goes_on_ || IsTooLong(j, x[j] - raw_[j]);
  }
  if (is_number && !goes_on_) return true;
  residual = goes_on_ ? EndOfSearch() : kRefused;
  return false;
}

void TinySearch::FindClamped(const double* x) {
  const std::span<const SearchedParameter> searched = residual_->searched();
  for (std::size_t j = 0; j < count_; ++j) {
    const double slope = residual_->gradient()[static_cast<Eigen::Index>(j)];
    const bool below = x[j] <= searched[j].lower && (x[j] < searched[j].lower || slope > 0);
    const bool above = x[j] >= searched[j].upper && (x[j] > searched[j].upper || slope < 0);
    clamped_[j] = below || above ? 1 : 0;
  }
}

void TinySearch::CountAccepted() {
  constexpr double kSmallestGain = 1e-3;  // of twice the log-likelihood, ...
  constexpr int kSlowSteps = 20;          // ... in as many steps
  if (!is_first_) ++accepted_;
  if (accepted_ == 0) cost_before_ = cost_;
  if (is_first_ || accepted_ % kSlowSteps != 0) return;
  const auto samples = static_cast<double>(residual_->problem().data->counted);
  is_slow_ = samples * (cost_before_ - cost_) < kSmallestGain * cost_before_;
  cost_before_ = cost_;
}

namespace {

template <int P>
class SizedSearch final : public TinySearch {
 public:
  void Run(std::span<double> u) override;
  [[nodiscard]] bool hit_maximum() const override {
    return tiny_.summary.status == Tiny::HIT_MAX_ITERATIONS;
  }
  [[nodiscard]] const char* Message() const override;

 private:
  struct Function {
    using Scalar = double;
    enum {  // Names that TinySolver asks for.
      // NOLINTNEXTLINE(readability-identifier-naming)
      NUM_RESIDUALS = CompressedResidual<P>::kRows,
      // NOLINTNEXTLINE(readability-identifier-naming)
      NUM_PARAMETERS = P
    };

    [[nodiscard]] int NumParameters() const { return static_cast<int>(search->count_); }
    [[nodiscard]] int NumResiduals() const { return static_cast<int>(search->count_) + 1; }
    bool operator()(const double* x, double* residuals, double* jacobian) const {
      if (jacobian == nullptr) {
        search->Try(x, residuals);
      } else {
        search->Accept(x, residuals, jacobian);
      }
      return true;
    }

    SizedSearch* search;
  };
  using Tiny = ceres::TinySolver<Function>;
  using Compressed = CompressedResidual<P>;
  using Vector = Eigen::Matrix<double, P, 1>;

  void Try(const double* x, double* residuals);
  void Accept(const double* x, double* residuals, double* jacobian);
  [[nodiscard]] double RadiusOfFirstStep() const;

  Tiny tiny_;
  Vector point_;
  Compressed compressed_;
};

/// Returns the largest radius, of those tried, with which TinySolver's first step is not too long.
template <int P>
double SizedSearch<P>::RadiusOfFirstStep() const {
  constexpr double kLargestRadius = 1e3;
  constexpr int kTries = 40;
  // TinySolver scales the columns, and keeps the damping of those without effect from vanishing.
  constexpr double kLeastDiagonal = 1e-6;
  const Vector scaling = 1 / (1 + compressed_.jacobian().colwise().norm().transpose().array());
  const typename Compressed::Jacobian jacobian = compressed_.jacobian() * scaling.asDiagonal();
  const Eigen::Matrix<double, P, P> normal = jacobian.transpose() * jacobian;
  const Vector gradient = jacobian.transpose() * compressed_.residual();
  double radius = kLargestRadius;
  for (int tries = 0; tries < kTries; ++tries, radius /= 4) {
    Eigen::Matrix<double, P, P> damped = normal;
    damped.diagonal() += normal.diagonal().cwiseMax(kLeastDiagonal) / radius;
    const Vector step = -scaling.cwiseProduct(damped.ldlt().solve(gradient));
    bool is_short = true;
    for (std::size_t j = 0; j < count_; ++j) {
      is_short = is_short && !IsTooLong(j, step[static_cast<Eigen::Index>(j)]);
    }
    if (is_short) break;
  }
  return radius;
}

template <int P>
void SizedSearch<P>::Try(const double* x, double* residuals) {
  const auto size = static_cast<Eigen::Index>(count_);
  Eigen::Map<typename Compressed::Residual> rows(residuals, size + 1);
  rows.setZero();
  if (!IsAllowed(x, rows[0])) return;
  Clamp(x, trial_);
  trial_is_linearised_ = !is_last_;
  trial_is_predicted_ = is_last_ && options_.predicts_last;
  if (trial_is_predicted_) {
    const Vector step =
        Eigen::Map<const Vector>(trial_.data(), size) - Eigen::Map<const Vector>(at_.data(), size);
    trial_cost_ = (compressed_.residual() + compressed_.jacobian() * step).squaredNorm();
  } else {
    trial_cost_ = is_last_ ? residual_->Evaluate(trial_) : residual_->Linearise(trial_);
    // A last step that does not lower the cost could have gained next to nothing.
    if (is_last_ && !(trial_cost_ < cost_)) {
      rows[0] = EndOfSearch();
      return;
    }
  }
  rows[0] = std::isfinite(trial_cost_) ? std::sqrt(trial_cost_) : kRefused;
}

template <int P>
void SizedSearch<P>::Accept(const double* x, double* residuals, double* jacobian) {
  const auto size = static_cast<Eigen::Index>(count_);
  Eigen::Map<typename Compressed::Residual> rows(residuals, size + 1);
  Eigen::Map<typename Compressed::Jacobian> columns(jacobian, size + 1, size);
  Clamp(x, at_);
  if (is_first_ && !(trial_is_linearised_ && trial_ == at_)) {
    KnowsLinearised(at_, residual_->Linearise(at_));
  }
  raw_.assign(x, x + count_);
  cost_ = trial_cost_;
  rows.setZero();
  columns.setZero();
  rows[size] = std::sqrt(cost_);
  tiny_.options.function_tolerance = options_.function_tolerance * cost_;
  if (!trial_is_linearised_) return;  // that was the last step: a zero gradient ends the search
  FindClamped(x);
  compressed_ = Compressed(residual_->normal(), residual_->gradient(), cost_, clamped_);
  CountAccepted();
  const double left = compressed_.Explained();
  if (is_slow_ || left <= options_.function_tolerance * cost_) return;
  is_last_ = left <= options_.last_step * cost_ && cost_ > floor_;
  if (is_first_) tiny_.options.initial_trust_region_radius = RadiusOfFirstStep();
  is_first_ = false;
  rows = compressed_.residual();
  columns = compressed_.jacobian();
}

template <int P>
void SizedSearch<P>::Run(std::span<double> u) {
  // TinySolver's gradients are zero or count: cost and gradient have no scale of their own.
  constexpr double kOnlyZero = std::numeric_limits<double>::min();
  // A search that ends with more than this fraction of the cost to gain was damped too much.
  constexpr double kGainWorthGoingOn = 1e-6;
  tiny_.options.gradient_tolerance = kOnlyZero;
  tiny_.options.cost_threshold = 0.0;
  tiny_.options.parameter_tolerance = options_.parameter_tolerance;
  accepted_ = iterations_ = 0;
  is_slow_ = false;
  initial_cost_ = -1.0;
  point_ = Eigen::Map<const Vector>(u.data(), static_cast<Eigen::Index>(u.size()));
  double last_cost = std::numeric_limits<double>::infinity();
  do {
    is_first_ = true;
    is_last_ = goes_on_ = false;
    tiny_.options.max_num_iterations = options_.max_iterations - iterations_;
    tiny_.Solve(Function{this}, &point_);
    iterations_ += std::max(tiny_.summary.iterations, 1);
    if (initial_cost_ < 0) initial_cost_ = tiny_.summary.initial_cost;
    // A step that ends the search is not accepted by a call.
    if (!std::equal(raw_.begin(), raw_.end(), point_.data())) {
      at_ = trial_;
      cost_ = trial_cost_;
    }
    const bool was_damped = tiny_.summary.status == Tiny::COST_CHANGE_TOO_SMALL &&
                            cost_ < last_cost &&
                            compressed_.Explained() > kGainWorthGoingOn * cost_;
    goes_on_ = goes_on_ || was_damped;
    last_cost = cost_;
  } while (goes_on_ && iterations_ < options_.max_iterations);
  std::ranges::copy(at_, u.begin());
}

template <int P>
const char* SizedSearch<P>::Message() const {
  if (!std::isfinite(cost_)) return "The residuals at the start are not finite.";
  if (is_slow_) return "Twenty steps together raised twice the log-likelihood by less than 1e-3.";
  switch (tiny_.summary.status) {
    case Tiny::GRADIENT_TOO_SMALL:
      return "No step can lower the cost by more than the function tolerance.";
    case Tiny::RELATIVE_STEP_SIZE_TOO_SMALL:
      return "No parameter moves by more than the parameter tolerance.";
    case Tiny::COST_TOO_SMALL:
      return "The cost is zero.";
    case Tiny::COST_CHANGE_TOO_SMALL:
      return "The last step changed the cost by less than the function tolerance.";
    case Tiny::HIT_MAX_ITERATIONS:
      break;
  }
  return "The solver made its maximum number of iterations.";
}

}  // namespace

std::unique_ptr<TinySearch> TinySearch::Make(std::size_t count) {
  switch (count) {
    case 1:
      return std::make_unique<SizedSearch<1>>();
    case 2:
      return std::make_unique<SizedSearch<2>>();
    case 3:
      return std::make_unique<SizedSearch<3>>();
    default:
      return std::make_unique<SizedSearch<Eigen::Dynamic>>();
  }
}

}  // namespace mindahl::identification
