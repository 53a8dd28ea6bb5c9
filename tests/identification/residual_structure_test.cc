#include "identification/diagnosis/residual_structure.h"

#include "mindahl/identification/adequacy.h"
#include "recovery/recovered.h"
#include "support/prelude.h"

// What comes back in every stroke, told from noise.
namespace mindahl::identification::residual_structure_test {
namespace {

using namespace loop;

constexpr std::size_t kBins = 20;

ResidualStructure StructureOf(const History& displacement, const std::vector<double>& residual,
                              const std::vector<unsigned char>& counts) {
  return DescribeStructure(displacement, FindReversals(displacement, 0.0), residual, counts);
}

ResidualStructure StructureOf(const History& displacement, const std::vector<double>& residual) {
  return StructureOf(displacement, residual, std::vector<unsigned char>(displacement.size(), 1));
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
    EXPECT_EQ(structure.strokes, 10U);  // down; the way in and the way out are half strokes
  }
}

TEST(ResidualStructure, BinsHaveTheMeanAndSignOfEachDirection) {
  // Growing: linear in the position. Falling: constant, of the other sign. Off centre.
  constexpr double kOffset = 37.0;
  constexpr double kHalfBin = 0.5 / kBins;
  constexpr double kUp = 2.0;
  constexpr double kDown = -5.0;
  History displacement = Cycling(Wave::kTriangle, 1.0, 6.0, 400);
  for (double& x : displacement) x += kOffset;
  const ResidualStructure structure =
      StructureOf(displacement, ResidualsOf(displacement, [](double x, int direction) {
                    return direction > 0 ? kUp * (x - kOffset + 1) / 2 + 1e-3 : kDown;
                  }));
  const StrokeResiduals& up = structure.directions[0];
  const StrokeResiduals& down = structure.directions[1];
  EXPECT_EQ(up.direction, 1);
  EXPECT_EQ(down.direction, -1);
  EXPECT_EQ(up.strokes, 5U);
  EXPECT_EQ(down.strokes, 6U);
  ASSERT_EQ(up.bins.size(), kBins);
  ASSERT_EQ(down.bins.size(), kBins);
  // The sample on a reversal belongs to both strokes but has one residual: one of 200 of a stroke,
  // one of 10 of its bin.
  const double shared = (kUp - kDown) / 200;
  EXPECT_NEAR(up.mean, kUp / 2, shared + 2e-3);
  EXPECT_NEAR(down.mean, kDown, shared);
  for (std::size_t bin = 0; bin < kBins; ++bin) {
    const double middle = (static_cast<double>(bin) + 0.5) / kBins;
    const bool at_end = bin == 0 || bin + 1 == kBins;
    const double tolerance = kUp * kHalfBin + 2e-3 + (at_end ? (kUp - kDown) / 10 : 0);
    EXPECT_NEAR(up.bins[bin].position, middle, 1e-12);
    EXPECT_NEAR(up.bins[bin].mean, kUp * middle, tolerance) << bin;
    EXPECT_NEAR(down.bins[bin].mean, kDown, tolerance) << bin;
  }
}

TEST(ResidualStructure, StandardErrorOfABinIsThatOfItsMean) {
  // Ten samples of unit noise in a bin and 50 strokes: 1/√500. A scatter over 50 strokes is known
  // to 1/√100 = 10 %, its mean over 40 bins to 1.6 %.
  const History displacement = Cycling(Wave::kTriangle, 1.0, 51.0, 400);
  Generator generator(13);
  std::vector<double> residual;
  for (std::size_t i = 0; i < displacement.size(); ++i) residual.push_back(Normal(generator));
  double squares = 0.0;
  for (const StrokeResiduals& direction : StructureOf(displacement, residual).directions) {
    for (const StrokeBin& bin : direction.bins) {
      squares += bin.standard_error * bin.standard_error / (2 * kBins);
    }
  }
  EXPECT_NEAR(std::sqrt(squares * 505), 1.0, 0.08);
}

}  // namespace
}  // namespace mindahl::identification::residual_structure_test
