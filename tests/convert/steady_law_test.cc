#include "mindahl/convert/steady_law.h"

#include <boost/math/quadrature/gauss_kronrod.hpp>

#include "mindahl/models/response.h"
#include "mindahl/models/steady_loop.h"
#include "support/histories.h"
#include "support/prelude.h"

namespace mindahl::convert::steady_law_test {
namespace {

using models::BranchLaw;

/// Places of a rising branch between ±X, and its displacements.
struct Branch {
  explicit Branch(double amplitude, std::size_t places = 41) {
    for (std::size_t i = 0; i < places; ++i) {
      distance.push_back(2 * amplitude *
                         (static_cast<double>(i) / static_cast<double>(places - 1)));
    }
  }
  [[nodiscard]] std::vector<double> Of(const SteadyLaw& law) const {
    std::vector<double> force(distance.size());
    std::ranges::transform(distance, force.begin(), LoopOf(law, distance.back() / 2).force);
    return force;
  }
  std::vector<double> distance;
};

/// dT/dx of Bouc's and Wen's law on a rising branch: the definition itself.
double RisingSlope(const BoucWenLaw& law, double force) {
  const double share = force / law.slip_force;
  const double against = share > 0 ? 1.0 : share < 0 ? -1.0 : 0.0;
  return law.stiffness * (1 - std::pow(std::abs(share), law.exponent) * (1 + against) / 2);
}

/// Way between two forces of a rising branch, ∫ dT/(dT/dx), in two parts with 0 between.
double WayBetween(const BoucWenLaw& law, double from, double to) {
  const auto integrate = [&](double low, double high) {
    if (!(low < high)) return 0.0;
    constexpr double kTolerance = 1e-12;
    return boost::math::quadrature::gauss_kronrod<double, 61>::integrate(
        [&](double force) { return 1 / RisingSlope(law, force); }, low, high, 15, kTolerance);
  };
  return integrate(from, std::min(to, 0.0)) + integrate(std::max(from, 0.0), to);
}

TEST(SteadyLaw, OfAModelIsTheModelsOwnSteadyLoop) {
  // Either is within 6 ε of Tc of the truth after the errors of T* (16 ε).
  constexpr double kTwoEvaluations = 64 * std::numeric_limits<double>::epsilon();
  for (const char* name : {"mindlin-dahl", "dahl"}) {
    for (const double alpha : {0.0, 1.0 / 3, 1.0, 2.5}) {
      for (const double amplitude : {0.1, 0.9, 1.5, 8.0}) {
        const BranchLaw law{1.0, alpha, 1.0};
        const Branch branch(amplitude);
        const std::vector<double> force = branch.Of(ModelLaw{&Model(name), law});
        History displacement;
        for (const double distance : branch.distance) displacement.push_back(distance - amplitude);
        const auto expected =
            Respond(Model(name), law, displacement, {.state = models::InitialState::kSteady});
        for (std::size_t i = 0; i < force.size(); ++i) {
          EXPECT_NEAR(force[i], expected[i], kTwoEvaluations) << name << ' ' << alpha << ' ' << i;
        }
      }
    }
  }
}

TEST(SteadyLaw, OfBoucWenMatchesIntegratedEquation) {
  constexpr double kStated = 1e-8;
  for (const double exponent : {1.0, 1.7, 4.0}) {
    for (const double amplitude : {0.5, 1.2, 4.0}) {
      const BoucWenLaw law{3.0, 2.0, exponent};
      const Branch branch(amplitude);
      const std::vector<double> force = branch.Of(law);
      EXPECT_NEAR(force.front() / law.slip_force, -force.back() / law.slip_force, kStated);
      for (std::size_t i = 0; i < force.size(); ++i) {
        // The force that corresponds to the error of the displacement.
        const double missing = (WayBetween(law, force.front(), force[i]) - branch.distance[i]) *
                               RisingSlope(law, force[i]);
        EXPECT_NEAR(missing / law.slip_force, 0.0, kStated)
            << exponent << ' ' << amplitude << ' ' << i;
      }
    }
  }
}

TEST(SteadyLaw, OfElementsIsTheirOwnSteadyLoop) {
  const BranchLaw mindlin{4e7, 1.0 / 3, 40.0};
  const auto elements = methods::MakeIwanElements(mindlin, 5);
  for (const double amplitude : {3e-7, 1.2e-6, 4e-6}) {
    const Branch branch(amplitude, 2001);
    History cycle = {amplitude, -amplitude};
    for (const double distance : branch.distance) cycle.push_back(distance - amplitude);
    std::vector<double> expected(cycle.size());
    methods::EvaluateIwanForce(elements, cycle, expected);
    const std::vector<double> force = branch.Of(elements);
    double area = 0.0;
    for (std::size_t i = 0; i < force.size(); ++i) {
      EXPECT_NEAR(force[i], expected[i + 2], 1e-11 * 40.0);  // 2000 additions of an ulp of 40
      if (i == 0) continue;
      area += (expected[i + 2] + expected[i + 1]) * (branch.distance[i] - branch.distance[i - 1]);
    }
    // W = 2∫T dx over the branch; of a polygon the trapezoids miss a step's square at each corner.
    EXPECT_NEAR(LoopOf(elements, amplitude).energy / (4 * amplitude * 40.0),
                area / (4 * amplitude * 40.0), 1e-5);
  }
}

TEST(SteadyLaw, IsComparedByForceOverThePeakAndByEnergy) {
  // Springs with Coulomb's limit that both slip: T* differ by 2 of 40, energies by 4ΔTc(X − Tc/σ) …
  const ModelLaw reference{&Model("mindlin-dahl"), {4e7, 0.0, 40.0}};
  const ModelLaw weaker{&Model("mindlin-dahl"), {3.8e7, 0.0, 38.0}};  // of the same travel, 1 µm
  const LoopError error = CompareLoops(weaker, reference, 3e-6);
  EXPECT_NEAR(error.force, 2.0 / 40.0, 1e-12);
  EXPECT_NEAR(error.energy, 38.0 / 40.0 - 1, 1e-12);
  // Below its slip the reference loses nothing.
  const ModelLaw slips_sooner{&Model("mindlin-dahl"), {4e7, 0.0, 10.0}};
  EXPECT_TRUE(std::isinf(CompareLoops(slips_sooner, reference, 0.5e-6).energy));
  EXPECT_EQ(CompareLoops(reference, reference, 0.5e-6).energy, 0.0);
}

TEST(SteadyLaw, IsComparedWhereTheBranchesDifferMost) {
  // As stated; the even places miss a smooth maximum by (1/4000)²/2 of its curvature, a corner by
  // half a place's change of force, 1/4000 of some T*.
  constexpr double kStated = 1e-3;
  constexpr double kBetweenPlaces = 1.0 / 4000;
  const ModelLaw mindlin{&Model("mindlin-dahl"), {4e7, 1.0 / 3, 40.0}};
  const SteadyLaw laws[] = {
      ModelLaw{&Model("mindlin-dahl"), {3.2126e7, 0.0, 33.598}},
      ModelLaw{&Model("dahl"), {3.2e7, 1.0, 110.0}},
      methods::MakeIwanElements(mindlin.law, 3),
      methods::MakeIwanElements(mindlin.law, 200),
  };
  for (const SteadyLaw& law : laws) {
    for (const double amplitude : {2e-7, 1.2e-6, 2.6e-6}) {
      const Branch branch(amplitude, 4001);
      const std::vector<double> force = branch.Of(law);
      const std::vector<double> expected = branch.Of(mindlin);
      double largest = 0.0;
      for (std::size_t i = 0; i < force.size(); ++i) {
        largest = std::max(largest, std::abs(force[i] - expected[i]) / expected.back());
      }
      const double stated = CompareLoops(law, mindlin, amplitude).force;
      EXPECT_GE(stated, (1 - kStated) * largest) << law.index() << ' ' << amplitude;
      EXPECT_LE(stated, (1 + kStated) * largest + kBetweenPlaces)
          << law.index() << ' ' << amplitude;
    }
  }
}

TEST(SteadyLaw, RefusesInvalidLaw) {
  EXPECT_THROW(LoopOf(BoucWenLaw{1.0, 1.0, 1.0}, -1.0).energy, InvalidArgument);
  EXPECT_THROW(LoopOf(ModelLaw{&Model("dahl"), {0.0, 1.0, 1.0}}, 1.0).energy, InvalidArgument);
}

}  // namespace
}  // namespace mindahl::convert::steady_law_test
