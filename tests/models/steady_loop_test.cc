#include "mindahl/models/steady_loop.h"

#include "../support/histories.h"
#include "support/prelude.h"

namespace mindahl::models::steady_loop_test {
namespace {

constexpr double kShapeExponents[] = {0.0, 1e-8, 0.1, 1.0 / 3.0, 0.5, 1 - 1e-8, 1.0, 1.5, 2.0, 5.0};
constexpr double kAmplitudes[] = {0.05, 0.4, 1.0, 1.5, 3.0, 20.0};  // elastic limits

class SteadyLoop : public ::testing::TestWithParam<FrictionModel> {
 protected:
  /// Calls `check(law, amplitude)` for the model's shape exponents.
  template <typename Check>
  void ForEveryLoop(Check check) const {
    for (const double alpha : kShapeExponents) {
      if (GetParam().shape_exponent && alpha != *GetParam().shape_exponent) continue;
      for (const double amplitude : kAmplitudes) check(BranchLaw{1.0, alpha, 1.0}, amplitude);
    }
  }
};

TEST_P(SteadyLoop, IsWhereManyCyclesFromTheVirginContactLead) {
  // A small Dahl loop loses e^{−4αX} of its error a cycle; loops that close slower are left out.
  constexpr int kCycles = 2000;
  constexpr double kConverged = 1e-12;
  ForEveryLoop([&](const BranchLaw& law, double amplitude) {
    if (GetParam().memory == Memory::kNone && law.shape_exponent * amplitude < 0.005) return;
    History history;
    for (int i = 0; i < kCycles; ++i) {
      for (const double x : {1.0, 0.4, -1.0, -0.3}) history.push_back(x * amplitude);
    }
    const std::vector<double> force = Respond(GetParam(), law, history);
    const double peak = SteadyPeakForce(GetParam(), law, amplitude);
    EXPECT_NEAR(force[force.size() - 4], peak, kConverged)
        << law.shape_exponent << ' ' << amplitude;
    EXPECT_NEAR(force[force.size() - 2], -peak, kConverged);

    // And a record that starts on it goes on as those cycles do.
    const History cycle(history.end() - 4, history.end());
    const std::vector<double> steady =
        Respond(GetParam(), law, cycle, {.state = InitialState::kSteady});
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_NEAR(steady[i], force[force.size() - 4 + i], kConverged) << i;
    }
  });
}

TEST_P(SteadyLoop, EnergyIsTheAreaOfTheLoop) {
  // Simpson's rule on the sampled branch; near slip f'' is not bounded and it converges as h^{3/2}.
  constexpr std::size_t kSteps = 20000;
  constexpr double kSimpson = 3e-6;  // h^{3/2}, h = 1e-4·2X
  ForEveryLoop([&](const BranchLaw& law, double amplitude) {
    History branch;
    for (std::size_t i = 0; i <= kSteps; ++i) {
      branch.push_back(amplitude * (2 * static_cast<double>(i) / static_cast<double>(kSteps) - 1));
    }
    const std::vector<double> force =
        Respond(GetParam(), law, branch, {.state = InitialState::kSteady});
    double integral = force.front() + force.back();
    for (std::size_t i = 1; i < kSteps; ++i) integral += (i % 2 == 0 ? 2 : 4) * force[i];
    // The lower branch is the upper one's image: W = 2∫ over one of them.
    const double area = 2 * integral * 2 * amplitude / (3 * kSteps);
    EXPECT_NEAR(SteadyLoopEnergy(GetParam(), law, amplitude), area,
                kSimpson * std::max(amplitude, amplitude * amplitude))
        << law.shape_exponent << ' ' << amplitude;
  });
}

TEST_P(SteadyLoop, RejectsAnAmplitudeThatIsNone) {
  EXPECT_THROW(SteadyPeakForce(GetParam(), {1.0, 0.5, 1.0}, -1.0), InvalidArgument);
  EXPECT_THROW(SteadyLoopEnergy(GetParam(), {1.0, 0.5, 1.0}, std::nan("")), InvalidArgument);
  EXPECT_THROW(SteadyLoopEnergy(GetParam(), {1.0, 0.5, 0.0}, 1.0), InvalidArgument);
}

std::string NameOf(const ::testing::TestParamInfo<FrictionModel>& info) {
  std::string name(info.param.name);
  std::ranges::replace(name, '-', '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(EveryModel, SteadyLoop,
                         ::testing::ValuesIn(FrictionModels().begin(), FrictionModels().end()),
                         NameOf);

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

TEST(SteadyLoop, SlipsGrosslyFromTheAmplitudeThatItsBranchesReachSlipAt) {
  constexpr double kRounding = 1e-14;
  for (const double alpha : {0.0, 0.1, 1.0 / 3.0, 0.5, 0.9}) {
    const BranchLaw law{4e7, alpha, 40.0};
    const double limit = GrossSlipDisplacement(law);
    EXPECT_NEAR(SteadyGrossSlipAmplitude(Model("mindlin-dahl"), law) / limit, 1, kRounding);
    EXPECT_NEAR(SteadyGrossSlipAmplitude(Model("dahl"), law) / limit, std::exp2(-alpha), kRounding);
    if (alpha == 0.0) continue;  // a corner: just below it the force is as much less
    // By the loops themselves: below it they stay below Tc, from it on they do not.
    for (const char* name : {"mindlin-dahl", "dahl"}) {
      const double amplitude = SteadyGrossSlipAmplitude(Model(name), law);
      EXPECT_LT(SteadyPeakForce(Model(name), law, 0.9 * amplitude), law.slip_force) << name;
      EXPECT_EQ(SteadyPeakForce(Model(name), law, 1.001 * amplitude), law.slip_force) << name;
    }
  }
  EXPECT_TRUE(std::isinf(SteadyGrossSlipAmplitude(Model("dahl"), {4e7, 1.0, 40.0})));
}

}  // namespace

}  // namespace mindahl::models::steady_loop_test
