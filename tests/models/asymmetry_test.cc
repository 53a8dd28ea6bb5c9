// Slip forces that differ in the two senses of the motion, against elements that know no history.

#include "mindahl/loop/reversals.h"
#include "mindahl/models/response.h"
#include "models/normalized_response.h"
#include "support/histories.h"
#include "support/prelude.h"

namespace mindahl::models::asymmetry_test {
namespace {

constexpr double kRounding = 64 * std::numeric_limits<double>::epsilon();  // a few branches deep
constexpr double kStiffness = 3.0;
constexpr double kSlipForce = 2.0;

const FrictionModel& Masing() { return Model("mindlin-dahl"); }

BranchLaw LawOf(double alpha) {
  return {.tangential_stiffness = kStiffness, .shape_exponent = alpha, .slip_force = kSlipForce};
}

/// Springs of one stiffness behind sliders with limits f(1 + a) and −f(1 − a), which are all that
/// they know. Slip displacements are the middles of equal shares of the backbone's slope, whose
/// inverse is x = δc·(1 − s^{(1−α)/α}), s the share that still sticks.
class Sliders {
 public:
  Sliders(const BranchLaw& law, double asymmetry, std::size_t count)
      : asymmetry_(asymmetry), stiffness_(law.tangential_stiffness / static_cast<double>(count)) {
    const double alpha = law.shape_exponent;
    const double gross_slip = GrossSlipDisplacement(law);
    for (std::size_t i = 0; i < count; ++i) {
      const double sticks = (static_cast<double>(i) + 0.5) / static_cast<double>(count);
      limit_.push_back(stiffness_ * gross_slip * (1 - std::pow(sticks, (1 - alpha) / alpha)));
    }
    force_.assign(count, 0.0);
  }

  double MoveTo(double displacement) {
    double sum = 0.0;
    for (std::size_t i = 0; i < force_.size(); ++i) {
      force_[i] = std::clamp(force_[i] + stiffness_ * (displacement - displacement_),
                             -limit_[i] * (1 - asymmetry_), limit_[i] * (1 + asymmetry_));
      sum += force_[i];
    }
    displacement_ = displacement;
    return sum;
  }

 private:
  double asymmetry_;
  double stiffness_;
  double displacement_ = 0.0;
  std::vector<double> limit_;
  std::vector<double> force_;
};

/// Turns anywhere within ±reach, with inner loops and strokes that outdo all before.
std::vector<double> RandomWalk(double reach, std::size_t turns, std::uint64_t seed) {
  Generator generator(seed);
  constexpr int kSamplesAStroke = 7;
  std::vector<double> walk = {0.0};
  for (std::size_t k = 0; k < turns; ++k) {
    const double from = walk.back();
    const double widening = static_cast<double>(k + 1) / static_cast<double>(turns);
    const double to = reach * widening * Uniform(generator, -1, 1);
    for (int i = 1; i <= kSamplesAStroke; ++i) {
      walk.push_back(from + (to - from) * i / kSamplesAStroke);
    }
  }
  return walk;
}

TEST(Asymmetry, IsThatOfElementsOfUnequalLimitsOnAnyHistory) {
  constexpr std::size_t kElements = 4000;
  for (const double alpha : {0.2, 1.0 / 3, 0.7}) {
    const BranchLaw law = LawOf(alpha);
    const double gross_slip = GrossSlipDisplacement(law);
    for (const double asymmetry : {-0.6, 0.0, 0.3, 0.8}) {
      // Each element stands for a range of slip displacements, which together are δc: none is off
      // by more than its stiffness times its range.
      const double of_elements =
          (1 + std::abs(asymmetry)) * kStiffness * gross_slip / static_cast<double>(kElements);
      for (const std::uint64_t seed : {1U, 2U, 3U}) {
        const std::vector<double> walk = RandomWalk(2.2 * gross_slip, 40, seed);
        const std::vector<double> force = Respond(Masing(), law, walk, {.asymmetry = asymmetry});
        Sliders sliders(law, asymmetry, kElements);
        for (std::size_t i = 0; i < walk.size(); ++i) {
          ASSERT_NEAR(force[i], sliders.MoveTo(walk[i]), of_elements)
              << "alpha " << alpha << ", asymmetry " << asymmetry << ", sample " << i;
        }
      }
    }
  }
}

TEST(Asymmetry, IsAnOffsetOfTheForceOnceTheContactHasSlippedAsAWhole) {
  const BranchLaw law = LawOf(0.5);
  constexpr double kAsymmetry = -0.35;
  const double gross_slip = GrossSlipDisplacement(law);
  // Past slip in one sense, every element is at its limit, and goes on as a symmetric one would.
  std::vector<double> history = {2 * gross_slip};
  for (const double more : RandomWalk(1.5 * gross_slip, 20, 5)) history.push_back(more);
  const std::vector<double> force = Respond(Masing(), law, history, {.asymmetry = kAsymmetry});
  const std::vector<double> symmetric = Respond(Masing(), law, history, {});
  const InitialContact steady{.state = InitialState::kSteady, .asymmetry = kAsymmetry};
  const std::vector<double> cycled = Respond(Masing(), law, history, steady);
  const std::vector<double> cycled_symmetric =
      Respond(Masing(), law, history, {.state = InitialState::kSteady});
  for (std::size_t i = 0; i < history.size(); ++i) {
    EXPECT_NEAR(force[i] - symmetric[i], kAsymmetry * kSlipForce, kRounding * kSlipForce);
    EXPECT_NEAR(cycled[i] - cycled_symmetric[i], kAsymmetry * kSlipForce, kRounding * kSlipForce);
  }
}

/// Behind a spring every force belongs to the contact's own displacement, δ − T/k.
TEST(Asymmetry, BehindARigIsThatOfTheContactsOwnDisplacement) {
  const BranchLaw law = LawOf(1.0 / 3);
  constexpr SeriesSpring kRig{.stiffness = 0.8 * kStiffness};
  constexpr double kSteep = 1e-12;  // of Tc: x is rounded, and T follows it with slope σ and k
  const std::vector<double> walk = RandomWalk(4 * GrossSlipDisplacement(law), 30, 8);
  const std::vector<double> force = Respond(Masing(), law, walk, {.asymmetry = 0.3}, kRig);
  std::vector<double> contact(walk.size());
  for (std::size_t i = 0; i < walk.size(); ++i) contact[i] = walk[i] - force[i] / kRig.stiffness;
  const LoadingPath path = MakeLoadingPath(contact, loop::FindReversals(walk, 0.0),
                                           Memory::kReturnPoint, {.asymmetry = 0.3});
  std::vector<double> of_contact(walk.size());
  EvaluateForce(Masing(), law, path, contact, of_contact);
  for (std::size_t i = 0; i < walk.size(); ++i) {
    EXPECT_NEAR(force[i], of_contact[i], kSteep * kSlipForce) << i;
  }
}

TEST(Asymmetry, HasItsDerivativeOnEveryBranch) {
  constexpr double kStep = 1e-5;
  // Central differences: a third of the third derivative, at most 1/(1 − |a|)³ or so, times the
  // step's square, and rounding over the step. Next to slip of α < 1/2 the second derivative has no
  // bound, and neither has the difference's error: 1 % of a corner that is a step wide.
  constexpr double kDifference = 2e-5;
  for (const double alpha : {0.5, 0.8, 1.0}) {
    for (const double travel : {0.0, 0.7}) {
      for (const InitialState state : {InitialState::kVirgin, InitialState::kSteady}) {
        const NormalizedLaw law{.rate = 1.5, .shape_exponent = alpha, .spring_travel = travel};
        const std::vector<double> walk = RandomWalk(1.8, 30, 21);
        const auto evaluate = [&](double asymmetry, std::span<double> derivative) {
          const LoadingPath path = PathOf(Masing(), walk, {.state = state, .asymmetry = asymmetry});
          std::vector<double> t(walk.size());
          NormalizedGradient gradient;
          gradient[kAsymmetry] = derivative;
          EvaluateNormalizedForce(Masing(), law, path, walk, t, gradient);
          return t;
        };
        for (const double asymmetry : {-0.45, 0.0, 0.2}) {
          std::vector<double> derivative(walk.size());
          evaluate(asymmetry, derivative);
          const std::vector<double> above = evaluate(asymmetry + kStep, {});
          const std::vector<double> below = evaluate(asymmetry - kStep, {});
          for (std::size_t i = 0; i < walk.size(); ++i) {
            EXPECT_NEAR(derivative[i], (above[i] - below[i]) / (2 * kStep), kDifference)
                << "alpha " << alpha << ", travel " << travel << ", asymmetry " << asymmetry
                << ", sample " << i;
          }
        }
      }
    }
  }
}

TEST(Asymmetry, IsRefusedBeyondOneAndOfALawWithoutMemory) {
  const std::vector<double> way = {0.0, 1.0};
  for (const double wrong : {1.0, -1.0, 1.5, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_THROW(PathOf(Masing(), way, {.asymmetry = wrong}), InvalidArgument);
  }
  EXPECT_THROW(MakeLoadingPath(way, {}, Memory::kNone, {.asymmetry = 0.1}), InvalidArgument);
}

}  // namespace
}  // namespace mindahl::models::asymmetry_test
