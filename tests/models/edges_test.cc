// Inputs at the ends of the number range: a right answer or a refusal that names the limit.

#include "../support/histories.h"
#include "mindahl/models/branch_law.h"
#include "mindahl/models/excitation.h"
#include "mindahl/models/response.h"
#include "mindahl/models/steady_loop.h"
#include "support/prelude.h"

namespace mindahl::models::edges_test {
namespace {

constexpr double kDenormal = std::numeric_limits<double>::denorm_min();
constexpr double kSmallest = std::numeric_limits<double>::min();
constexpr double kLargest = std::numeric_limits<double>::max();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

TEST(Edges, ARecordThatNeverMovesHasNoForce) {
  for (const FrictionModel& model : FrictionModels()) {
    const BranchLaw law{1.0, model.shape_exponent.value_or(0.7), 1.0};
    EXPECT_EQ(Respond(model, law, {{0.0, 0.0, 0.0}}), (std::vector<double>{0.0, 0.0, 0.0}));
    EXPECT_EQ(Respond(model, law, {{5.0, 5.0}}, {.unloaded_displacement = 5.0}),
              (std::vector<double>{0.0, 0.0}));
  }
}

TEST(Edges, ADenormalDisplacementIsElastic) {
  // f = σx to far below rounding, for every law.
  for (const FrictionModel& model : FrictionModels()) {
    for (const double alpha : {0.0, 1.0 / 3.0, 1.0, 100.0}) {
      const BranchLaw law{1e10, alpha, 1.0};
      for (const double x : {kDenormal, 3 * kDenormal, 1e-310, kSmallest}) {
        EXPECT_EQ(Respond(model, law, {{x}}).front(), 1e10 * x);
        EXPECT_EQ(BackboneForce(law, x), 1e10 * x);
        EXPECT_EQ(SteadyPeakForce(Model("mindlin-dahl"), law, x), 1e10 * x);
      }
    }
  }
}

TEST(Edges, AForceThatStillGrowsIsRightFarFromSlip) {
  // α > 1 approaches Tc as a power of y: u = 1/(1 + y) for α = 2.
  const BranchLaw law{1.0, 2.0, 1.0};
  EXPECT_EQ(Respond(Model("mindlin-dahl"), law, {{1e100}}).front(), 1.0);
  EXPECT_EQ(BackboneRemaining(law, 1e250), 1e-250);
  EXPECT_NEAR(BackboneRemaining({1.0, 100.0, 1.0}, 1e300), std::pow(99e300, -1.0 / 99),
              1e-13);  // a power of a rounded base: 99e300 to an ulp, and pow
}

TEST(Edges, MixedExtremesAreRight) {
  // Atomic slip force, tectonic stiffness: λ = 1e45 and slipped; and the reverse: elastic.
  EXPECT_EQ(BackboneForce({1e15, 0.5, 1e-15}, 1e15), 1e-15);
  const BranchLaw soft{1e-9, 0.5, 1e12};
  EXPECT_EQ(BackboneForce(soft, 1e-18), 1e-9 * 1e-18);
  EXPECT_EQ(GrossSlipDisplacement(soft), 2e21);
  EXPECT_EQ(BackboneForce(soft, 2e21), 1e12);
}

TEST(Edges, AnInfiniteDisplacementHasSlippedForEveryLaw) {
  for (const double alpha : {0.0, 0.5, 1.0, 3.0}) {
    const BranchLaw law{2.0, alpha, 3.0};
    EXPECT_EQ(BackboneForce(law, kInfinity), 3.0);
    EXPECT_EQ(BackboneForce(law, -kInfinity), -3.0);
    EXPECT_EQ(BackboneRemaining(law, kInfinity), 0.0);
  }
}

TEST(Edges, ANumberThatIsNoneIsRefused) {
  const BranchLaw law{1.0, 0.5, 1.0};
  const std::string rule = "displacement [m] = nan is invalid: must be a number";
  EXPECT_EQ(MessageOf([&] { BackboneForce(law, kNan); }), rule);
  EXPECT_EQ(MessageOf([&] { BackboneRemaining(law, kNan); }), rule);
  EXPECT_NE(MessageOf([&] { SteadyPeakForce(Model("dahl"), law, kNan); }), "");
  EXPECT_NE(MessageOf([&] { SteadyPeakForce(Model("dahl"), law, kInfinity); }), "");
}

TEST(Edges, SteadyLoopsAreRightFromDenormalToHugeAmplitudes) {
  for (const FrictionModel& model : FrictionModels()) {
    for (const double alpha : {0.0, 0.5, 1.0, 3.0, 100.0}) {
      const BranchLaw law{1.0, alpha, 1.0};
      EXPECT_EQ(SteadyPeakForce(model, law, kDenormal), kDenormal) << model.name << ' ' << alpha;
      EXPECT_EQ(SteadyLoopEnergy(model, law, 1e-200), 0.0);  // 1e-600 J
      EXPECT_EQ(SteadyLoopEnergy(model, law, 0.0), 0.0);
    }
    // Coulomb's rectangle, 4XTc.
    EXPECT_EQ(SteadyLoopEnergy(model, {1.0, 0.5, 1.0}, 1e100), 4e100) << model.name;
  }
}

TEST(Edges, ExcitationsRefuseWhatNoDoubleHolds) {
  EXPECT_THAT(MessageOf([] { MakeExcitation({.amplitude = 1.0, .cycles = 1e-9}); }),
              HasSubstr("cycles times samples per cycle"));
  EXPECT_THAT(MessageOf([] { MakeExcitation({.amplitude = 1.0, .cycles = kNan}); }),
              HasSubstr("cycles"));
  for (const Waveform waveform : {Waveform::kSine, Waveform::kTriangle, Waveform::kGrowingSine}) {
    for (const double amplitude : {kDenormal, kSmallest, 1e100}) {
      const Excitation excitation =
          MakeExcitation({.waveform = waveform, .amplitude = amplitude, .growth = kLargest});
      for (const double at : excitation.displacement) {
        ASSERT_LE(std::abs(at), amplitude);
      }
    }
  }
}

}  // namespace
}  // namespace mindahl::models::edges_test
