// The kernels of fits against the branch law in extended precision.

#include <random>

#include "../support/worst.h"
#include "mindahl/models/backbone.h"
#include "models/normalized_response.h"
#include "support/prelude.h"

namespace mindahl::models::branch_kernel_test {
namespace {

using Reference = long double;

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

/// t = φ(δ), δ >= 0, with ∂t/∂ln κ = yφ' and ∂t/∂δ₀ = −φ'.
const ScaledBranch kBranch{.origin = 0, .force = 0, .height = 1, .rate = 1};
BranchGradient GradientOfBranch() {
  BranchGradient gradient;
  gradient.log_rate[kRate] = 1;
  gradient.origin_per_unloaded = 1;
  return gradient;
}

struct Columns {
  explicit Columns(std::size_t size) : t(size), rate(size), shape(size), unloaded(size) {}
  std::vector<double> t;
  std::vector<double> rate;
  std::vector<double> shape;
  std::vector<double> unloaded;
};

Columns Evaluate(double shape_exponent, const std::vector<double>& displacement) {
  Columns columns(displacement.size());
  DifferentiateGeneralRun(kBranch, GradientOfBranch(), shape_exponent, 1.0, displacement, columns.t,
                          {columns.rate, columns.shape, columns.unloaded});
  return columns;
}

/// Exponents of every kind: Jenkins', Mindlin's, Dahl's own, next to it and far beyond.
std::vector<double> Exponents() {
  std::vector<double> exponents = {0.0, 1e-9, 1.0 / 3, 0.5, 1 - 1e-9, 1.0, 1 + 1e-9, 1.5, 30.0};
  std::mt19937_64 engine(1);
  std::uniform_real_distribution<double> any(0.0, 3.0);
  for (int i = 0; i < 200; ++i) exponents.push_back(any(engine));
  return exponents;
}

/// From 1e-12 to 100 elastic limits, an odd number, most of them between a tenth and slip.
std::vector<double> Displacements(double shape_exponent) {
  std::mt19937_64 engine(2);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  std::vector<double> displacement = {0.0};
  for (int i = 0; i < 400; ++i) displacement.push_back(std::pow(10.0, -12 + 14 * share(engine)));
  const double slip = shape_exponent < 1 ? 1 / (1 - shape_exponent) : 3.0;
  for (int i = 0; i < 700; ++i) displacement.push_back(slip * share(engine));
  return displacement;
}

TEST(BranchKernel, FollowsTheBranchLawToFourEpsilon) {
  Worst force;
  Worst elastic;
  Worst shape;
  Worst slope;
  for (const double alpha : Exponents()) {
    const std::vector<double> displacement = Displacements(alpha);
    const Columns columns = Evaluate(alpha, displacement);
    for (std::size_t i = 0; i < displacement.size(); ++i) {
      const double y = displacement[i];
      const auto exact = backbone::Differentiate<Reference>(y, alpha);
      const auto where = [&] {
        return "alpha " + std::to_string(alpha) + ", y " + std::to_string(y);
      };
      const auto phi = static_cast<double>(exact.force);
      force.Add(y > 0 ? std::abs(columns.t[i] - phi) / phi : columns.t[i], where);
      // Next to slip φ' bends without bound for α < 1/2.
      if (std::abs((1 - alpha) * y - 1) < 0.01) continue;
      elastic.Add(std::abs(columns.rate[i] - static_cast<double>(exact.elastic)), where);
      shape.Add(std::abs(columns.shape[i] - static_cast<double>(exact.shape_derivative)), where);
      slope.Add(std::abs(columns.unloaded[i] + static_cast<double>(exact.slope)), where);
    }
  }
  EXPECT_LT(force.value, 4 * kEpsilon) << force.where;
  EXPECT_LT(elastic.value, 8 * kEpsilon) << elastic.where;
  EXPECT_LT(shape.value, 8 * kEpsilon) << shape.where;
  EXPECT_LT(slope.value, 8 * kEpsilon) << slope.where;
}

TEST(BranchKernel, ForceAloneEqualsForceComputedWithGradient) {
  for (const double alpha : Exponents()) {
    const std::vector<double> displacement = Displacements(alpha);
    std::vector<double> t(displacement.size());
    EvaluateGeneralRun(kBranch, alpha, 1.0, displacement, t);
    EXPECT_EQ(t, Evaluate(alpha, displacement).t) << alpha;
  }
}

TEST(BranchKernel, StaysFiniteAtTheEndsOfTheRange) {
  const std::vector<double> ends = {0.0, 5e-324, 1e-308, 1e-200, 1e100, 1e200};
  for (const double alpha : {0.0, 0.5, 1.0, 2.0, 100.0}) {
    const Columns columns = Evaluate(alpha, ends);
    for (std::size_t i = 0; i < ends.size(); ++i) {
      EXPECT_TRUE(columns.t[i] >= 0 && columns.t[i] <= 1) << alpha << ", " << ends[i];
      EXPECT_TRUE(std::isfinite(columns.rate[i])) << alpha << ", " << ends[i];
      EXPECT_TRUE(std::isfinite(columns.shape[i])) << alpha << ", " << ends[i];
      EXPECT_TRUE(std::isfinite(columns.unloaded[i])) << alpha << ", " << ends[i];
    }
  }
}

}  // namespace
}  // namespace mindahl::models::branch_kernel_test
