#include "../support/histories.h"
#include "../support/reference_table.h"
#include "mindahl/models/backbone.h"
#include "mindahl/models/branch_law.h"
#include "mindahl/models/steady_loop.h"
#include "support/prelude.h"

namespace mindahl::models::branch_law_table_test {
namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

/// branch_law.h: computed in long double (64 bits) and rounded once. Half an ulp of rounding is at
/// most kEpsilon/2 and the closed forms lose 4 bits of the spare 11.
constexpr double kRoundedOnce = 1.0 * kEpsilon;

/// The kernels work in double. log1p, expm1 and three products, each within an ulp.
constexpr double kKernelForce = 4 * kEpsilon;

/// exp passes on the error of its argument: |log u| <= 745 in double, half an ulp each.
constexpr double kKernelDerivative = 400 * kEpsilon;

/// steady_loop.h; the amplitude over the elastic limit is rounded first, and the energy is its
/// cube.
constexpr double kEnergy = 8 * kEpsilon;

struct Row {
  double shape_exponent, y;
  long double force, remaining, slope, work, per_log_stiffness, per_shape, per_log_slip_force,
      loop_energy;
};

std::vector<Row> ReadRows() {
  std::vector<Row> rows;
  for (const auto& line : ReadTable("branch_law.csv")) {
    rows.push_back({ToDouble(line[0]), ToDouble(line[1]), ToLongDouble(line[2]),
                    ToLongDouble(line[3]), ToLongDouble(line[4]), ToLongDouble(line[5]),
                    ToLongDouble(line[6]), ToLongDouble(line[7]), ToLongDouble(line[8]),
                    ToLongDouble(line[9])});
  }
  return rows;
}

/// Error over `scale`; what underflows double must be 0 or as small.
double Error(double value, long double reference, long double scale) {
  constexpr long double kSmallestNormal = std::numeric_limits<double>::min();
  const long double error = std::abs(value - reference);
  if (error <= kSmallestNormal) return 0.0;
  return static_cast<double>(error / std::abs(scale));
}

/// Runs `error(law, row)` over the table and compares with `bound`.
template <typename ErrorOf>
void ExpectWithin(double bound, ErrorOf error_of) {
  const std::vector<Row> rows = ReadRows();
  EXPECT_GE(rows.size(), 15U * 45U);  // shape exponents, displacements
  for (const Row& row : rows) {
    const BranchLaw law{1.0, row.shape_exponent, 1.0};
    EXPECT_LE(error_of(law, row), bound) << "alpha = " << row.shape_exponent << ", y = " << row.y;
  }
}

TEST(BranchLawTable, ForceRemainingFractionSlopeAndWorkAreRoundedOnce) {
  ExpectWithin(kRoundedOnce, [](const BranchLaw& law, const Row& row) {
    return std::max({Error(BackboneForce(law, row.y), row.force, row.force),
                     Error(BackboneRemaining(law, row.y), row.remaining, row.remaining),
                     Error(BackboneSlope(law, row.y), row.slope, row.slope),
                     Error(BackboneWork(law, row.y), row.work, row.work)});
  });
}

TEST(BranchLawTable, MasingLoopEnergyHasNoCancellation) {
  ExpectWithin(kEnergy, [](const BranchLaw& law, const Row& row) {
    return Error(SteadyLoopEnergy(Model("mindlin-dahl"), law, row.y), row.loop_energy,
                 row.loop_energy);
  });
}

TEST(BranchLawTable, KernelForceIsWithinFourUlp) {
  ExpectWithin(kKernelForce, [](const BranchLaw& law, const Row& row) {
    const double force = backbone::WithShape(law.shape_exponent,
                                             [&](const auto& shape) { return shape.Force(row.y); });
    return Error(force, row.force, row.force);
  });
}

TEST(BranchLawTable, KernelDerivativesKeepTheDigitsOfTheExponential) {
  ExpectWithin(kKernelDerivative, [](const BranchLaw& law, const Row& row) {
    const auto phi = backbone::Differentiate(row.y, law.shape_exponent);
    return std::max({Error(phi.force, row.force, row.force), Error(phi.slope, row.slope, row.slope),
                     Error(phi.elastic, row.per_log_stiffness, row.per_log_stiffness),
                     Error(phi.shape_derivative, row.per_shape, row.per_shape)});
  });
}

}  // namespace
}  // namespace mindahl::models::branch_law_table_test
