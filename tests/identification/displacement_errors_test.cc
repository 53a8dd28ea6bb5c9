

#include "identification/inference/reweighting.h"
#include "identification/sample_loop.h"
#include "identification/stages.h"
#include "support/prelude.h"

// Drawn readings against readings that are drawn here.
namespace mindahl::identification::displacement_errors_test {
namespace {

using namespace loop;
using namespace models;

/// Root mean square of the errors of the drawn displacements over the half range: a Jenkins element
/// that never slips is a spring, whose force errs in proportion.
double ErrorOfASpring(Stages& stages) {
  const DisplacementErrors errors(loop::DrawReadings(stages.prepared), stages.data);
  std::vector<double> theta;
  const Parameters& parameters = stages.problem.parameters;
  for (std::size_t p = 0; p < parameters.size(); ++p) theta.push_back(parameters[p].theta);
  theta[kStiffness] = 0.0;
  theta[kSlipForce] = std::log(100.0);
  theta[kShape] = 0.0;
  const Eigen::MatrixXd force = errors.ForceErrors(stages.problem, theta);
  return std::sqrt(force.squaredNorm() / static_cast<double>(force.size()));
}

template <typename Read>
double ErrorOfReadings(const Stages& stages, Read read) {
  constexpr int kDraws = 200;
  Generator generator(77);
  const PreparedRecord& record = stages.prepared.records[0];
  const std::span<const double> truth = record.displacement();
  double squares = 0.0;
  for (int k = 0; k < kDraws; ++k) {
    const std::vector<double> smoothed = loop::Smoothed(read(truth, generator), record.smoothing);
    for (std::size_t i = 0; i < truth.size(); ++i) squares += std::pow(smoothed[i] - truth[i], 2);
  }
  return std::sqrt(squares / (kDraws * static_cast<double>(truth.size()))) / stages.data.length;
}

/// 200 draws of hundreds of samples: to a few per cent, correlated as they are.
constexpr double kDrawn = 0.05;

FitOptions Jenkins(std::optional<double> noise = std::nullopt) {
  FitOptions options;
  options.model = &Model("jenkins");
  options.preparation.displacement_noise = noise;
  return options;
}

TEST(DisplacementErrors, OfReadingsThatRepeatAreOneError) {
  constexpr double kNoise = 0.02;
  Generator generator(5);
  const History sine = Cycling(Wave::kSine, 1.0, 3.0, 80);
  Record record;
  for (const double x : sine) {
    const double reading = x + kNoise * Normal(generator);
    for (int twice = 0; twice < 2; ++twice) {
      record.displacement.push_back(reading);
      record.force.push_back(x);
    }
  }
  Stages stages(record, Jenkins(kNoise));
  const double expected = ErrorOfReadings(stages, [&](std::span<const double> truth, auto& random) {
    std::vector<double> reading;
    double error = 0.0;
    for (std::size_t i = 0; i < truth.size(); ++i) {
      if (i % 2 == 0) error = kNoise * Normal(random);
      reading.push_back(truth[i] + error);
    }
    return reading;
  });
  EXPECT_NEAR(ErrorOfASpring(stages) / expected, 1.0, kDrawn);
}

TEST(DisplacementErrors, OfAnEncoderAreThoseOfItsRoundingAlone) {
  constexpr double kStep = 0.02;
  History displacement = Cycling(Wave::kSine, 1.0, 3.0, 200);
  const History truth_of = displacement;
  for (double& x : displacement) x = kStep * std::round(x / kStep + 0.3) - 0.3 * kStep;
  Stages stages(MakeRecord(displacement, truth_of), Jenkins());
  ASSERT_NEAR(stages.prepared.records[0].encoder_step, kStep, 1e-9);
  ASSERT_GT(stages.prepared.records[0].displacement_noise, 0.0);
  ASSERT_LE(stages.prepared.records[0].displacement_noise, kStep);
  const double expected = ErrorOfReadings(stages, [&](std::span<const double> truth, auto& random) {
    const double phase = Uniform(random, 0, 1);
    std::vector<double> reading;
    for (const double x : truth) {
      reading.push_back(kStep * (std::round(x / kStep + phase) - phase));
    }
    return reading;
  });
  EXPECT_NEAR(ErrorOfASpring(stages) / expected, 1.0, kDrawn);
}

}  // namespace
}  // namespace mindahl::identification::displacement_errors_test
