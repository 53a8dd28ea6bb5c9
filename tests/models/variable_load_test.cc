#include "../support/variable_load.h"

#include <cfenv>

#include "../support/histories.h"
#include "../support/winkler_foundation.h"
#include "support/prelude.h"

namespace mindahl::models::variable_load_test {
namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// The elastic limit at the reference load is 1, as testing::RandomHistory expects.
constexpr LoadDependentLaw UnitLaw(double shape_exponent) {
  return {.friction_coefficient = 0.5,
          .reference_load = 2.0,
          .reference_stiffness = 1.0,
          .shape_exponent = shape_exponent};
}

constexpr double kShapeExponents[] = {0.0, 1e-8, 0.1, 1.0 / 3.0, 0.5, 0.9, 0.99};

/// The branch law that holds while N stays constant.
BranchLaw BranchLawAtLoad(const LoadDependentLaw& law, double load) {
  return AtLoad(ReferenceLaw(law), load / law.reference_load, law.shape_exponent);
}

/// A path of (δ, N).
struct LoadedHistory {
  History displacement;
  History normal_load;
};

History Respond(const LoadDependentLaw& law, const LoadedHistory& path) {
  History force(path.displacement.size());
  EvaluateForceUnderLoad(law, path.displacement, path.normal_load, force);
  return force;
}

/// Error of a zoned contact, by the largest σ and Tc of the path.
double RoundingBound(const LoadDependentLaw& law, const LoadedHistory& path) {
  const double load = Largest(path.normal_load);
  if (load == 0) return 0.0;
  const BranchLaw at_load = BranchLawAtLoad(law, load);
  return 8 * kEpsilon *
         (at_load.tangential_stiffness * Largest(path.displacement) +
          at_load.slip_force / (1 - law.shape_exponent));
}

/// Random displacements under random loads about the reference: from step to step, smooth, or
/// constant for a while, with samples that are lifted off.
LoadedHistory RandomLoadedHistory(Generator& generator, bool lift_off) {
  LoadedHistory path;
  path.displacement = testing::RandomHistory(generator);
  const std::size_t kind = generator() % 3;
  const double phase = Uniform(generator, 0, 6);
  double load = 2.0;
  for (std::size_t i = 0; i < path.displacement.size(); ++i) {
    if (kind == 0 || (kind == 1 && generator() % 5 == 0)) load = LogUniform(generator, 0.5, 6.0);
    if (kind == 2) load = 2.0 + 1.5 * std::sin(0.4 * static_cast<double>(i) + phase);
    path.normal_load.push_back(lift_off && generator() % 20 == 0 ? 0.0 : load);
  }
  return path;
}

/// From displacement 0 on, with `parts` steps for each of the path's, straight in (δ, N).
LoadedHistory Subdivide(const LoadedHistory& path, int parts) {
  LoadedHistory fine{{0.0}, {path.normal_load.front()}};
  for (std::size_t k = 0; k < path.displacement.size(); ++k) {
    const double from = fine.displacement.back();
    const double load = fine.normal_load.back();
    for (int part = 1; part <= parts; ++part) {
      const double share = static_cast<double>(part) / parts;
      fine.displacement.push_back(from + share * (path.displacement[k] - from));
      fine.normal_load.push_back(load + share * (path.normal_load[k] - load));
    }
  }
  return fine;
}

// --- What the law is ----------------------------------------------------------------------------

TEST(VariableLoad, IsTheBranchLawWhereTheLoadIsConstant) {
  constexpr double kClosedForm = 64 * kEpsilon;  // 6 ε a branch, random over at most 60 nested ones
  Generator generator(41);
  for (const double alpha : kShapeExponents) {
    const LoadDependentLaw law = UnitLaw(alpha);
    for (int i = 0; i < 1000; ++i) {
      const double load = i % 2 == 0 ? 2.0 : LogUniform(generator, 0.1, 10.0);
      LoadedHistory path{testing::RandomHistory(generator), {}};
      path.normal_load.assign(path.displacement.size(), load);
      const BranchLaw at_load = BranchLawAtLoad(law, load);
      const History expected = testing::Respond(Model("mindlin-dahl"), at_load, path.displacement);
      const History force = Respond(law, path);
      for (std::size_t k = 0; k < force.size(); ++k) {
        ASSERT_NEAR(force[k], expected[k],
                    RoundingBound(law, path) + kClosedForm * at_load.slip_force)
            << "alpha = " << alpha << ", history " << i << ", sample " << k;
      }
    }
  }
}

TEST(VariableLoad, FollowsTheLoadWhereTheLoadOutrunsSlip) {
  // |Δδ| < Δδc all the way: nothing slips, and T − T₀ = (Δδ/Δδc)·μ·(N − N₀).
  for (const double alpha : kShapeExponents) {
    const LoadDependentLaw law = UnitLaw(alpha);
    const double narrow = GrossSlipDisplacement(BranchLawAtLoad(law, 1.0));
    const double wide = GrossSlipDisplacement(BranchLawAtLoad(law, 3.0));
    for (const double rate : {-0.99, -0.3, 0.0, 0.6, 1.0}) {
      const LoadedHistory path{{0.2, 0.2 + rate * (wide - narrow)}, {1.0, 3.0}};
      const History force = Respond(law, path);
      EXPECT_NEAR(force[1] - force[0], rate * 0.5 * (3.0 - 1.0), RoundingBound(law, path))
          << alpha << ' ' << rate;
    }
  }
}

TEST(VariableLoad, FallsToTheVirginCurveOfTheLowerLoad) {
  // Loaded once and never reversed, an element carries the lesser of δ and δc(N) − h whatever N has
  // been before, as long as it was more.
  Generator generator(42);
  for (const double alpha : kShapeExponents) {
    const LoadDependentLaw law = UnitLaw(alpha);
    for (int i = 0; i < 200; ++i) {
      const double displacement = LogUniform(generator, 0.01, 3.0);
      const double lower = LogUniform(generator, 0.1, 3.0);
      const LoadedHistory path{{displacement, displacement}, {3.0, lower}};
      EXPECT_NEAR(Respond(law, path)[1], BackboneForce(BranchLawAtLoad(law, lower), displacement),
                  RoundingBound(law, path))
          << alpha << ' ' << displacement << ' ' << lower;
    }
  }
}

// --- Laws that it obeys on any path -------------------------------------------------------------

TEST(VariableLoad, DoesNotSeeSamplesOnItsPath) {
  Generator generator(43);
  for (const double alpha : kShapeExponents) {
    const LoadDependentLaw law = UnitLaw(alpha);
    // Placing a sample on the path rounds its load, by 4 ε, and with it δc: as much again.
    constexpr double kPlacing = 3;
    for (int i = 0; i < 500; ++i) {
      // N ∝ δc^{1/(1−α)} of a sample near lift-off can be too small for a double.
      const bool lift_off = alpha <= 0.9;
      const LoadedHistory path = RandomLoadedHistory(generator, lift_off);
      LoadedHistory split;
      std::vector<std::size_t> at;
      for (std::size_t k = 0; k < path.displacement.size(); ++k) {
        if (k > 0) {
          const double share = Uniform(generator, 0, 1);
          const auto between = [&](double from, double to) { return from + share * (to - from); };
          const auto width = [&](double load) { return std::pow(load, 1 - alpha); };
          split.displacement.push_back(between(path.displacement[k - 1], path.displacement[k]));
          split.normal_load.push_back(
              std::pow(between(width(path.normal_load[k - 1]), width(path.normal_load[k])),
                       1 / (1 - alpha)));
        }
        at.push_back(split.displacement.size());
        split.displacement.push_back(path.displacement[k]);
        split.normal_load.push_back(path.normal_load[k]);
      }
      const History expected = Respond(law, path);
      const History force = Respond(law, split);
      for (std::size_t k = 0; k < at.size(); ++k) {
        ASSERT_NEAR(force[at[k]], expected[k], kPlacing * RoundingBound(law, path))
            << "alpha = " << alpha << ", history " << i << ", sample " << k;
      }
    }
  }
}

TEST(VariableLoad, IsOddAndWithinTheSlipForce) {
  Generator generator(44);
  for (const double alpha : kShapeExponents) {
    const LoadDependentLaw law = UnitLaw(alpha);
    for (int i = 0; i < 500; ++i) {
      LoadedHistory path = RandomLoadedHistory(generator, true);
      const History force = Respond(law, path);
      for (double& displacement : path.displacement) displacement = -displacement;
      const History mirrored = Respond(law, path);
      for (std::size_t k = 0; k < force.size(); ++k) {
        ASSERT_EQ(force[k], -mirrored[k]);
        ASSERT_LE(std::abs(force[k]), law.friction_coefficient * path.normal_load[k]);
      }
    }
  }
}

TEST(VariableLoad, NeverGivesMoreWorkThanItTook) {
  // The elements store energy and lose it in slip; the normal load cannot reach it, since they
  // carry nothing when they lift off. So from the unloaded contact ∫T dδ >= 0 on every path.
  constexpr int kParts = 64;
  Generator generator(45);
  for (const double alpha : kShapeExponents) {
    const LoadDependentLaw law = UnitLaw(alpha);
    for (int i = 0; i < 100; ++i) {
      const LoadedHistory fine = Subdivide(RandomLoadedHistory(generator, true), kParts);
      const History force = Respond(law, fine);
      double work = 0.0;
      double trapezoidal_error = 0.0;
      for (std::size_t k = 1; k < force.size(); ++k) {
        const double step = fine.displacement[k] - fine.displacement[k - 1];
        work += 0.5 * (force[k] + force[k - 1]) * step;
        // Half the box between two samples, which holds any monotone arc.
        trapezoidal_error += 0.5 * std::abs((force[k] - force[k - 1]) * step);
        ASSERT_GE(work, -trapezoidal_error) << alpha << ", history " << i << ", sample " << k;
      }
    }
  }
}

// --- Against the foundation of springs ----------------------------------------------------------

/// The foundation as a law: Hertz, and 2aG̃ for the stiffness.
LoadDependentLaw LawOf(const testing::FoundationOptions& options, double reference_load) {
  return {.friction_coefficient = options.friction_coefficient,
          .reference_load = reference_load,
          .reference_stiffness = WinklerFoundation(options).Stiffness(reference_load),
          .shape_exponent = 1.0 / 3.0};
}

History Respond(const testing::FoundationOptions& options, const LoadedHistory& path) {
  WinklerFoundation foundation(options);
  foundation.Press(path.normal_load.front());
  History force;
  for (std::size_t i = 0; i < path.displacement.size(); ++i) {
    force.push_back(foundation.Move(path.displacement[i], path.normal_load[i]));
  }
  return force;
}

TEST(VariableLoad, IsTheWinklerFoundationOnAnyPath) {
  testing::FoundationOptions options;
  options.largest_load = 6.0;
  const LoadDependentLaw law = LawOf(options, 2.0);
  const BranchLaw at_reference = BranchLawAtLoad(law, 2.0);
  Generator generator(47);
  for (int i = 0; i < 300; ++i) {
    LoadedHistory path = RandomLoadedHistory(generator, true);
    for (double& displacement : path.displacement) {
      displacement *= at_reference.slip_force / at_reference.tangential_stiffness;
    }
    const History force = Respond(law, path);
    const History expected = Respond(options, path);
    for (std::size_t k = 0; k < force.size(); ++k) {
      const double load = path.normal_load[k];
      if (load == 0) {
        ASSERT_EQ(expected[k], 0.0);
        continue;
      }
      const double bound =
          WinklerFoundation(options).SpacingError(load, static_cast<double>(k + 1));
      ASSERT_NEAR(force[k], expected[k], bound * law.friction_coefficient * load) << i << ' ' << k;
    }
  }
}

// --- Edges --------------------------------------------------------------------------------------

TEST(VariableLoad, StaysFiniteAtEveryExtremeAndRaisesNoFlag) {
  constexpr int kTrapped = FE_INVALID | FE_OVERFLOW | FE_DIVBYZERO;
  Generator generator(48);
  for (const double alpha : {0.0, 1e-300, 1e-16, 1.0 / 3.0, 0.5, 1 - 1e-8, 1 - 1e-15}) {
    for (const double reference_load : {1e-15, 1.0, 1e12}) {
      for (const double stiffness : {1e-9, 1.0, 1e15}) {
        const LoadDependentLaw law{0.3, reference_load, stiffness, alpha};
        const double size = GrossSlipDisplacement(BranchLawAtLoad(law, reference_load));
        LoadedHistory path;
        for (int i = 0; i < 300; ++i) {
          const double reach = size * LogUniform(generator, 1e-18, 1e12);
          path.displacement.push_back(i % 7 == 0 ? 0.0 : Uniform(generator, -reach, reach));
          const double load = LogUniform(generator, 1e-15, 1e12);
          path.normal_load.push_back(i % 11 == 0 ? 0.0 : i % 13 == 0 ? 5e-324 : load);
          if (i % 3 == 0 && i > 0) path.normal_load[path.normal_load.size() - 1] = load;
          if (i % 5 == 0) {  // a step of no length
            path.displacement.push_back(path.displacement.back());
            path.normal_load.push_back(path.normal_load.back());
          }
        }
        std::feclearexcept(kTrapped);
        const History force = Respond(law, path);
        ASSERT_EQ(std::fetestexcept(kTrapped), 0) << alpha << ' ' << reference_load;
        for (std::size_t i = 0; i < force.size(); ++i) {
          ASSERT_LE(std::abs(force[i]), 0.3 * path.normal_load[i])
              << alpha << ' ' << reference_load << ' ' << stiffness << ' ' << i;
        }
      }
    }
  }
}

TEST(VariableLoad, KeepsEveryDigitOfASmallVirginDisplacement) {
  constexpr double kDigits = 8 * kEpsilon;
  const LoadDependentLaw law = UnitLaw(1.0 / 3.0);
  for (double displacement = 1e-18; displacement < 1; displacement *= 10) {
    const double expected = BackboneForce(BranchLawAtLoad(law, 2.0), displacement);
    EXPECT_NEAR(Respond(law, {{displacement}, {2.0}})[0], expected, kDigits * expected);
  }
}

TEST(LoadedContact, RemembersAsManyZonesAsTheLoopIsDeepNotAsItIsLong) {
  constexpr std::size_t kSteps = 1'000'000;
  constexpr std::size_t kPerCycle = 200;
  LoadedContact contact(UnitLaw(1.0 / 3.0), 2.0);
  std::vector<double> second_cycle(kPerCycle);
  std::size_t most = 0;
  for (std::size_t i = 0; i < kSteps; ++i) {
    const double phase = 2 * 3.141592653589793 * static_cast<double>(i % kPerCycle) / kPerCycle;
    const double force = contact.Move(1.2 * std::sin(phase), 2.0);
    most = std::max(most, contact.zones());
    if (i / kPerCycle == 1) second_cycle[i % kPerCycle] = force;
    if (i / kPerCycle > 1) {
      ASSERT_EQ(force, second_cycle[i % kPerCycle]) << i;
    }
  }
  EXPECT_LE(most, 3U);
}

TEST(LoadedContact, AddsOneZoneForALoadThatRisesAtRest) {
  LoadedContact contact(UnitLaw(1.0 / 3.0), 0.0);
  contact.Move(0.5, 1.0);
  const std::size_t zones = contact.zones();
  for (int i = 1; i < 1000; ++i) contact.Move(0.5, 1.0 + 0.01 * i);
  EXPECT_LE(contact.zones(), zones + 1);
}

}  // namespace
}  // namespace mindahl::models::variable_load_test
