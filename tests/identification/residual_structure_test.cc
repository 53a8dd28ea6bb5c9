#include "identification/diagnosis/residuals.h"
#include "recovery/recovered.h"
#include "support/prelude.h"

// What comes back in every stroke, told from noise.
namespace mindahl::identification::residual_structure_test {
namespace {

using namespace loop;

ResidualStructure StructureOf(const History& displacement, const std::vector<double>& residual) {
  const std::vector<std::size_t> reversals = FindReversals(displacement, 0.0);
  ScaledRecord record;
  record.displacement.assign(displacement.begin(), displacement.end());
  record.force.resize(displacement.size());
  record.counts.assign(displacement.size(), 1);
  record.reversals = reversals;
  return DescribeStructure(record, residual, {});
}

/// Residuals from displacement and direction of motion, +1 or −1, which the sample ends.
std::vector<double> ResidualsOf(const History& displacement,
                                const std::function<double(double, int)>& residual) {
  std::vector<double> values;
  int direction = 1;
  for (std::size_t i = 0; i < displacement.size(); ++i) {
    if (i > 0 && displacement[i] != displacement[i - 1]) {
      direction = displacement[i] > displacement[i - 1] ? 1 : -1;
    }
    values.push_back(residual(displacement[i], direction));
  }
  return values;
}

TEST(ResidualStructure, NoiseRepeatsNothing) {
  // The F test finds something in noise in 0.1 % of the records: in more than 4 of 200 with a
  // probability of 2e-6.
  constexpr int kSeeds = 200;
  constexpr int kMost = 4;
  const History displacement = Cycling(Wave::kSine, 1.0, 4.0, 200);
  int found = 0;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    Generator generator(static_cast<std::uint64_t>(seed));
    std::vector<double> residual;
    for (std::size_t i = 0; i < displacement.size(); ++i) residual.push_back(Normal(generator));
    if (StructureOf(displacement, residual).repeatable_share > 0) ++found;
  }
  EXPECT_LE(found, kMost);
}

TEST(ResidualStructure, FractionIsVarianceThatRepeats) {
  // Triangles, so that every part of a stroke has as many samples. Bins of a twentieth flatten
  // sin 3x by (3·0.1)²/12 = 0.8 % of its variance, and the variance of noise over 2000 samples is
  // known to √(2/2000) = 3 %.
  constexpr double kShareError = 0.05;
  const History displacement = Cycling(Wave::kTriangle, 1.0, 10.0, 200);
  for (const double noise : {0.1, 0.7, 2.0}) {
    Generator generator(7);
    double mean = 0.0;
    double squares = 0.0;
    std::vector<double> residual =
        ResidualsOf(displacement, [](double x, int) { return std::sin(3 * x); });
    for (double& value : residual) {
      mean += value / static_cast<double>(residual.size());
      squares += value * value / static_cast<double>(residual.size());
      value += noise * Normal(generator);
    }
    ASSERT_NEAR(mean, 0.0, 0.01);
    const ResidualStructure structure = StructureOf(displacement, residual);
    EXPECT_NEAR(structure.repeatable_share, squares / (squares + noise * noise), kShareError)
        << noise;
    // The way in and the way out are half strokes.
    EXPECT_EQ(structure.strokes, (std::array<std::size_t, 2>{9, 10}));
  }
}

}  // namespace
}  // namespace mindahl::identification::residual_structure_test
