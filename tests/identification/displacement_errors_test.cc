

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
  const DisplacementErrors errors(stages.prepared, stages.data);
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
    const std::vector<double> smoothed = record.smoother->Smooth(read(truth, generator));
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

TEST(DisplacementErrors, MoveTheTurningPointToTheNewExtreme) {
  // A slider that slips stands at its slip force where it turns; on the way back its force is off
  // by the errors of the sample and of the turning point, which is the outermost of what is drawn.
  constexpr double kNoise = 0.05;
  constexpr double kSigma = 4.0;  // sticks for half the amplitude
  constexpr std::size_t kDraws = 2000;
  constexpr std::size_t kCycle = 80;
  constexpr std::size_t kNear = kCycle / 5;
  Generator generator(5);
  Record record;
  record.displacement = Cycling(Wave::kSine, 1.0, 6.0, kCycle);
  record.force = testing::Respond(Model("jenkins"), {kSigma, 0.0, 1.0}, record.displacement);
  for (double& x : record.displacement) x += kNoise * Normal(generator);
  Stages stages(record, Jenkins(kNoise));
  const PreparedRecord& prepared = stages.prepared.records[0];
  const std::span<const double> truth = prepared.displacement();
  const std::vector<std::size_t> reversals(prepared.reversals.begin(), prepared.reversals.end());
  ASSERT_EQ(reversals.size(), 12U);
  const auto sense = [&](std::size_t reversal) { return truth[reversal] > 0 ? 1.0 : -1.0; };
  const auto sticks = [&](std::size_t reversal, std::size_t i) {
    const double back = std::abs(truth[reversal] - truth[i]);
    return 0.15 < back && back < 0.35;
  };

  double expected = 0.0;
  double kept = 0.0;  // with the sample that was the outermost
  double samples = 0.0;
  for (std::size_t k = 0; k < kDraws; ++k) {
    std::vector<double> reading(truth.begin(), truth.end());
    for (double& x : reading) x += kNoise * Normal(generator);
    const std::vector<double> drawn = prepared.smoother->Smooth(reading);
    for (const std::size_t reversal : reversals) {
      const double s = sense(reversal);
      double outermost = s * drawn[reversal];
      for (std::size_t i = reversal - kNear; i < reversal + kNear; ++i) {
        outermost = std::max(outermost, s * drawn[i]);
      }
      for (std::size_t i = reversal; i < reversal + kNear; ++i) {
        if (!sticks(reversal, i)) continue;
        const double own = s * (drawn[i] - truth[i]);
        expected += own - (outermost - s * truth[reversal]);
        kept += own - s * (drawn[reversal] - truth[reversal]);
        ++samples;
      }
    }
  }

  std::vector<double> theta;
  const Parameters& parameters = stages.problem.parameters;
  for (std::size_t p = 0; p < parameters.size(); ++p) theta.push_back(parameters[p].theta);
  theta[kStiffness] = parameters[kStiffness].ToTheta(kSigma);
  theta[kSlipForce] = parameters[kSlipForce].ToTheta(1.0);
  theta[kShape] = 0.0;
  const DisplacementErrors errors(stages.prepared, stages.data);
  const Eigen::MatrixXd force = errors.ForceErrors(stages.problem, theta) * stages.data.force;
  double found = 0.0;
  for (const std::size_t reversal : reversals) {
    for (std::size_t i = reversal; i < reversal + kNear; ++i) {
      if (!sticks(reversal, i)) continue;
      found += sense(reversal) * force.row(static_cast<Eigen::Index>(i)).mean() / kSigma;
    }
  }
  expected /= samples;
  kept /= samples;
  found /= samples / kDraws;
  // 200 draws of twelve turning points, whose errors are some 0.02: to 0.02/√2400.
  constexpr double kOfTheMean = 3 * 0.0004;
  EXPECT_GT(std::abs(expected - kept), 2 * kOfTheMean) << "the case needs it";
  EXPECT_NEAR(found, expected, kOfTheMean);
}

}  // namespace
}  // namespace mindahl::identification::displacement_errors_test
