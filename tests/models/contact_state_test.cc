#include "mindahl/models/contact_state.h"

#include <cstdlib>
#include <new>

#include "../../tools/accuracy/measurements.h"
#include "../support/histories.h"
#include "mindahl/models/branch_law.h"
#include "mindahl/models/response.h"
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

TEST(ContactState, DoesSoOverTheWholeBox) {
  for (const FrictionModel& model : FrictionModels()) {
    accuracy::ForEveryPoint([&](const BranchLaw& law, double x) {
      ExpectAgreement(model, law,
                      {0.0, 0.0, x, x, std::nextafter(x, 0.0), -x, 0.0, std::nextafter(x, 2 * x),
                       x / 2, -2 * x, x, 0.25 * x},
                      {});
    });
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
                                                {1.01e100, "1.01e+100"},
                                                {-1.01e100, "-1.01e+100"}}) {
        const std::string expected = std::string("displacement [m] = ") + value +
                                     " is invalid: must be finite and within +-1e100 m";
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

}  // namespace
}  // namespace mindahl::models::contact_state_test
