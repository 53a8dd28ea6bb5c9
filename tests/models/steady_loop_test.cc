#include "mindahl/models/steady_loop.h"

#include <fmt/format.h>

#include <boost/multiprecision/cpp_bin_float.hpp>

#include "../support/histories.h"
#include "../support/worst.h"
#include "support/prelude.h"

namespace mindahl::models::steady_loop_test {
namespace {

constexpr double kShapeExponents[] = {0.0, 1e-8, 0.1, 1.0 / 3.0, 0.5, 1 - 1e-8, 1.0, 1.5, 2.0, 5.0};
constexpr double kAmplitudes[] = {0.05, 0.4, 1.0, 1.5, 3.0, 20.0};  // elastic limits

/// Calls `check(model, law, amplitude)` for every model's shape exponents.
template <typename Check>
void ForEveryLoopOfAModel(Check check) {
  for (const FrictionModel& model : FrictionModels()) {
    for (const double alpha : kShapeExponents) {
      if (alpha != model.shape_exponent.value_or(alpha)) continue;
      for (const double amplitude : kAmplitudes) {
        SCOPED_TRACE(fmt::format("{}, alpha {}, amplitude {}", model.name, alpha, amplitude));
        check(model, BranchLaw{1.0, alpha, 1.0}, amplitude);
      }
    }
  }
}

TEST(SteadyLoop, IsWhereManyCyclesFromTheVirginContactLead) {
  // A small Dahl loop loses e^{−4αX} of its error a cycle; loops that close slower are left out.
  constexpr int kCycles = 2000;
  constexpr double kConverged = 1e-12;
  ForEveryLoopOfAModel([&](const FrictionModel& model, const BranchLaw& law, double amplitude) {
    if (model.memory == Memory::kNone && law.shape_exponent * amplitude < 0.005) return;
    History history;
    for (int i = 0; i < kCycles; ++i) {
      for (const double x : {1.0, 0.4, -1.0, -0.3}) history.push_back(x * amplitude);
    }
    const std::vector<double> force = Respond(model, law, history);
    const double peak = SteadyPeakForce(model, law, amplitude);
    EXPECT_NEAR(force[force.size() - 4], peak, kConverged);
    EXPECT_NEAR(force[force.size() - 2], -peak, kConverged);

    // And a record that starts on it goes on as those cycles do.
    const History cycle(history.end() - 4, history.end());
    const std::vector<double> steady = Respond(model, law, cycle, {.state = InitialState::kSteady});
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_NEAR(steady[i], force[force.size() - 4 + i], kConverged) << i;
    }
  });
}

TEST(SteadyLoop, EnergyIsTheAreaOfTheLoop) {
  // Simpson's rule on the sampled branch; near slip f'' is not bounded and it converges as h^{3/2}.
  constexpr std::size_t kSteps = 20000;
  constexpr double kSimpson = 3e-6;  // h^{3/2}, h = 1e-4·2X
  ForEveryLoopOfAModel([&](const FrictionModel& model, const BranchLaw& law, double amplitude) {
    History branch;
    for (std::size_t i = 0; i <= kSteps; ++i) {
      branch.push_back(amplitude * (2 * static_cast<double>(i) / static_cast<double>(kSteps) - 1));
    }
    const std::vector<double> force = Respond(model, law, branch, {.state = InitialState::kSteady});
    double integral = force.front() + force.back();
    for (std::size_t i = 1; i < kSteps; ++i) integral += (i % 2 == 0 ? 2 : 4) * force[i];
    // The lower branch is the upper one's image: W = 2∫ over one of them.
    const double area = 2 * integral * 2 * amplitude / (3 * kSteps);
    EXPECT_NEAR(SteadyLoopEnergy(model, law, amplitude), area,
                kSimpson * std::max(amplitude, amplitude * amplitude));
  });
}

TEST(SteadyLoop, RejectsAnAmplitudeThatIsNone) {
  for (const FrictionModel& model : FrictionModels()) {
    EXPECT_THROW(SteadyPeakForce(model, {1.0, 0.5, 1.0}, -1.0), InvalidArgument);
    EXPECT_THROW(SteadyLoopEnergy(model, {1.0, 0.5, 1.0}, std::nan("")), InvalidArgument);
    EXPECT_THROW(SteadyLoopEnergy(model, {1.0, 0.5, 0.0}, 1.0), InvalidArgument);
  }
}

TEST(SteadyLoop, OfContactAndRigDividesItsAmplitude) {
  const FrictionModel& model = *FindFrictionModel("mindlin-dahl");
  const BranchLaw law{4e7, 1.0 / 3, 40.0};
  EXPECT_EQ(ContactAmplitude(model, law, {}, 1.2e-6), 1.2e-6);
  constexpr double kRig = 3e7;         // [N/m]
  constexpr double kBisected = 1e-14;  // the search ends at 1e-15 of the whole
  for (const double contact : {0.4e-6, 1.5e-6, 2.5e-6}) {
    const double whole = contact + SteadyPeakForce(model, law, contact) / kRig;
    EXPECT_NEAR(ContactAmplitude(model, law, {kRig}, whole) / contact, 1, kBisected);
  }
  EXPECT_THROW(ContactAmplitude(model, law, {}, -1.0), InvalidArgument);
}

/// 60 digits: α = 100 at y = 1e12 leaves 50 of them.
using Exact = boost::multiprecision::number<boost::multiprecision::cpp_bin_float<60>>;

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
constexpr double kExponents[] = {0.0, 1e-16,    1e-8, 0.1, 1.0 / 3, 0.5,  1 - 1e-8,
                                 1.0, 1 + 1e-8, 1.5,  2.0, 10.0,    100.0};
/// In elastic limits Tc/σ; with 1 and 1.5 the onset of slip of α = 0 and α = 1/3, and an ulp
/// beside.
const std::vector<double> kLoopAmplitudes = {
    1e-18, 1e-9, 1e-3, 0.3, 1.0, std::nextafter(1.5, 0.0), 1.5, std::nextafter(1.5, 2.0),
    3.0,   50.0, 1e12};

std::string Say(const BranchLaw& law, double amplitude) {
  return "alpha " + std::to_string(law.shape_exponent) + " amplitude " + std::to_string(amplitude);
}

template <typename Check>
void ForEveryLoop(Check check) {
  for (const double alpha : kExponents) {
    for (const double amplitude : kLoopAmplitudes) check(BranchLaw{1.0, alpha, 1.0}, amplitude);
  }
}

/// u = 1 − f/Tc of σ = Tc = 1.
Exact Remaining(double shape_exponent, double y) {
  const Exact beta = 1 - Exact(shape_exponent);
  if (beta == 0) return exp(-Exact(y));
  const Exact z = 1 - beta * Exact(y);
  return z > 0 ? Exact(exp(log(z) / beta)) : Exact(0);
}

double Relative(double value, const Exact& exact) {
  return static_cast<double>(abs(Exact(value) / exact - 1));
}

TEST(EquivalentLaw, OfMasingHasTheParametersOfEquation20) {
  Worst stiffness;
  Worst slip_force;
  ForEveryLoop([&](const BranchLaw& law, double amplitude) {
    const BranchLaw dahl = DahlEquivalent(law, amplitude);
    const Exact peak = 1 - Remaining(law.shape_exponent, amplitude);
    const auto say = [&] { return Say(law, amplitude); };
    stiffness.Add(
        Relative(dahl.tangential_stiffness, exp(Exact(law.shape_exponent) * log(1 - peak / 2))) /
            (2 + law.shape_exponent),
        say);
    slip_force.Add(Relative(dahl.slip_force, 2 - peak), say);
    EXPECT_EQ(dahl.shape_exponent, law.shape_exponent);
  });
  // u has one ε, (1 + u)/2 at most half of it, its power α times that; then one rounding each.
  EXPECT_LT(stiffness.value, 1.0 * kEpsilon) << stiffness.where;
  EXPECT_LT(slip_force.value, 2.0 * kEpsilon) << slip_force.where;
}

TEST(EquivalentLaw, RunsThroughTheSameSteadyLoop) {
  // On either side a branch is off by its own 6 ε of Tc and by the 16 ε of T* in Dahl's case, which
  // 2Tc' = 4Tc at the most doubles. An error of (2 + α) ε in σ' moves a force by y·u^α < 1/α of it.
  constexpr double kTwoBranches = 64 * kEpsilon;
  Worst worst;
  ForEveryLoop([&](const BranchLaw& law, double amplitude) {
    History loop;
    for (const double share : {1.0, 0.999, 0.7, 0.2, -0.4, -0.9, -1.0, -0.8, 0.0, 0.5, 1.0}) {
      loop.push_back(share * amplitude);
    }
    const BranchLaw dahl = DahlEquivalent(law, amplitude);
    const auto masing_force =
        Respond(Model("mindlin-dahl"), law, loop, {.state = InitialState::kSteady});
    const auto dahl_force = Respond(Model("dahl"), dahl, loop, {.state = InitialState::kSteady});
    const auto back_force = Respond(Model("mindlin-dahl"), MasingEquivalent(dahl, amplitude), loop,
                                    {.state = InitialState::kSteady});
    for (std::size_t i = 0; i < loop.size(); ++i) {
      // Forces of a small loop are σδ: the error is one of them.
      const double unit = std::min(1.0, amplitude);
      worst.Add(std::abs(dahl_force[i] - masing_force[i]) / unit,
                [&] { return Say(law, amplitude) + " sample " + std::to_string(i); });
      worst.Add(std::abs(back_force[i] - masing_force[i]) / unit,
                [&] { return "back: " + Say(law, amplitude) + " sample " + std::to_string(i); });
    }
  });
  EXPECT_LT(worst.value, kTwoBranches) << worst.where;
}

TEST(EquivalentLaw, RefusesInvalidAmplitudeOrLaw) {
  const BranchLaw law{1.0, 0.5, 1.0};
  for (const auto convert : {DahlEquivalent, MasingEquivalent}) {
    EXPECT_THROW(convert({-1.0, 0.5, 1.0}, 1.0), InvalidArgument);
    EXPECT_THROW(convert(law, -1.0), InvalidArgument);
    EXPECT_THROW(convert(law, std::nan("")), InvalidArgument);
  }
  // 2Tc is no force.
  EXPECT_THROW(DahlEquivalent({1e308, 0.5, 1.7e308}, 0.0), InvalidArgument);
}

}  // namespace
}  // namespace mindahl::models::steady_loop_test
