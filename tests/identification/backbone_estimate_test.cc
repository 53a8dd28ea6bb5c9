#include "mindahl/identification/backbone_estimate.h"

#include "identification/backbone_prior.h"
#include "identification/solve/linear_columns.h"
#include "recovery/recovered.h"
#include "support/masing_record.h"
#include "support/prelude.h"

// The backbone of a contact whose law nobody has written down.
namespace mindahl::identification::backbone_estimate_test {
namespace {

using loop::Record;

constexpr double kNoise = 0.005;  // of the slip force
constexpr double kAutocorrelated = 0.7;

Record Noisy(Record record, double slip_force, double autocorrelation, Generator& generator) {
  double state = Normal(generator);
  for (double& force : record.force) {
    force += kNoise * slip_force * state;
    state = autocorrelation * state +
            std::sqrt(1 - autocorrelation * autocorrelation) * Normal(generator);
  }
  return record;
}

Record Loop(const Backbone& backbone, double amplitude) {
  const History displacement = Cycling(Wave::kSine, amplitude, 3, 200);
  return MakeRecord(displacement, FollowBackbone(backbone, displacement));
}

struct Estimated {
  FitResult fit;
  BackboneEstimate backbone;
};

Estimated Estimate(const Record& record, const FitOptions& options = {}) {
  Estimated result{FitOne(record, options), {}};
  const loop::RecordView view(record);
  result.backbone = EstimateBackbone({&view, 1}, options, result.fit);
  return result;
}

bool Covers(const BandValue& band, double truth) {
  return band.lower95 <= truth && truth <= band.upper95;
}

double Secant(const Backbone& backbone, double amplitude) {
  constexpr double kFirst = 0.01;
  return backbone(kFirst * amplitude) / (kFirst * amplitude);
}

// Against the library's own sums of the same rules, of a law that it has.
TEST(FollowBackbone, IsTheResponseOfALawWhoseBackboneItIsGiven) {
  constexpr double kRounding = 1e-11;  // of a force of 40 N, of sixty branches
  const models::BranchLaw law{40.0, 1.0 / 3, 40.0};
  Generator generator(3);
  for (int k = 0; k < 200; ++k) {
    const History displacement = testing::RandomHistory(generator);
    const std::vector<double> expected = Respond(Model("mindlin-dahl"), law, displacement);
    const std::vector<double> force = FollowBackbone(
        [](double x) { return x >= 1.5 ? 40.0 : 40 * (1 - std::pow(1 - x / 1.5, 1.5)); },
        displacement);
    for (std::size_t i = 0; i < force.size(); ++i) {
      ASSERT_NEAR(force[i], expected[i], kRounding);
    }
  }
}

TEST(EstimateBackbone, StandsBesideTheLawBehindItsRig) {
  const models::BranchLaw law{4e7, 1.0 / 3, 40.0};
  constexpr double kRig = 2e7;  // [N/m]
  FitOptions options;
  options.fixed["rig_stiffness"] = kRig;
  const Estimated found = Estimate(testing::SprungLoop(law, kRig), options);
  ASSERT_TRUE(found.fit.converged);
  const models::BranchLaw& fitted = found.fit.law;
  const double slip =
      fitted.slip_force / (fitted.tangential_stiffness * (1 - fitted.shape_exponent));
  for (const BackbonePoint& point : found.backbone.points) {
    // The contact moves by the displacement less the deflection of the rig, and
    // T = Tc(1 − (1 − δ/δc)^(1/(1−α))).
    const double left = 1 - (point.displacement - point.law / kRig) / slip;
    const double expected =
        fitted.slip_force * (1 - std::pow(std::max(left, 0.0), 1 / (1 - fitted.shape_exponent)));
    EXPECT_NEAR(point.law, expected, 1e-6 * fitted.slip_force);
  }
  EXPECT_GT(found.backbone.points.back().law, 0.9 * fitted.slip_force);
}

TEST(SolveNonnegative, IsTheMinimumWhereNoneWouldBeNegative) {
  const Eigen::MatrixXd product{{2.0, 1.0}, {1.0, 3.0}};
  const Eigen::VectorXd w = SolveNonnegative(product, product * Eigen::Vector2d(0.5, 2.0));
  EXPECT_NEAR(w[0], 0.5, 1e-14);
  EXPECT_NEAR(w[1], 2.0, 1e-14);
}

TEST(SolveNonnegative, LeavesNoGradientBehindThatWouldHelp) {
  Generator generator(4);
  for (int k = 0; k < 100; ++k) {
    Eigen::MatrixXd a(12, 8);
    Eigen::VectorXd y(12);
    for (double& value : a.reshaped()) value = Normal(generator);
    for (double& value : y) value = Normal(generator);
    const Eigen::MatrixXd product = a.transpose() * a;
    const Eigen::VectorXd b = a.transpose() * y;
    const Eigen::VectorXd w = SolveNonnegative(product, b);
    const Eigen::VectorXd gradient = b - product * w;
    constexpr double kRounding = 1e-10;  // of sums of a dozen numbers of order one
    for (Eigen::Index j = 0; j < w.size(); ++j) {
      EXPECT_GE(w[j], 0.0);
      EXPECT_LE(gradient[j], kRounding);
      if (w[j] > 0) {
        EXPECT_NEAR(gradient[j], 0.0, kRounding);
      }
    }
    const Eigen::VectorXd again = SolveNonnegative(product, b, w);
    EXPECT_NEAR((again - w).norm(), 0.0, kRounding);
  }
}

/// Contacts of no law of this library, in partial slip.
struct Case {
  const char* name;
  Backbone backbone;
  double amplitude;
  double slip_force;
};

std::vector<Case> Cases() {
  const FourParameterIwan iwan;
  return {{"four parameters", iwan, 0.5 * iwan.GrossSlip(), iwan.slip_force},
          {"four parameters, slipping", iwan, 1.5 * iwan.GrossSlip(), iwan.slip_force},
          {"asperities", Asperities{}, 1.2e-6, Asperities{}.slip_force}};
}

TEST(BackboneEstimate, CoversTheStiffnessAndTheForceWhereTheLawIsConfidentlyWrong) {
  const FourParameterIwan iwan;
  const double amplitude = 0.5 * iwan.GrossSlip();
  const Record clean = Loop(iwan, amplitude);
  constexpr int kLoops = 10;
  constexpr int kLeast = 7;  // fewer of ten are covered at 95 % once in a thousand
  int stiffness = 0;
  int force = 0;
  Generator generator(11);
  for (int k = 0; k < kLoops; ++k) {
    const auto [fit, backbone] =
        Estimate(Noisy(clean, iwan.slip_force, kAutocorrelated, generator));
    EXPECT_GT(fit.law.slip_force, 5 * iwan.slip_force);  // what the law makes of it
    EXPECT_FALSE(backbone.reaches_plateau);
    if (Covers(backbone.first_stiffness, Secant(iwan, amplitude))) ++stiffness;
    if (Covers(backbone.points.back().force, iwan(amplitude))) ++force;
  }
  EXPECT_GE(stiffness, kLeast);
  EXPECT_GE(force, kLeast);
}

TEST(BackboneEstimate, ReachesAPlateauWhereTheContactSlips) {
  const FourParameterIwan iwan;
  Generator generator(12);
  const auto [fit, backbone] =
      Estimate(Noisy(Loop(iwan, 1.5 * iwan.GrossSlip()), iwan.slip_force, 0.0, generator));
  EXPECT_TRUE(backbone.reaches_plateau);
  EXPECT_NEAR(backbone.points.back().force.value / iwan.slip_force, 1.0, kNoise);
}

TEST(BackboneEstimate, IsTheLawWhereThatMadeTheRecord) {
  // Without noise what is left is how far elements of 44 kinds are from a law: ranges of the slip
  // displacement that are a sixth of it wide, (1/6)²/8 of a force of order one.
  constexpr double kDiscretisation = 0.004;
  const models::BranchLaw law{4e7, 1.0 / 3, 40.0};
  const History displacement = Cycling(Wave::kSine, 1.2e-6, 3, 200);
  const auto [fit, backbone] =
      Estimate(MakeRecord(displacement, Respond(Model("mindlin-dahl"), law, displacement)));
  for (const BackbonePoint& point : backbone.points) {
    EXPECT_NEAR(point.force.value, point.law, kDiscretisation * law.slip_force);
  }
}

TEST(BackboneEstimate, LeavesOutReadingsThatDoNotCount) {
  // Every other reading on one side is wrong by 3 Tc, and the force has an offset.
  constexpr double kDiscretisation = 0.004;  // as above
  const models::BranchLaw law{4e7, 1.0 / 3, 40.0};
  const History displacement = Cycling(Wave::kSine, 1.2e-6, 3, 200);
  Record record = MakeRecord(displacement, Respond(Model("mindlin-dahl"), law, displacement));
  FitOptions options;
  std::vector<bool>& out = options.preparation.held_out.emplace_back(record.size());
  for (double& force : record.force) force += 10;
  for (std::size_t i = 0; i < record.size(); i += 2) {
    if (record.displacement[i] < 0) continue;
    out[i] = true;
    record.force[i] += 3 * law.slip_force;
  }
  const auto [fit, backbone] = Estimate(record, options);
  for (const BackbonePoint& point : backbone.points) {
    EXPECT_NEAR(point.force.value, models::BackboneForce(law, point.displacement),
                kDiscretisation * law.slip_force);
  }
}

TEST(BackboneEstimate, IsConcaveAndRises) {
  Generator generator(13);
  const auto [fit, backbone] = Estimate(
      Noisy(Loop(Asperities{}, 1.2e-6), Asperities{}.slip_force, kAutocorrelated, generator));
  for (const SlipShare& share : backbone.elements) EXPECT_GE(share.stiffness, 0.0);
  EXPECT_GE(backbone.elastic.value, 0.0);
  double slope = HUGE_VAL;
  for (std::size_t i = 1; i < backbone.points.size(); ++i) {
    const BackbonePoint& at = backbone.points[i];
    const BackbonePoint& before = backbone.points[i - 1];
    const double next =
        (at.force.value - before.force.value) / (at.displacement - before.displacement);
    EXPECT_GE(next, 0.0);
    EXPECT_LE(next, slope * (1 + 1e-9));  // differences of rounded forces
    slope = next;
  }
}

TEST(BackboneEstimate, PriorIsAsUncertainAsTheEffectiveSamplesLeaveIt) {
  // √(4·600/150·9): of 600 samples that count as 150 twice what 600 would give.
  EXPECT_EQ(DeviationOfPrior(4.0, 600.0, 150.0, 9.0), 12.0);
}

TEST(BackboneEstimate, DoesNotKnowTheUnits) {
  Generator generator(14);
  const Record record = Noisy(Loop(Asperities{}, 1.2e-6), Asperities{}.slip_force, 0.0, generator);
  const BackboneEstimate one = Estimate(record).backbone;
  const BackboneEstimate other = Estimate(testing::Scaled(record, 1000.0, 0.001)).backbone;
  // The draws are the same; the weight of the smoothness is found to 4e-8 of its logarithm.
  constexpr double kSame = 1e-4;
  EXPECT_NEAR(other.first_stiffness.value / one.first_stiffness.value, 1e-6, kSame * 1e-6);
  EXPECT_NEAR(other.points.back().force.upper95 / one.points.back().force.upper95, 1e-3,
              kSame * 1e-3);
}

TEST(BackboneEstimate, IsRefusedOfWhatHasNone) {
  const Record record = Loop(Asperities{}, 1.2e-6);
  FitOptions dahl;
  dahl.model = &Model("dahl");
  EXPECT_THROW(Estimate(record, dahl), InvalidArgument);
  FitOptions lag;
  lag.terms = {"lag"};
  EXPECT_THROW(Estimate(record, lag), InvalidArgument);
}

/// Share of the displacements, but for the first fiftieth, at which the band covers the truth.
double Coverage(std::size_t each) {
  Generator generator(15);
  double covered = 0.0;
  double points = 0.0;
  for (const Case& contact : Cases()) {
    const Record clean = Loop(contact.backbone, contact.amplitude);
    for (const double autocorrelation : {0.0, kAutocorrelated}) {
      for (std::size_t k = 0; k < each; ++k) {
        const BackboneEstimate backbone =
            Estimate(Noisy(clean, contact.slip_force, autocorrelation, generator)).backbone;
        for (const BackbonePoint& point : backbone.points) {
          if (point.displacement < contact.amplitude / 50) continue;
          ++points;
          if (Covers(point.force, contact.backbone(point.displacement))) ++covered;
        }
      }
    }
  }
  return covered / points;
}

// Of a band that is 95 % on the average of its points, whose errors go together along a loop: a
// loop is off as a whole or not, and of so many loops the share scatters by √(0.05·0.95/loops).
TEST(BackboneEstimate, HasABandThatCoversTheTruth) {
  constexpr std::size_t kEach = 5;
  EXPECT_NEAR(Coverage(kEach), 0.95, 3 * std::sqrt(0.05 * 0.95 / (6.0 * kEach)));
}

TEST(BackboneBand, CoversTheTruthAtNineteenOfTwentyDisplacements) {
  constexpr std::size_t kEach = 50;
  const double coverage = Coverage(kEach);
  RecordProperty("coverage_in_thousandths", static_cast<int>(std::lround(1000 * coverage)));
  EXPECT_NEAR(coverage, 0.95, 3 * std::sqrt(0.05 * 0.95 / (6.0 * kEach)));
}

}  // namespace
}  // namespace mindahl::identification::backbone_estimate_test
