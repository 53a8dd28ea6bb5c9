#include "mindahl/models/response.h"

#include <boost/multiprecision/cpp_bin_float.hpp>

#include "../../tools/reference/exact_history.h"
#include "../support/histories.h"
#include "mindahl/models/branch_law.h"
#include "mindahl/models/excitation.h"
#include "support/prelude.h"

namespace mindahl::models::response_test {
namespace {

/// The contact of Peyret et al. (2017) §3; σ from eq. 21, not the printed value.
constexpr double kRadius = 0.0027;
constexpr double kCompliance = 4.42e-11;
constexpr double kSlipForce = 0.3 * 100;
constexpr BranchLaw kPaperLaw = {8 * kRadius / kCompliance, 1.0 / 3.0, kSlipForce};

constexpr std::size_t kCycles = 5;
constexpr std::size_t kPerCycle = 1000;  // samples

std::vector<double> PaperSine(double lambda, double cycles, std::size_t samples_per_cycle) {
  return MakeExcitation({.amplitude = lambda * GrossSlipDisplacement(kPaperLaw),
                         .cycles = cycles,
                         .samples_per_cycle = samples_per_cycle})
      .displacement;
}

/// Mindlin's contact as the paper writes it, eqs 13-15 with the minus of eq. 15 restored, between
/// ±δ*. Beyond gross slip, where eqs 14 and 15 have lost δ*, it is counted from where sticking
/// ends.
class PaperMindlin {
 public:
  explicit PaperMindlin(double amplitude) {
    peak_ = Virgin(amplitude);
    const double slip = 3 * kSlipForce * kCompliance / (16 * kRadius);
    slipped_ = std::max(amplitude - slip, 0.0);
  }
  static double Virgin(double x) {  // eq. 13
    const double base = std::max(1 - Scaled(std::abs(x)), 0.0);
    return std::copysign(kSlipForce * (1 - std::pow(base, 1.5)), x);
  }
  [[nodiscard]] double Unloading(double x) const {  // eq. 14
    return peak_ - 2 * kSlipForce * (1 - Power(Scaled(x - slipped_)));
  }
  [[nodiscard]] double Reloading(double x) const {  // eq. 15
    return -peak_ + 2 * kSlipForce * (1 - Power(-Scaled(x + slipped_)));
  }

 private:
  static double Scaled(double x) { return 16 * kRadius * x / (3 * kSlipForce * kCompliance); }
  [[nodiscard]] double Power(double scaled) const {
    const double stuck = std::pow(1 - peak_ / kSlipForce, 2.0 / 3.0);
    return std::pow(std::max((scaled + stuck + 1) / 2, 0.0), 1.5);
  }
  double peak_ = 0.0;
  double slipped_ = 0.0;
};

TEST(FullDahl, IsMindlinIdentically) {
  // Against the paper's own equations; (1 − T*/Tc)^{2/3} there loses digits near slip: the root of
  // 1e-16 at the worst.
  constexpr double kRounding = 1e-14;  // of Tc
  constexpr double kNearSlip = 1e-10;  // of Tc
  for (const double lambda : {0.01, 0.3, 0.8, 0.99, 1.0, 1.2, 3.0}) {
    const History history = PaperSine(lambda, kCycles, kPerCycle);
    const double amplitude = *std::ranges::max_element(history);
    const PaperMindlin mindlin(amplitude);
    const std::vector<double> force = Respond(Model("mindlin-dahl"), kPaperLaw, history);
    const double bound = (lambda > 0.9 && lambda < 1.1 ? kNearSlip : kRounding) * kSlipForce;
    for (std::size_t i = 0; i < history.size(); ++i) {
      const std::size_t phase = (i + kPerCycle / 4) % kPerCycle;  // 0 at the lower extreme
      const double expected = i <= kPerCycle / 4      ? PaperMindlin::Virgin(history[i])
                              : phase < kPerCycle / 2 ? mindlin.Reloading(history[i])
                                                      : mindlin.Unloading(history[i]);
      ASSERT_NEAR(force[i], expected, bound) << "lambda = " << lambda << ", sample " << i;
    }
  }
}

/// Largest |T − Mindlin| in each cycle of a sine, in % of T*.
std::vector<double> ErrorsByCycle(const History& history, const std::vector<double>& force) {
  const std::vector<double> mindlin = Respond(Model("mindlin"), kPaperLaw, history);
  const double peak = *std::ranges::max_element(mindlin);
  std::vector<double> errors(kCycles);
  for (std::size_t i = 0; i < kCycles * kPerCycle; ++i) {
    double& worst = errors[i / kPerCycle];
    worst = std::max(worst, 100 * std::abs(force[i] - mindlin[i]) / peak);
  }
  return errors;
}

std::vector<double> SimplifiedDahlErrors(double lambda) {
  const History history = PaperSine(lambda, kCycles, kPerCycle);
  return ErrorsByCycle(history, Respond(Model("simplified-dahl"), kPaperLaw, history));
}

/// Eqs 26 and 27 as printed: the virgin curve, then branches that refer to a T* given beforehand,
/// here Mindlin's; with σ off, they refer to a force that they do not reach.
std::vector<double> PrintedFullDahl(double stiffness, const History& history) {
  using Real = boost::multiprecision::cpp_bin_float_50;
  const reference::Law<Real> law{Real(stiffness), Real(1) / 3, Real(kSlipForce)};
  const Real peak = BackboneForce(kPaperLaw, *std::ranges::max_element(history));
  std::vector<double> force;
  Real present = 0;
  for (std::size_t i = 0; i < history.size(); ++i) {
    if (i <= kPerCycle / 4) {
      present = reference::Backbone(law, Real(history[i]));
    } else {
      present = reference::SimplifiedDahlStep(law, peak, present,
                                              Real(Real(history[i]) - Real(history[i - 1])));
    }
    force.push_back(static_cast<double>(present));
  }
  return force;
}

/// docs/theory.md §2; each value to half a unit of its last printed digit, and a little for the
/// sampling of the sine.
void ExpectErrors(const std::vector<double>& errors, const std::vector<double>& printed,
                  const std::vector<double>& half_units) {
  for (std::size_t i = 0; i < errors.size(); ++i) {
    EXPECT_NEAR(errors[i], printed[i], 1.05 * half_units[i]) << "cycle " << i + 1;
  }
}

TEST(SimplifiedDahl, ConvergesFivefoldACycleInMicroSlip) {
  ExpectErrors(SimplifiedDahlErrors(0.8), {11.4, 3.57, 0.719, 0.144, 0.029},
               {0.05, 0.005, 0.0005, 0.0005, 0.0005});
}

TEST(SimplifiedDahl, IsRightFromTheSecondCycleOnInGrossSlip) {
  constexpr double kRounding = 1e-10;
  ExpectErrors(SimplifiedDahlErrors(1.2), {13.3, 0, 0, 0, 0},
               {0.05, kRounding, kRounding, kRounding, kRounding});
}

TEST(FullDahl, WithThePrintedStiffnessIsOffByTheRoundingOfTheRadius) {
  const History history = PaperSine(0.8, kCycles, kPerCycle);
  ExpectErrors(ErrorsByCycle(history, PrintedFullDahl(4.839e8, history)),
               {0.93, 0.84, 0.82, 0.81, 0.81}, {0.005, 0.005, 0.005, 0.005, 0.005});
  // With the exact one the printed equations are the model, and both are Mindlin.
  constexpr double kRounding = 1e-11;
  ExpectErrors(ErrorsByCycle(history, PrintedFullDahl(kPaperLaw.tangential_stiffness, history)),
               {0, 0, 0, 0, 0}, {kRounding, kRounding, kRounding, kRounding, kRounding});
}

TEST(FullDahl, WithItsOwnPeakForceIsOffByTheSameInEveryCycle) {
  // The memory refers to the force reached: no transient. By hand, to first order in Δ ln σ: f
  // moves by g = x·f' = 1.5·λ·√(1−λ)·Tc, a branch by 2g(λ') − g(0.8), most at λ' = 2/3.
  const BranchLaw printed{4.839e8, 1.0 / 3.0, kSlipForce};
  const History history = PaperSine(0.8, kCycles, kPerCycle);
  const auto errors = ErrorsByCycle(history, Respond(Model("mindlin-dahl"), printed, history));
  const auto g = [](double lambda) { return 1.5 * lambda * std::sqrt(1 - lambda); };
  const double expected = 100 * std::abs(std::log(4.839e8 / kPaperLaw.tangential_stiffness)) *
                          (2 * g(2.0 / 3.0) - g(0.8)) / (1 - std::pow(0.2, 1.5));
  constexpr double kFirstOrder = 0.02;  // 1 % of 1 %, times a curvature of order 1
  constexpr double kRounding = 1e-11;
  for (const double error : errors) {
    EXPECT_NEAR(error, errors.front(), kRounding);
    EXPECT_NEAR(error, expected, kFirstOrder);
  }
}

/// Jenkins elements in parallel (Iwan 1966) whose virgin curve is the chords of f between nodes a
/// distance h apart: element j slips at node j and carries the drop in slope there.
class IwanEnsemble {
 public:
  IwanEnsemble(const BranchLaw& law, double reach, std::size_t elements)
      : force_(elements + 1), stiffness_(elements + 1), limit_(elements + 1) {
    const double h = reach / static_cast<double>(elements);
    double slope = (BackboneForce(law, h)) / h;
    for (std::size_t j = 0; j < elements; ++j) {
      const double node = static_cast<double>(j + 1) * h;
      const double next = (BackboneForce(law, node + h) - BackboneForce(law, node)) / h;
      stiffness_[j] = slope - next;
      limit_[j] = stiffness_[j] * node;
      slope = next;
      // The chord's sag is largest near its middle; twice that covers the rest.
      const double middle = node - h / 2;
      const double chord = (BackboneForce(law, node - h) + BackboneForce(law, node)) / 2;
      sag_ = std::max(sag_, 2 * (BackboneForce(law, middle) - chord));
    }
    stiffness_[elements] = slope;  // what never slips within the reach
    limit_[elements] = std::numeric_limits<double>::infinity();
  }
  double Move(double step) {
    double sum = 0.0;
    for (std::size_t j = 0; j < force_.size(); ++j) {
      force_[j] = std::clamp(force_[j] + stiffness_[j] * step, -limit_[j], limit_[j]);
      sum += force_[j];
    }
    return sum;
  }
  [[nodiscard]] double Sag() const { return sag_; }

 private:
  std::vector<double> force_, stiffness_, limit_;
  double sag_ = 0.0;
};

TEST(MasingMemory, IsThatOfManyJenkinsElements) {
  // Every surviving branch adds at most two sags, and there are no more of them than samples.
  constexpr std::size_t kElements = 4000;
  constexpr double kReach = 6.0;
  constexpr double kUseful = 1e-3;  // of Tc: a larger bound would show nothing
  Generator generator(32);
  for (const double alpha : {1.0 / 3.0, 0.5, 1.0, 2.0, 5.0}) {
    const BranchLaw law{1.0, alpha, 1.0};
    for (int i = 0; i < 8; ++i) {
      const History history = i % 2 == 0 ? testing::RandomWalk(generator, 25, 0.7)
                                         : testing::WhiteSequence(generator, 25, 2.5);
      const std::vector<double> force = Respond(Model("mindlin-dahl"), law, history);
      IwanEnsemble ensemble(law, kReach, kElements);
      const double bound = 2 * static_cast<double>(history.size()) * ensemble.Sag();
      ASSERT_LT(bound, kUseful);
      double previous = 0.0;
      for (std::size_t k = 0; k < history.size(); ++k) {
        ASSERT_NEAR(force[k], ensemble.Move(history[k] - previous), bound) << alpha << ' ' << k;
        previous = history[k];
      }
    }
  }
}

TEST(MasingMemory, AddsUpAMillionNestedReversalsAsARandomWalkOfRoundings) {
  // T = f(e₀) + Σ 2·sgn·f(|eₖ₊₁ − eₖ|/2), summed in long double.
  constexpr std::size_t kReversals = 1'000'000;
  constexpr double kBound = 2e-13;  // response.h, 1e-13, and the test's own arguments
  const BranchLaw law{1.0, 1.0 / 3.0, 1.0};
  History history(kReversals);
  for (std::size_t i = 0; i < kReversals; ++i) {
    const double size = 3.0 * static_cast<double>(kReversals - i) / kReversals;
    history[i] = i % 2 == 0 ? size : -size;
  }
  const std::vector<double> force = Respond(Model("mindlin-dahl"), law, history);
  long double sum = 0;
  double from = 0.0;
  for (std::size_t i = 0; i < kReversals; ++i) {
    const double step = history[i] - from;
    const double span = i == 0 ? 1.0 : 2.0;
    sum += static_cast<long double>(span) * BackboneForce(law, step / span);
    from = history[i];
    if (i % 1000 == 0 || i + 1 == kReversals) {
      ASSERT_NEAR(force[i], static_cast<double>(sum), kBound) << i;
    }
  }
}

TEST(DahlsLaw, IsSteeperAfterAReversalThanMasings) {
  // Eq. 12: σ(1 + T*/Tc)^α against σ.
  constexpr double kStep = 1e-7;
  constexpr double kSecant = 1e-6;  // the slope changes by α·v^{2α−1}·kStep, and 1e-16/kStep rounds
  for (const double alpha : {1.0 / 3.0, 1.0, 2.0}) {
    const BranchLaw law{1.0, alpha, 1.0};
    const History history = {0.6, 0.6 - kStep};
    const auto dahl = Respond(Model("dahl"), law, history);
    EXPECT_NEAR((dahl[0] - dahl[1]) / kStep, std::pow(1 + dahl[0], alpha), kSecant);
    const auto masing = Respond(Model("mindlin-dahl"), law, history);
    EXPECT_NEAR((masing[0] - masing[1]) / kStep, 1.0, kSecant);
  }
}

TEST(EvaluateForce, RejectsSizesThatDiffer) {
  const History history = {0.0, 1.0, 0.5};
  const LoadingPath path = PathOf(Model("mindlin"), history);
  const BranchLaw law{1.0, 1.0 / 3.0, 1.0};
  std::vector<double> two(2);
  std::vector<double> three(3);
  EXPECT_THROW(EvaluateForce(Model("mindlin"), law, path, history, two), InvalidArgument);
  const History longer = {0.0, 1.0, 0.5, 2.0};
  std::vector<double> four(4);
  EXPECT_THROW(EvaluateForce(Model("mindlin"), law, path, longer, four), InvalidArgument);
  const History shorter = {0.0, 1.0};
  EXPECT_THROW(EvaluateForce(Model("mindlin"), law, path, shorter, two), InvalidArgument);
  EXPECT_THROW(EvaluateForce(Model("mindlin"), {-1.0, 0.5, 1.0}, path, history, three),
               InvalidArgument);
}

}  // namespace
}  // namespace mindahl::models::response_test
