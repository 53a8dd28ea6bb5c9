#include "mindahl/methods/method.h"

#include <boost/multiprecision/cpp_bin_float.hpp>

#include "../support/histories.h"
#include "responses.h"
#include "support/prelude.h"

namespace mindahl::methods::method_test {
namespace {

using namespace models;

using Digits100 = boost::multiprecision::cpp_bin_float_100;

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
constexpr double kShapeExponents[] = {0.0, 1e-8, 1.0 / 3, 0.5, 1.0, 2.0};

bool Serves(const Method& method, const FrictionModel& model) {
  return !method.masing_only || model.memory == Memory::kReturnPoint;
}

// --- No method leaves its range -------------------------------------------------------------

struct Service {
  const Method* method;
  const FrictionModel* model;
};

std::vector<Service> Services() {
  std::vector<Service> services;
  for (const Method& method : Methods()) {
    for (const FrictionModel& model : FrictionModels()) {
      if (Serves(method, model)) services.push_back({&method, &model});
    }
  }
  return services;
}

class EveryService : public ::testing::TestWithParam<Service> {
 protected:
  /// Largest |T| over Tc beyond what is allowed, <= 0; NaN where a force is.
  [[nodiscard]] static double Excess(const BranchLaw& law, const History& history,
                                     std::size_t steps) {
    const auto& [method, model] = GetParam();
    // Slip forces of elements are rounded, and their sum.
    const double rounding = method->masing_only ? static_cast<double>(2 * steps) * kEpsilon : 0.0;
    const double limit = model->bounded ? 1 + rounding : 2.0;
    double excess = -limit;
    for (const double force :
         RespondBy(method->name, model->name, law, {.displacement = history}, {.steps = steps})) {
      const double beyond = std::abs(force) / law.slip_force - limit;
      if (!(beyond <= excess)) excess = beyond;
      if (std::isnan(excess)) break;
    }
    return excess;
  }

  [[nodiscard]] static BranchLaw LawWith(double shape_exponent) {
    return {1.0, GetParam().model->shape_exponent.value_or(shape_exponent), 1.0};
  }
};

TEST_P(EveryService, IsGuardedOverRandomHistoriesOfAnySize) {
  constexpr int kHistories = 60;
  Generator generator(20171);
  for (const double shape_exponent : kShapeExponents) {
    const BranchLaw law = LawWith(shape_exponent);
    for (int i = 0; i < kHistories; ++i) {
      History history = RandomHistory(generator);
      const double size = LogUniform(generator, 1e-6, 1e6) * ReferenceDisplacement(law);
      const double reach = Largest(history);
      for (double& at : history) at *= reach > 0 ? size / reach : 0.0;
      EXPECT_LE(Excess(law, history, 1 + generator() % 3), 0.0)
          << "alpha = " << shape_exponent << ", history " << i << " of size " << size;
    }
  }
}

TEST_P(EveryService, IsGuardedOverStepsOfNoLengthAndGiantOnes) {
  const History histories[] = {
      {0, 0, 0},           {1e-300, 1e-300, 0, -1e-300},   {0, 1e-9, 1e-9, 1e-9},
      {1e12, -1e12, 0, 0}, {0, 0.5, 1e9, 0.5, -1e9, -1e9}, {1.5, 1.5, -1.5, -1.5, 1.5}};
  for (const double shape_exponent : kShapeExponents) {
    for (const History& history : histories) {
      EXPECT_LE(Excess(LawWith(shape_exponent), history, 1), 0.0) << "alpha = " << shape_exponent;
    }
  }
}

TEST_P(EveryService, SlipsAfterOneGiantStep) {
  // Ten times the tolerance of the adaptive one; a backward step of h = 3e6 leaves u = 1/h².
  constexpr double kTolerance = 1e-5;
  const auto& [method, model] = GetParam();
  const History history = {3e6, -3e6};
  const std::vector<double> force =
      RespondBy(method->name, model->name, LawWith(0.5), {.displacement = history});
  EXPECT_NEAR(force[0], 1, kTolerance);
  EXPECT_NEAR(force[1], -1, kTolerance);
}

INSTANTIATE_TEST_SUITE_P(Methods, EveryService, ::testing::ValuesIn(Services()),
                         [](const auto& service) {
                           std::string name = std::string(service.param.method->name) + "_" +
                                              std::string(service.param.model->name);
                           std::ranges::replace(name, '-', '_');
                           return name;
                         });

TEST(Dopri5, CrossesAStepOfAnyLength) {
  const History history = {1e100, -1e100, 1e100};
  for (const double shape_exponent : kShapeExponents) {
    const BranchLaw law{1.0, shape_exponent, 1.0};
    const auto force = RespondBy("dopri5", "mindlin-dahl", law, {.displacement = history});
    EXPECT_NEAR(force[0], 1, 1e-5) << shape_exponent;  // 10 times the tolerance
    EXPECT_NEAR(force[1], -1, 1e-5) << shape_exponent;
  }
}

// --- exact ------------------------------------------------------------------

std::vector<History> NamedHistories(const BranchLaw& law) {
  const double unit = ReferenceDisplacement(law);
  const auto make = [&](Waveform waveform, double lambda, double cycles) {
    return Displacements({.waveform = waveform,
                          .amplitude = lambda * unit,
                          .cycles = cycles,
                          .samples_per_cycle = 22,
                          .seed = 7});
  };
  return {make(Waveform::kSine, 1e-6, 2),       make(Waveform::kSine, 0.8, 3),
          make(Waveform::kSine, 1.2, 3),        make(Waveform::kSine, 1e6, 2),
          make(Waveform::kGrowingSine, 1.5, 5), make(Waveform::kRandom, 1.4, 6),
          make(Waveform::kNested, 0.9, 6),      make(Waveform::kTriangle, 3.0, 2)};
}

TEST(Exact, IsTheLawAsDefinedInHundredDigits) {
  constexpr double kAccuracy = 1e-12;  // of the peak force: twenty times the bound of response.h
  for (const double shape_exponent : kShapeExponents) {
    const BranchLaw law{3.0, shape_exponent, 0.5};
    std::size_t number = 0;
    for (const History& history : NamedHistories(law)) {
      const auto defined = DefinedForce<Digits100>(law, history);
      const auto exact = RespondBy("exact", "mindlin-dahl", law, {.displacement = history});
      EXPECT_LE(LargestDifference(exact, defined), kAccuracy * Largest(defined))
          << "alpha = " << shape_exponent << ", history " << number;
      ++number;
    }
  }
}

// --- backward Euler and the exponential method solve what they say -------------------------

TEST(BackwardEuler, SolvesItsEquationToRounding) {
  // u' + h·u'^α − 1 changes sign within this of 1 − T: u' is a difference of terms up to 1, each
  // rounded, and so is T.
  constexpr long double kRounding = 4 * kEpsilon;
  for (const double alpha : {1e-8, 0.01, 0.2, 1.0 / 3, 0.5, 0.9, 1.0, 1.1, 2.0, 7.0, 1e4}) {
    const auto excess = [&](long double remaining, double h) {
      return remaining +
             (remaining > 0 ? h * std::pow(remaining, static_cast<long double>(alpha)) : 0.0L) - 1;
    };
    for (double h = 1e-6; h < 1e7; h *= 3.7) {
      const double force =
          RespondBy("backward-euler", "mindlin-dahl", {1, alpha, 1}, {.displacement = {&h, 1}})[0];
      const long double remaining = 1.0L - force;
      EXPECT_LE(excess(remaining - kRounding, h), 0.0L) << "alpha = " << alpha << ", h = " << h;
      EXPECT_GE(excess(remaining + kRounding, h), 0.0L) << "alpha = " << alpha << ", h = " << h;
    }
  }
}

TEST(BackwardEuler, NeverOverstepsTheExactForceOfAFirstLoading) {
  // u is convex, so that its slope at the end of a step is the least steep.
  for (const double alpha : {0.2, 1.0 / 3, 0.7, 1.0, 2.0}) {
    const BranchLaw law{1, alpha, 1};
    const History ramp = Displacements({.waveform = Waveform::kTriangle,
                                        .amplitude = 2 * ReferenceDisplacement(law),
                                        .cycles = 0.25,
                                        .samples_per_cycle = 400});
    const auto exact = RespondBy("exact", "mindlin-dahl", law, {.displacement = ramp});
    for (const std::size_t steps : {1U, 3U}) {
      const auto force = RespondBy("backward-euler", "mindlin-dahl", law, {.displacement = ramp},
                                   {.steps = steps});
      for (std::size_t i = 0; i < force.size(); ++i) {
        EXPECT_LE(force[i], exact[i] + 100 * kEpsilon);  // a rounding a step
      }
    }
  }
}

TEST(Exponential, IsExactForDahlsExponential) {
  constexpr double kRounding = 1e-13;  // 5 ε a step and 66 steps of a branch
  const BranchLaw law{1, 1.0, 1};
  for (const std::string_view model : {"mindlin-dahl", "dahl"}) {
    for (const History& history : NamedHistories(law)) {
      const auto exact = RespondBy("exact", model, law, {.displacement = history});
      for (const std::size_t steps : {1U, 3U}) {
        const auto force =
            RespondBy("exponential", model, law, {.displacement = history}, {.steps = steps});
        EXPECT_LE(LargestDifference(force, exact), kRounding) << model;
      }
    }
  }
}

TEST(Steps, AreExactForJenkinsBeforeSlip) {
  // A slope of 1: nothing but the roundings of 64 steps of a branch.
  constexpr double kRounding = 64 * kEpsilon;
  const History history = {0.25, 0.9, 0.1, -0.85, 0.3, 0.95, -0.95};
  const BranchLaw law{1, 0.0, 1};
  const auto exact = RespondBy("exact", "jenkins", law, {.displacement = history});
  for (const std::string_view method :
       {"euler", "rk4", "dopri5", "backward-euler", "exponential"}) {
    const auto force = RespondBy(method, "jenkins", law, {.displacement = history}, {.steps = 4});
    EXPECT_LE(LargestDifference(force, exact), kRounding) << method;
  }
}

// --- Preconditions --------------------------------------------------------------------------

template <typename Call>
std::string MessageOf(Call&& call) {
  try {
    call();
  } catch (const InvalidArgument& error) {
    return error.what();
  }
  return "";
}

TEST(Method, RefusesAModelThatItsElementsCannotRemember) {
  for (const std::string_view method : {"iwan", "iwan-optimal"}) {
    for (const std::string_view model : {"dahl", "simplified-dahl"}) {
      const std::string message = MessageOf([&] {
        Prepare(*FindMethod(method), *FindFrictionModel(model), {1, 0.5, 1}, {});
      });
      EXPECT_THAT(message, HasSubstr("method " + std::string(method) + " "));
      EXPECT_THAT(message, HasSubstr("model " + std::string(model) + ":"));
    }
  }
}

TEST(Method, RefusesParametersOutOfRange) {
  const FrictionModel& model = *FindFrictionModel("mindlin");
  for (const Method& method : Methods()) {
    const BranchLaw law{1, 1.0 / 3, 1};
    EXPECT_THAT(MessageOf([&] {
                  Prepare(method, model, {1, 1.0 / 3, 0}, {});
                }),
                HasSubstr("slip force [N]"));
    EXPECT_THAT(MessageOf([&] { Prepare(method, model, law, {.steps = 0}); }),
                HasSubstr("steps [-] = 0"));
    EXPECT_THAT(MessageOf([&] { Prepare(method, model, law, {.tolerance = -1}); }),
                HasSubstr("tolerance [-] = -1"));
    const Evaluator evaluate = Prepare(method, model, law, {});
    const History three = {0, 1, 2};
    const History not_a_number = {0, std::nan("")};
    History force(2);
    EXPECT_THAT(MessageOf([&] { evaluate({.displacement = three}, force); }),
                HasSubstr("displacement"))
        << method.name;
    EXPECT_NE(MessageOf([&] { evaluate({.displacement = not_a_number}, force); }), "")
        << method.name;
  }
}

TEST(Method, OfAdaptiveStepsRefusesAToleranceThatRoundingExceeds) {
  const FrictionModel& model = *models::FindFrictionModel("mindlin");
  const BranchLaw law{1, 1.0 / 3, 1};
  for (const Method& method : Methods()) {
    EXPECT_EQ(MessageOf([&] { Prepare(method, model, law, {.tolerance = kLeastTolerance}); }), "");
    const std::string message =
        MessageOf([&] { Prepare(method, model, law, {.tolerance = kLeastTolerance / 2}); });
    EXPECT_EQ(!message.empty(), method.adaptive) << method.name << message;
  }
}

TEST(Method, IsFoundByItsNameOnly) {
  for (const Method& method : Methods()) EXPECT_EQ(FindMethod(method.name), &method);
  EXPECT_EQ(FindMethod("RK4"), nullptr);
  EXPECT_EQ(FindMethod(""), nullptr);
}

}  // namespace
}  // namespace mindahl::methods::method_test
