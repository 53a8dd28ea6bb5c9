#include "../support/histories.h"
#include "mindahl/models/contact_state.h"
#include "mindahl/models/variable_load.h"
#include "support/prelude.h"

namespace mindahl::models::loaded_contact_state_test {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kShapeExponents[] = {0.0, 1e-8, 1.0 / 3.0, 0.5, 0.99};

/// The elastic limit at the reference load is 1, as testing::RandomHistory expects.
constexpr LoadDependentLaw UnitLaw(double shape_exponent) {
  return {.friction_coefficient = 0.5,
          .reference_load = 2.0,
          .reference_stiffness = 1.0,
          .shape_exponent = shape_exponent};
}

/// Loads [N] from step to step, constant for a while, or now and then lifted off.
History RandomLoads(Generator& generator, std::size_t steps) {
  History loads;
  double load = 2.0;
  const std::size_t kind = generator() % 3;
  for (std::size_t i = 0; i < steps; ++i) {
    if (kind == 0 || generator() % 5 == 0) load = LogUniform(generator, 0.5, 6.0);
    loads.push_back(kind == 2 && generator() % 10 == 0 ? 0.0 : load);
  }
  return loads;
}

History Respond(const LoadDependentLaw& law, const History& displacement, const History& load) {
  History force(displacement.size());
  EvaluateForceUnderLoad(law, displacement, load, force);
  return force;
}

TEST(LoadedContactState, MovesAlongThePathThatIsEvaluatedAtOnce) {
  // Bit for bit, and a trial step before every step foretells it.
  Generator generator(1);
  for (const double alpha : kShapeExponents) {
    for (int i = 0; i < 1000; ++i) {
      const History displacement = RandomHistory(generator);
      const History load = RandomLoads(generator, displacement.size());
      const History expected = Respond(UnitLaw(alpha), displacement, load);
      LoadedContactState contact(UnitLaw(alpha), {.normal_load = load.front()});
      for (std::size_t k = 0; k < displacement.size(); ++k) {
        static_cast<void>(contact.Peek(Uniform(generator, -5, 5), Uniform(generator, 0, 6)));
        ASSERT_EQ(contact.Peek(displacement[k], load[k]), expected[k]) << alpha << ' ' << i;
        ASSERT_EQ(contact.Move(displacement[k], load[k]), expected[k]) << alpha << ' ' << i;
        ASSERT_EQ(contact.Force(), expected[k]);
        ASSERT_EQ(contact.Displacement(), displacement[k]);
        ASSERT_EQ(contact.NormalLoad(), load[k]);
      }
    }
  }
}

TEST(LoadedContactState, ACopyGoesItsOwnWayAndResetForgets) {
  const LoadDependentLaw law = UnitLaw(1.0 / 3.0);
  LoadedContactState contact(law, {.normal_load = 2.0, .unloaded_displacement = 0.25});
  const double first = contact.Move(0.75, 3.0);
  LoadedContactState trial = contact;
  const double trial_force = trial.Move(-1.0, 1.0);
  EXPECT_EQ(contact.Force(), first);
  EXPECT_EQ(contact.Peek(-1.0, 1.0), trial_force);
  trial = contact;
  EXPECT_EQ(trial.Move(-1.0, 1.0), trial_force);
  contact.Reset();
  EXPECT_EQ(contact.Force(), 0.0);
  EXPECT_EQ(contact.Displacement(), 0.25);
  EXPECT_EQ(contact.NormalLoad(), 2.0);
  EXPECT_EQ(contact.Move(0.75, 3.0), first);
}

TEST(LoadedContactState, RemembersAsManyZonesAsTheLoopIsDeepNotAsItIsLong) {
  constexpr std::size_t kSteps = 1'000'000;
  constexpr std::size_t kPerCycle = 200;
  LoadedContactState contact(UnitLaw(1.0 / 3.0), {.normal_load = 2.0});
  std::vector<double> second_cycle(kPerCycle);
  std::size_t most = 0;
  for (std::size_t i = 0; i < kSteps; ++i) {
    const double phase = 2 * 3.141592653589793 * static_cast<double>(i % kPerCycle) / kPerCycle;
    const double force = contact.Move(1.2 * std::sin(phase), 2.0);
    most = std::max(most, contact.RememberedZones());
    if (i / kPerCycle == 1) second_cycle[i % kPerCycle] = force;
    if (i / kPerCycle > 1) {
      ASSERT_EQ(force, second_cycle[i % kPerCycle]) << i;
    }
  }
  EXPECT_LE(most, 3U);
}

TEST(LoadedContactState, AddsOneZoneForALoadThatRisesAtRest) {
  LoadedContactState contact(UnitLaw(1.0 / 3.0));
  contact.Move(0.5, 1.0);
  const std::size_t zones = contact.RememberedZones();
  for (int i = 1; i < 1000; ++i) contact.Move(0.5, 1.0 + 0.01 * i);
  EXPECT_LE(contact.RememberedZones(), zones + 1);
}

TEST(LoadedContactState, RefusesAStepByItsValueAndStaysWhereItWas) {
  LoadDependentLaw soft = UnitLaw(1.0 / 3.0);
  soft.reference_stiffness = 1e-306;
  LoadedContactState contact(soft, {.normal_load = 1.0});
  contact.Move(0.5, 1.0);
  const double force = contact.Force();
  const auto refusal = [&](double displacement, double load) {
    const std::string by_move = MessageOf([&] { contact.Move(displacement, load); });
    EXPECT_EQ(MessageOf([&] { static_cast<void>(contact.Peek(displacement, load)); }), by_move);
    EXPECT_EQ(contact.Force(), force);
    EXPECT_EQ(contact.Displacement(), 0.5);
    EXPECT_EQ(contact.NormalLoad(), 1.0);
    return by_move;
  };
  EXPECT_EQ(refusal(kNan, 1.0),
            "displacement [m] = nan is invalid: must be finite and within +-1e307 m");
  EXPECT_THAT(refusal(-1.1e307, 1.0), HasSubstr("displacement [m] = -1.1e+307 is invalid"));
  EXPECT_EQ(refusal(1.0, -2.0), "normal load [N] = -2 is invalid: must be finite and >= 0");
  EXPECT_THAT(refusal(1.0, kNan), HasSubstr("normal load [N] = nan"));
  EXPECT_THAT(refusal(1.0, kInfinity), HasSubstr("normal load [N] = inf"));
  EXPECT_THAT(refusal(1.0, 1e6), HasSubstr("normal load [N] = 1000000 is invalid: must keep the"));
}

TEST(LoadedContactState, RefusesInvalidContact) {
  LoadDependentLaw law = UnitLaw(0.5);
  EXPECT_THROW(LoadedContactState(law, {.normal_load = -1.0}), InvalidArgument);
  EXPECT_THROW(LoadedContactState(law, {.unloaded_displacement = kNan}), InvalidArgument);
  law.shape_exponent = 1.0;
  EXPECT_THROW(LoadedContactState{law}, InvalidArgument);
}

}  // namespace
}  // namespace mindahl::models::loaded_contact_state_test
