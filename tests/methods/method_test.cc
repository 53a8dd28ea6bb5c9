#include "mindahl/methods/method.h"

#include <numeric>

#include "../support/histories.h"
#include "mindahl/methods/iwan.h"
#include "responses.h"
#include "support/prelude.h"

namespace mindahl::methods::method_test {
namespace {

using namespace models;

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

std::string NameOf(const Service& service) {
  return std::string(service.method->name) + " " + std::string(service.model->name);
}

BranchLaw LawOf(const Service& service, double shape_exponent) {
  return {1.0, service.model->shape_exponent.value_or(shape_exponent), 1.0};
}

/// Largest |T| over Tc beyond what is allowed, <= 0; NaN where a force is.
double Excess(const Service& service, const BranchLaw& law, const History& history,
              std::size_t steps) {
  const auto& [method, model] = service;
  // Slip forces of elements are rounded, and their sum.
  const double rounding = method->masing_only ? static_cast<double>(2 * steps) * kEpsilon : 0.0;
  const double limit = 1 + rounding;
  double excess = -limit;
  for (const double force :
       RespondBy(method->name, model->name, law, {.displacement = history}, {.steps = steps})) {
    const double beyond = std::abs(force) / law.slip_force - limit;
    if (!(beyond <= excess)) excess = beyond;
    if (std::isnan(excess)) break;
  }
  return excess;
}

TEST(EveryService, IsGuardedOverRandomHistoriesOfAnySize) {
  constexpr int kHistories = 60;
  for (const Service& service : Services()) {
    Generator generator(20171);
    for (const double shape_exponent : kShapeExponents) {
      const BranchLaw law = LawOf(service, shape_exponent);
      for (int i = 0; i < kHistories; ++i) {
        History history = RandomHistory(generator);
        const double size = LogUniform(generator, 1e-6, 1e6) * ReferenceDisplacement(law);
        const double reach = Largest(history);
        for (double& at : history) at *= reach > 0 ? size / reach : 0.0;
        EXPECT_LE(Excess(service, law, history, 1 + generator() % 3), 0.0)
            << NameOf(service) << ", alpha = " << shape_exponent << ", history " << i << " of size "
            << size;
      }
    }
  }
}

TEST(EveryService, IsGuardedOverStepsOfNoLengthAndGiantOnes) {
  // Ten times the tolerance of the adaptive one.
  constexpr double kTolerance = 1e-5;
  const History histories[] = {
      {0, 0, 0},           {1e-300, 1e-300, 0, -1e-300},   {0, 1e-9, 1e-9, 1e-9},
      {1e12, -1e12, 0, 0}, {0, 0.5, 1e9, 0.5, -1e9, -1e9}, {1.5, 1.5, -1.5, -1.5, 1.5}};
  for (const Service& service : Services()) {
    for (const double shape_exponent : kShapeExponents) {
      const BranchLaw law = LawOf(service, shape_exponent);
      SCOPED_TRACE(NameOf(service) + ", alpha = " + std::to_string(shape_exponent));
      for (const History& history : histories) {
        EXPECT_LE(Excess(service, law, history, 1), 0.0);
      }
      for (const double giant : {3e6, 1e100}) {
        const std::vector<double> force = RespondBy(service.method->name, service.model->name, law,
                                                    {.displacement = {{giant, -giant, giant}}});
        EXPECT_NEAR(force[0], 1, kTolerance);
        EXPECT_NEAR(force[1], -1, kTolerance);
      }
    }
  }
}

// --- exact -------------------------------------------------------------------

TEST(Exact, IsTheModelsOwnForce) {
  Generator generator(7);
  for (const FrictionModel& model : FrictionModels()) {
    const BranchLaw law{3.0, model.shape_exponent.value_or(0.7), 0.5};
    const History history = RandomHistory(generator);
    EXPECT_EQ(RespondBy("exact", model.name, law, {.displacement = history}),
              Respond(model, law, history))
        << model.name;
  }
}

// --- dopri5 and table -----------------------------------------------------------------------

TEST(Dopri5, ErrsLessTheSmallerItsTolerance) {
  // Local errors of a few hundred steps add up; that of the corner at slip is one of them.
  constexpr double kSteps = 300;
  for (const double lambda : {0.8, 1.2}) {
    for (const double alpha : {1.0 / 3, 0.7, 1.0}) {
      const BranchLaw law{1, alpha, 1};
      const std::vector<double> drive =
          Displacements({.amplitude = lambda * ReferenceDisplacement(law),
                         .cycles = 3.25,
                         .samples_per_cycle = 6});
      const Drive imposed{.displacement = drive};
      const auto exact = RespondBy("exact", "mindlin-dahl", law, imposed);
      double last = 1.0;
      for (const double tolerance : {1e-2, 1e-4, 1e-6, 1e-8, 1e-10}) {
        const double error = LargestDifference(
            RespondBy("dopri5", "mindlin-dahl", law, imposed, {.tolerance = tolerance}), exact);
        EXPECT_LE(error, kSteps * tolerance) << lambda << " " << alpha;
        EXPECT_LT(error, last) << lambda << " " << alpha << " " << tolerance;
        last = error;
      }
    }
  }
}

/// Largest error of the virgin curve by the table, densely sampled up to y.
double TableError(const BranchLaw& law, std::size_t intervals, double end) {
  constexpr int kSamples = 60'000;
  std::vector<double> ramp;
  for (int i = 0; i <= kSamples; ++i) {
    const double r = end / (1 + end) * i / kSamples;
    ramp.push_back(r / (1 - r));
  }
  const Drive drive{.displacement = ramp};
  return LargestDifference(RespondBy("table", "mindlin-dahl", law, drive, {.steps = intervals}),
                           RespondBy("exact", "mindlin-dahl", law, drive));
}

TEST(Table, HasOrderTwoBeforeSlipAndThatOfTheCornerOverAll) {
  struct Case {
    double alpha, end, order;
  };
  constexpr double kTolerance = 0.05;
  // For α >= 1 slip is at infinity, to which y = 1e12 is near enough.
  for (const auto& [alpha, end, order] :
       {Case{0.1, 0.8, 2}, Case{1.0 / 3, 1.2, 2}, Case{1.0 / 3, 1.5, 1.5}, Case{0.7, 1 / 0.3, 2},
        Case{1.0, 1e12, 2}, Case{3.0, 1e12, 0.5}, Case{4.0, 1e12, 1.0 / 3}}) {
    const BranchLaw law{1, alpha, 1};
    const double observed = std::log2(TableError(law, 128, end) / TableError(law, 512, end)) / 2;
    EXPECT_NEAR(observed, order, kTolerance) << alpha << " " << end;
  }
}

TEST(Table, IsExactForTheHyperbolaItIsSpacedBy) {
  // α = 2: φ = y/(1+y), whose nodes are rounded.
  const std::vector<double> drive = {0.1, 0.7, 3, 50, 2, -1e6};
  const Drive imposed{.displacement = drive};
  EXPECT_LE(
      LargestDifference(RespondBy("table", "mindlin-dahl", {1, 2.0, 1}, imposed, {.steps = 3}),
                        RespondBy("exact", "mindlin-dahl", {1, 2.0, 1}, imposed)),
      1e-14);
}

// --- Costs ----------------------------------------------------------------------------------

TEST(Cost, IsOfWhatAMethodDoesAlongTheDrive) {
  // Up, down and up again, never slipping: three branches.
  const std::vector<double> displacement = {0.1, 0.2, 0.3, 0.4, 0.3, 0.2, 0.1, 0.15, 0.2, 0.25};
  const auto cost = [&](std::string_view method, const Resolution& resolution = {},
                        std::string_view model = "mindlin-dahl", double alpha = 1.0 / 3) {
    std::vector<double> force(displacement.size());
    return Prepare(*FindMethod(method), *FindFrictionModel(model), {1, alpha, 1}, resolution)(
        {.displacement = displacement}, force);
  };
  EXPECT_DOUBLE_EQ(cost("exact"), 41 + 300 + 13 * 1.4);
  EXPECT_DOUBLE_EQ(cost("exact", {}, "mindlin-dahl", 0.6), 41 + 300 + 13 * 17);
  EXPECT_DOUBLE_EQ(cost("exact", {}, "mindlin-dahl", 0.0), 41 + 300);
  EXPECT_DOUBLE_EQ(cost("exact", {}, "dahl"), 41 + 300 + 13 * 1.4);
  EXPECT_DOUBLE_EQ(cost("iwan", {.steps = 5}), 10 * (5 * 0.35 + 4));
  EXPECT_DOUBLE_EQ(cost("table", {.steps = 64}), 41 + 300 + 13 * 2.3);
  EXPECT_GT(cost("dopri5", {.tolerance = 1e-13}), cost("dopri5", {.tolerance = 1e-3}));
  EXPECT_EQ(cost("dopri5"), cost("dopri5"));
}

// --- What is kept of the past ---------------------------------------------------------------

constexpr BranchLaw kLaw{.tangential_stiffness = 1, .shape_exponent = 1.0 / 3, .slip_force = 1};

TEST(ReturnPoint, AClosedLoopLeavesNothingBehind) {
  // The same way with and without an inner loop, which closes between the last two samples.
  const std::vector<double> with_loop = {0.4, 0.9, 0.5, 0.7, 0.45, 0.62, 0.3, 0.55, 0.2, -0.1};
  const std::vector<double> without = {0.4, 0.9, 0.5, 0.45, 0.3, 0.2, -0.1};
  for (const Method& method : Methods()) {
    const auto last = [&](const std::vector<double>& drive) {
      return RespondBy(method.name, "mindlin", kLaw, {.displacement = drive},
                       {.steps = method.default_steps})
          .back();
    };
    // Elements add roundings up, and nothing else does.
    EXPECT_NEAR(last(with_loop), last(without), method.masing_only ? 1e-14 : 0.0) << method.name;
  }
}

TEST(ReturnPoint, NothingDriftsInTenThousandCycles) {
  // A large cycle with an inner loop on either side, the same numbers every time.
  constexpr std::size_t kCycles = 10'000;
  const std::vector<double> cycle = {0.6, 1.1, 0.5, 0.7, 0.3, -0.4, -1.1, -0.8, -0.95, -0.2, 0.1};
  std::vector<double> drive;
  for (std::size_t i = 0; i < kCycles; ++i) drive.insert(drive.end(), cycle.begin(), cycle.end());
  // An element that never slips keeps each rounding, ε/2 of its force: in the worst case all of one
  // sign.
  const double elements = static_cast<double>(drive.size()) * 1.2e-16;
  for (const Method& method : Methods()) {
    const auto force = RespondBy(method.name, "mindlin", kLaw, {.displacement = drive},
                                 {.steps = method.masing_only ? 8 : method.default_steps});
    const auto nth = [&](std::size_t n) {
      return std::span(force).subspan(n * cycle.size(), cycle.size());
    };
    EXPECT_LE(LargestDifference(nth(2), nth(kCycles - 1)), method.masing_only ? elements : 0.0)
        << method.name;
  }
}

// --- Preconditions --------------------------------------------------------------------------

TEST(Method, RefusesAModelThatItsElementsCannotRemember) {
  const std::string message = MessageOf([&] {
    Prepare(*FindMethod("iwan"), *FindFrictionModel("dahl"), {1, 0.5, 1}, {});
  });
  EXPECT_THAT(message, HasSubstr("method iwan "));
  EXPECT_THAT(message, HasSubstr("model dahl:"));
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

TEST(Method, IsFoundByItsNameOnly) {
  for (const Method& method : Methods()) EXPECT_EQ(FindMethod(method.name), &method);
  EXPECT_EQ(FindMethod("IWAN"), nullptr);
  EXPECT_EQ(FindMethod(""), nullptr);
}

// ---

double Sum(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

/// Displacements at which an element slips: the corners of the polygon.
std::vector<double> Corners(const IwanElements& elements) {
  std::vector<double> corners;
  for (std::size_t i = 0; i < elements.size(); ++i) {
    corners.push_back(elements.slip_force[i] / elements.stiffness[i]);
  }
  return corners;
}

/// Largest error of the virgin curve [N]: at a corner, since the polygon lies outside.
double VirginError(const BranchLaw& law, const IwanElements& elements) {
  double worst = 0.0;
  for (const double corner : Corners(elements)) {
    double force = 0.0;
    for (std::size_t i = 0; i < elements.size(); ++i) {
      force += std::min(elements.stiffness[i] * corner, elements.slip_force[i]);
    }
    worst = std::max(worst, force - BackboneForce(law, corner));
  }
  return worst;
}

TEST(Iwan, StiffnessesSumToSigmaAndSlipForcesToTc) {
  for (const double alpha :
       {0.0, 1e-300, 1e-8, 0.1, 1.0 / 3, 0.999, 1.0, 1.001, 2.0, 50.0, 100.0}) {
    const BranchLaw law{4.8e8, alpha, 0.3};
    for (const std::size_t n : {1U, 2U, 7U, 100U, 2000U}) {
      const IwanElements elements = MakeIwanElements(law, n);
      const double rounding = static_cast<double>(n + 1) * kEpsilon;
      EXPECT_NEAR(Sum(elements.stiffness) / 4.8e8, 1, rounding) << alpha << " " << n;
      EXPECT_NEAR(Sum(elements.slip_force) / 0.3, 1, rounding) << alpha << " " << n;
      EXPECT_GE(std::ranges::min(elements.stiffness), 0) << alpha << " " << n;
      EXPECT_GE(std::ranges::min(elements.slip_force), 0) << alpha << " " << n;
    }
  }
}

TEST(Iwan, IsOneExactElementForJenkins) {
  const IwanElements elements = MakeIwanElements({4, 0.0, 3}, 10);
  EXPECT_EQ(elements.stiffness, std::vector<double>{4});
  EXPECT_EQ(elements.slip_force, std::vector<double>{3});
}

TEST(Iwan, LeavesItsErrorAndSecondOrder) {
  for (const double alpha : {0.05, 1.0 / 3, 0.5, 1.0, 2.0}) {
    const BranchLaw law{7, alpha, 3};
    // At the last corner, exactly, and between tangents near u = 1, to leading order in 1/n.
    const double last = alpha == 1 ? std::exp(-1.0) : std::pow(alpha, 1 / (1 - alpha));
    const double expected = 3 * std::max(alpha / 2, last);
    double coarse = 0.0;
    for (const double n : {16.0, 64.0, 256.0}) {
      const double error = VirginError(law, MakeIwanElements(law, static_cast<std::size_t>(n)));
      const double next = 2 * alpha / n;
      EXPECT_NEAR(error * n * n / expected, 1, next) << alpha << " " << n;
      if (coarse > 0) {
        EXPECT_NEAR(coarse / error, 16, 2 * 16 * next) << alpha << " " << n;
      }
      coarse = error;
    }
  }
}

TEST(Iwan, ErrorsDoubleAfterAReversal) {
  // The whole loop of a polygon that reaches slip: T = Tc − 2f(·/2), to the last corner.
  const BranchLaw law{1, 1.0 / 3, 1};
  const IwanElements elements = MakeIwanElements(law, 20);
  std::vector<double> drive = {5};
  std::vector<double> corners = Corners(elements);
  std::ranges::sort(corners);
  for (const double corner : corners) drive.push_back(5 - 2 * corner);
  std::vector<double> force(drive.size());
  EvaluateIwanForce(elements, drive, force);
  const auto exact = RespondBy("exact", "mindlin", law, {.displacement = drive});
  const double virgin = VirginError(law, elements);
  constexpr double kRounding = 1e-14;  // 20 elements, 20 steps
  EXPECT_NEAR(LargestDifference(force, exact), 2 * virgin, kRounding);
}

TEST(Iwan, IsMasingsLawWithItsReturnPoints) {
  // 20 000 elements know no rule of Masing's or Madelung's. Each of the remembered extrema, 16 in
  // the nested loops, errs by twice the virgin curve's error, every second to the same side.
  constexpr double kAccuracy = 16 * 0.1925 / (20'000.0 * 20'000.0);
  const BranchLaw law{1, 1.0 / 3, 1};
  const double amplitude = 1.1 * ReferenceDisplacement(law);
  testing::Generator generator(3);
  std::vector<double> random;
  std::vector<double> nested;
  for (int turn = 0; turn <= 16; ++turn) {
    random.push_back(testing::Uniform(generator, -amplitude, amplitude));
    // Extremes that fall by equal steps to the innermost and grow again.
    nested.push_back((turn % 2 == 0 ? 1 : -1) * amplitude * std::abs(4 * (turn - 8) + 1) / 33);
  }
  const std::vector<double> growing = Displacements({.waveform = Waveform::kGrowingSine,
                                                     .amplitude = amplitude,
                                                     .cycles = 8,
                                                     .samples_per_cycle = 14});
  for (const std::vector<double>& drive : {random, nested, growing}) {
    const auto elements =
        RespondBy("iwan", "mindlin", law, {.displacement = drive}, {.steps = 20'000});
    const auto exact = RespondBy("exact", "mindlin", law, {.displacement = drive});
    EXPECT_LE(LargestDifference(elements, exact), kAccuracy);
  }
}

TEST(Iwan, RefusesNoElementAndSizesThatDiffer) {
  EXPECT_THROW(MakeIwanElements({1, 0.5, 1}, 0), InvalidArgument);
  EXPECT_THROW(MakeIwanElements({-1, 0.5, 1}, 4), InvalidArgument);
  std::vector<double> force(2);
  EXPECT_THROW(EvaluateIwanForce({{1}, {1}}, std::vector<double>{0, 1, 2}, force), InvalidArgument);
  EXPECT_THROW(EvaluateIwanForce({{1, 2}, {1}}, std::vector<double>{0, 1}, force), InvalidArgument);
}

}  // namespace
}  // namespace mindahl::methods::method_test
