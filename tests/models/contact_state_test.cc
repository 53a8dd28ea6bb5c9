#include "mindahl/models/contact_state.h"

#include <cfenv>
#include <cstdlib>
#include <new>

#include "../support/histories.h"
#include "mindahl/models/branch_law.h"
#include "mindahl/models/response.h"
#include "mindahl/models/variable_load.h"
#include "support/prelude.h"

namespace {
std::size_t allocations = 0;
}  // namespace

// All of this program's allocations are counted: that Move makes none is part of its contract. Out
// of line, for the compiler not to see malloc and free where it looks for new and delete.
[[gnu::noinline]] void* operator new(std::size_t size) {
  ++allocations;
  if (void* memory = std::malloc(size == 0 ? 1 : size)) return memory;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t /*size*/) noexcept {
  std::free(memory);
}

namespace mindahl::models::contact_state_test {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Of Tc, between a state and its path: none. Where multiplications are fused with additions the
/// two may be compiled differently, each within the bound of response.h.
#ifdef __FP_FAST_FMA
constexpr double kAgreement = 1e-13;
#else
constexpr double kAgreement = 0.0;
#endif

struct Case {
  const FrictionModel* model = nullptr;
  double shape_exponent = 0.0;
};

/// Every model that can be moved step by step, with every exponent that it allows.
std::vector<Case> Cases() {
  std::vector<Case> cases;
  for (const FrictionModel& model : FrictionModels()) {
    for (const double alpha : {0.0, 1e-8, 1.0 / 3.0, 0.5, 1.0, 2.0, 100.0}) {
      if (model.shape_exponent.value_or(alpha) == alpha) cases.push_back({&model, alpha});
    }
  }
  return cases;
}

/// Inward, then outward again, step by step, past every extreme exactly.
History Spiral(std::size_t reversals) {
  History history(reversals);
  for (std::size_t i = 0; i < reversals; ++i) {
    const double size = 3 * static_cast<double>(reversals - i) / static_cast<double>(reversals);
    history[i] = i % 2 == 0 ? size : -size;
  }
  const History outward(history.rbegin(), history.rend());
  history.insert(history.end(), outward.begin() + 1, outward.end());
  history.push_back(2 * history.front());
  return history;
}

History DrawHistory(Generator& generator) {
  switch (generator() % 4) {
    case 0:
      return Quantised(RandomHistory(generator), 0.5);  // extremes are met again exactly
    case 1:
      return Quantised(RandomHistory(generator), 0.125);
    case 2:
      return Spiral(2 + generator() % 30);
    default:
      return RandomHistory(generator);
  }
}

/// Moves along the history and demands the forces of its path, from Move and from Peek alike.
void ExpectAgreement(const FrictionModel& model, const BranchLaw& law, const History& history,
                     const ContactStateOptions& options) {
  const std::vector<double> expected = testing::Respond(
      model, law, history, {.unloaded_displacement = options.unloaded_displacement}, options.rig);
  ContactState contact(model, law, options);
  Generator generator(3);
  for (std::size_t i = 0; i < history.size(); ++i) {
    static_cast<void>(contact.Peek(Uniform(generator, -5, 5)));
    const double foretold = contact.Peek(history[i]);
    const double force = contact.Move(history[i]);
    ASSERT_LE(std::abs(force - expected[i]), kAgreement * law.slip_force) << "step " << i;
    ASSERT_EQ(force, foretold) << "step " << i;
    ASSERT_EQ(contact.Force(), force);
    ASSERT_EQ(contact.Displacement(), history[i]);
  }
}

TEST(ContactState, MovesAlongThePathThatIsEvaluatedAtOnce) {
  Generator generator(1);
  for (const Case& c : Cases()) {
    SCOPED_TRACE(std::string(c.model->name) + ", alpha " + std::to_string(c.shape_exponent));
    for (int i = 0; i < 1000; ++i) {
      const double unloaded_displacement =
          i % 3 == 0 ? std::round(Uniform(generator, -4, 4)) / 2 : 0.0;
      ExpectAgreement(*c.model, {1.0, c.shape_exponent, 1.0}, DrawHistory(generator),
                      {.unloaded_displacement = unloaded_displacement});
      if (HasFatalFailure()) FAIL() << "history " << i;
    }
  }
}

TEST(ContactState, DoesSoAtEveryExtremeAndRaisesNoFlag) {
  // docs/theory.md §8 by way of the histories of tests/properties.
  constexpr int kTrapped = FE_INVALID | FE_OVERFLOW | FE_DIVBYZERO;
  for (const FrictionModel& model : FrictionModels()) {
    for (const double alpha : {0.0, 1e-300, 1e-16, 1e-8, 1.0 / 3.0, 0.5, 1 - 1e-8, 1 - 1e-15, 1.0,
                               1 + 1e-15, 1 + 1e-8, 2.0, 10.0, 100.0}) {
      for (const auto& [stiffness, slip_force] :
           {std::pair{1e-9, 1e12}, {1e15, 1e-15}, {1e-9, 1e-15}, {1e15, 1e12}, {1.0, 1.0}}) {
        const BranchLaw law{stiffness, alpha, slip_force};
        const double limit = slip_force / stiffness;
        for (const double lambda :
             {1e-300, 1e-18, 1e-9, 0.5, 1.0, 1 / (1 - 1.0 / 3.0), 2.0, 1e12}) {
          const double x = lambda * limit;
          const History history = {
              0.0,   0.0,    x, x,       std::nextafter(x, 0.0), -x, 0.0, std::nextafter(x, 2 * x),
              x / 2, -2 * x, x, 0.25 * x};
          const std::vector<double> expected = testing::Respond(model, law, history);
          std::feclearexcept(kTrapped);
          ContactState contact(model, law);
          std::vector<double> force;
          bool stiffness_is_number = true;
          for (const double displacement : history) {
            force.push_back(contact.Move(displacement));
            stiffness_is_number &= contact.TangentStiffness() >= 0;
          }
          ASSERT_EQ(std::fetestexcept(kTrapped), 0) << model.name << ' ' << alpha << ' ' << lambda;
          ASSERT_TRUE(stiffness_is_number) << model.name << ' ' << alpha << ' ' << lambda;
          for (std::size_t i = 0; i < force.size(); ++i) {
            ASSERT_LE(std::abs(force[i] - expected[i]), kAgreement * slip_force)
                << model.name << ' ' << alpha << ' ' << lambda << ' ' << i;
            ASSERT_LE(std::abs(force[i]), slip_force);
          }
        }
      }
    }
  }
}

// --- Stiffness -----------------------------------------------------------------------------------

TEST(ContactState, HasTheStiffnessOfItsForce) {
  // Central differences within a branch, of every model and behind a spring.
  constexpr double kStep = 1e-5;  // of the elastic limit; errs by kStep²·f'''/6
  constexpr double kDifference = 1e-6;
  Generator generator(5);
  for (const Case& c : Cases()) {
    if (c.shape_exponent > 2) continue;  // f''' ∝ α²
    EXPECT_DOUBLE_EQ(ContactState(*c.model, {3.0, c.shape_exponent, 5.0}).TangentStiffness(), 3.0);
    for (const double rig : {kInfinity, 0.7}) {
      int compared = 0;
      for (int i = 0; i < 300; ++i) {
        ContactState contact(*c.model, {1.0, c.shape_exponent, 1.0}, {.rig = {rig}});
        for (const double displacement : DrawHistory(generator)) {
          const double before = contact.Displacement();
          contact.Move(displacement);
          const double s = displacement > before ? 1.0 : -1.0;
          const bool near_slip = std::abs(contact.Force()) > 0.8;
          if (near_slip || std::abs(displacement - before) < 2 * kStep) continue;
          ContactState ahead = contact;
          const double beyond = ahead.Move(displacement + s * kStep);
          if (ahead.RememberedExtremes() != contact.RememberedExtremes()) continue;
          ContactState further = ahead;
          const double farthest = further.Move(displacement + 2 * s * kStep);
          if (further.RememberedExtremes() != contact.RememberedExtremes()) continue;
          ASSERT_NEAR(ahead.TangentStiffness(), s * (farthest - contact.Force()) / (2 * kStep),
                      kDifference)
              << c.model->name << ' ' << c.shape_exponent << ' ' << rig << ' ' << beyond;
          ++compared;
        }
      }
      EXPECT_GT(compared, 1000) << c.model->name;
    }
  }
}

// --- A state as a value --------------------------------------------------------------------------

TEST(ContactState, ACopyGoesItsOwnWay) {
  Generator generator(6);
  const BranchLaw law{1.0, 1.0 / 3.0, 1.0};
  for (int i = 0; i < 300; ++i) {
    const History history = DrawHistory(generator);
    ContactState contact(Model("mindlin"), law);
    ContactState trial = contact;
    for (const double displacement : history) {
      trial = contact;
      const double elsewhere = Uniform(generator, -5, 5);
      const double trial_force = trial.Move(elsewhere);
      ASSERT_EQ(contact.Peek(elsewhere), trial_force);
      contact.Move(displacement);
      ASSERT_EQ(trial.Force(), trial_force);
    }
    ASSERT_EQ(contact.Force(), testing::Respond(Model("mindlin"), law, history).back());
  }
}

TEST(ContactState, GoesOnFromTheMemoryOfAnother) {
  Generator generator(7);
  const BranchLaw law{1.0, 1.0 / 3.0, 1.0};
  for (const char* model : {"mindlin-dahl", "dahl", "jenkins"}) {
    for (const double rig : {3.0, kInfinity}) {
      const ContactStateOptions options{.unloaded_displacement = 0.1, .rig = {.stiffness = rig}};
      ContactState contact(Model(model), law, options);
      for (const double displacement : DrawHistory(generator)) contact.Move(displacement);
      ContactState other(Model(model), law, options);
      other.Remember(contact.Memory());
      ASSERT_EQ(other.Force(), contact.Force());
      ASSERT_EQ(other.RememberedExtremes(), contact.RememberedExtremes());
      for (const double displacement : DrawHistory(generator)) {
        ASSERT_EQ(other.Move(displacement), contact.Move(displacement)) << model << ", rig " << rig;
      }
    }
  }
  ContactState contact(Model("dahl"), law);
  EXPECT_THROW(contact.Remember(std::vector<double>(13)), InvalidArgument);
}

TEST(ContactState, RemembersAsManyExtremesAsTheLoopIsDeepNotAsItIsLong) {
  // Ten million steps on a loop with an inner loop: nothing is allocated after the first cycle, and
  // no force drifts after the second by a bit.
  constexpr std::size_t kSteps = 10'000'000;
  History cycle;
  for (int i = 0; i < 20; ++i) cycle.push_back(-1.2 + 0.1 * i);  // to 0.7, back to 0.2, on to 1.2
  for (int i = 1; i <= 5; ++i) cycle.push_back(0.7 - 0.1 * i);
  for (int i = 1; i <= 10; ++i) cycle.push_back(0.2 + 0.1 * i);
  for (int i = 1; i <= 23; ++i) cycle.push_back(1.2 - 0.1 * i);
  ContactState contact(Model("mindlin"), {1.0, 1.0 / 3.0, 1.0});
  std::vector<double> second(cycle.size());
  std::size_t most = 0;
  std::size_t allocated = 0;
  std::size_t drifted = 0;
  for (std::size_t i = 0; i < kSteps; ++i) {
    const std::size_t phase = i % cycle.size();
    const double force = contact.Move(cycle[phase]);
    most = std::max(most, contact.RememberedExtremes());
    if (i / cycle.size() == 1) second[phase] = force;
    if (i == cycle.size()) allocated = allocations;
    if (i / cycle.size() > 1 && force != second[phase]) ++drifted;
  }
  EXPECT_EQ(drifted, 0U);
  EXPECT_EQ(allocations, allocated);
  EXPECT_LE(most, 4U);
}

TEST(ContactState, AllocatesNothingWithinItsReserve) {
  ContactState contact(Model("mindlin"), {1.0, 1.0 / 3.0, 1.0});
  ContactState trial = contact;
  ContactState dahl(Model("dahl"), {1.0, 1.0 / 3.0, 1.0});
  contact.Reserve(50);
  trial.Reserve(50);
  const History history = Spiral(50);
  const std::size_t before = allocations;
  for (const double displacement : history) {
    static_cast<void>(contact.Peek(-displacement));
    trial = contact;
    trial.Move(0.1 * displacement);
    contact.Move(displacement);
    dahl.Move(displacement);
  }
  contact.Reset();
  EXPECT_EQ(allocations, before);
}

// --- Refusals ------------------------------------------------------------------------------------

TEST(ContactState, RefusesADisplacementByItsValueAndStaysWhereItWas) {
  for (const Case& c : Cases()) {
    for (const History& before : {History{}, History{0.5}, History{0.5, -0.25, 0.125}}) {
      ContactState contact(*c.model, {1.0, c.shape_exponent, 1.0});
      for (const double displacement : before) contact.Move(displacement);
      const ContactState copy = contact;
      for (const auto& [displacement, value] : {std::pair{kNan, "nan"},
                                                {kInfinity, "inf"},
                                                {-kInfinity, "-inf"},
                                                {1.01e307, "1.01e+307"},
                                                {-1.01e307, "-1.01e+307"}}) {
        const std::string expected = std::string("displacement [m] = ") + value +
                                     " is invalid: must be finite and within +-1e307 m";
        const double at = displacement;
        EXPECT_EQ(MessageOf([&] { contact.Move(at); }), expected);
        EXPECT_EQ(MessageOf([&] { static_cast<void>(contact.Peek(at)); }), expected);
      }
      EXPECT_EQ(contact.Force(), copy.Force());
      EXPECT_EQ(contact.Displacement(), copy.Displacement());
      EXPECT_EQ(contact.RememberedExtremes(), copy.RememberedExtremes());
      EXPECT_EQ(contact.Move(0.25), ContactState(copy).Move(0.25));
    }
  }
}

TEST(ContactState, RefusesALawASpringOrAnOriginThatIsNone) {
  const auto refusal = [](const BranchLaw& law, const ContactStateOptions& options) {
    return MessageOf([&] { ContactState(Model("dahl"), law, options); });
  };
  const BranchLaw law{1.0, 0.5, 1.0};
  EXPECT_THAT(refusal({-1.0, 0.5, 1.0}, {}), HasSubstr("tangential stiffness [N/m] = -1"));
  EXPECT_THAT(refusal(law, {.unloaded_displacement = kNan}),
              HasSubstr("unloaded displacement [m] = nan"));
  EXPECT_THAT(refusal(law, {.rig = {.stiffness = 0.0}}), HasSubstr("series stiffness [N/m] = 0"));
  EXPECT_THAT(refusal(law, {.rig = {.stiffness = 1e-300}}),
              HasSubstr("series stiffness [N/m] = 1e-300"));
}

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
  // Bit for bit.
  Generator generator(1);
  for (const double alpha : kShapeExponents) {
    for (int i = 0; i < 1000; ++i) {
      const History displacement = RandomHistory(generator);
      const History load = RandomLoads(generator, displacement.size());
      const History expected = Respond(UnitLaw(alpha), displacement, load);
      LoadedContactState contact(UnitLaw(alpha), {.normal_load = load.front()});
      for (std::size_t k = 0; k < displacement.size(); ++k) {
        ASSERT_EQ(contact.Move(displacement[k], load[k]), expected[k]) << alpha << ' ' << i;
        ASSERT_EQ(contact.Force(), expected[k]);
        ASSERT_EQ(contact.Displacement(), displacement[k]);
        ASSERT_EQ(contact.NormalLoad(), load[k]);
      }
    }
  }
}

TEST(LoadedContactState, ACopyGoesItsOwnWay) {
  const LoadDependentLaw law = UnitLaw(1.0 / 3.0);
  LoadedContactState contact(law, {.normal_load = 2.0, .unloaded_displacement = 0.25});
  const double first = contact.Move(0.75, 3.0);
  LoadedContactState trial = contact;
  const double trial_force = trial.Move(-1.0, 1.0);
  EXPECT_EQ(contact.Force(), first);
  trial = contact;
  EXPECT_EQ(trial.Move(-1.0, 1.0), trial_force);
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
}  // namespace mindahl::models::contact_state_test
