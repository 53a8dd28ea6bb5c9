#include "mindahl/methods/iwan.h"

#include <numeric>

#include "responses.h"
#include "support/prelude.h"

namespace mindahl::methods::iwan_test {
namespace {

using namespace models;

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
double Sum(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

/// Displacements at which an element slips: the corners of the polygon.
std::vector<double> Corners(const IwanElements& elements) {
  std::vector<double> corners;
  for (std::size_t i = 0; i < elements.size(); ++i) {
    corners.push_back(elements.slip_force[i] / elements.stiffness[i]);
  }
  return corners;
}

/// Largest error of the virgin curve [N]: at a corner, since the polygon lies outside.
double VirginError(const BranchLaw& law, const IwanElements& elements) {
  double worst = 0.0;
  for (const double corner : Corners(elements)) {
    double force = 0.0;
    for (std::size_t i = 0; i < elements.size(); ++i) {
      force += std::min(elements.stiffness[i] * corner, elements.slip_force[i]);
    }
    worst = std::max(worst, force - BackboneForce(law, corner));
  }
  return worst;
}

TEST(Iwan, StiffnessesSumToSigmaAndSlipForcesToTc) {
  for (const double alpha : {0.0, 1e-300, 1e-8, 0.1, 1.0 / 3, 0.999, 1.0, 1.001, 2.0, 50.0, 1e6}) {
    const BranchLaw law{4.8e8, alpha, 0.3};
    for (const std::size_t n : {1U, 2U, 7U, 100U, 2000U}) {
      const IwanElements elements = MakeIwanElements(law, n);
      const double rounding = static_cast<double>(n + 1) * kEpsilon;
      EXPECT_NEAR(Sum(elements.stiffness) / 4.8e8, 1, rounding) << alpha << " " << n;
      EXPECT_NEAR(Sum(elements.slip_force) / 0.3, 1, rounding) << alpha << " " << n;
      EXPECT_GE(std::ranges::min(elements.stiffness), 0) << alpha << " " << n;
      EXPECT_GE(std::ranges::min(elements.slip_force), 0) << alpha << " " << n;
    }
  }
}

TEST(Iwan, IsOneExactElementForJenkins) {
  const IwanElements elements = MakeIwanElements({4, 0.0, 3}, 10);
  EXPECT_EQ(elements.stiffness, std::vector<double>{4});
  EXPECT_EQ(elements.slip_force, std::vector<double>{3});
}

TEST(Iwan, LeavesItsErrorAndSecondOrder) {
  for (const double alpha : {0.05, 1.0 / 3, 0.5, 1.0, 2.0}) {
    const BranchLaw law{7, alpha, 3};
    // At the last corner, exactly, and between tangents near u = 1, to leading order in 1/n.
    const double last = alpha == 1 ? std::exp(-1.0) : std::pow(alpha, 1 / (1 - alpha));
    const double expected = 3 * std::max(alpha / 2, last);
    double coarse = 0.0;
    for (const double n : {16.0, 64.0, 256.0}) {
      const double error = VirginError(law, MakeIwanElements(law, static_cast<std::size_t>(n)));
      const double next = 2 * alpha / n;
      EXPECT_NEAR(error * n * n / expected, 1, next) << alpha << " " << n;
      if (coarse > 0) {
        EXPECT_NEAR(coarse / error, 16, 2 * 16 * next) << alpha << " " << n;
      }
      coarse = error;
    }
  }
}

TEST(Iwan, ErrorsDoubleAfterAReversal) {
  // The whole loop of a polygon that reaches slip: T = Tc − 2f(·/2), to the last corner.
  const BranchLaw law{1, 1.0 / 3, 1};
  const IwanElements elements = MakeIwanElements(law, 20);
  std::vector<double> drive = {5};
  std::vector<double> corners = Corners(elements);
  std::ranges::sort(corners);
  for (const double corner : corners) drive.push_back(5 - 2 * corner);
  std::vector<double> force(drive.size());
  EvaluateIwanForce(elements, drive, force);
  const auto exact = RespondBy("exact", "mindlin", law, {.displacement = drive});
  const double virgin = VirginError(law, elements);
  constexpr double kRounding = 1e-14;  // 20 elements, 20 steps
  EXPECT_NEAR(LargestDifference(force, exact), 2 * virgin, kRounding);
}

TEST(Iwan, IsMasingsLawWithItsReturnPoints) {
  // 20 000 elements know no rule of Masing's or Madelung's. Each of the remembered extrema, 16 in
  // the nested loops, errs by twice the virgin curve's error, every second to the same side.
  constexpr double kAccuracy = 16 * 0.1925 / (20'000.0 * 20'000.0);
  const BranchLaw law{1, 1.0 / 3, 1};
  for (const Waveform waveform : {Waveform::kRandom, Waveform::kNested, Waveform::kGrowingSine}) {
    const std::vector<double> drive = Displacements({.waveform = waveform,
                                                     .amplitude = 1.1 * ReferenceDisplacement(law),
                                                     .cycles = 8,
                                                     .samples_per_cycle = 14,
                                                     .seed = 3});
    const auto elements =
        RespondBy("iwan", "mindlin", law, {.displacement = drive}, {.steps = 20'000});
    const auto exact = RespondBy("exact", "mindlin", law, {.displacement = drive});
    EXPECT_LE(LargestDifference(elements, exact), kAccuracy);
  }
}

TEST(Iwan, RefusesNoElementAndSizesThatDiffer) {
  EXPECT_THROW(MakeIwanElements({1, 0.5, 1}, 0), InvalidArgument);
  EXPECT_THROW(MakeIwanElements({-1, 0.5, 1}, 4), InvalidArgument);
  std::vector<double> force(2);
  EXPECT_THROW(EvaluateIwanForce({{1}, {1}}, std::vector<double>{0, 1, 2}, force), InvalidArgument);
  EXPECT_THROW(EvaluateIwanForce({{1, 2}, {1}}, std::vector<double>{0, 1}, force), InvalidArgument);
}

}  // namespace
}  // namespace mindahl::methods::iwan_test
