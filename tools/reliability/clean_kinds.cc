#include "kind.h"
#include "simulation.h"

/// Loops with nothing wrong: a little white noise of the force, 0.1, 0.5, 2 % of Tc by level.
namespace mindahl::reliability {
namespace {

Truth Quiet(const Truth& truth, std::size_t level) {
  Truth quiet = truth;
  quiet.noise = At(level, {0.001, 0.005, 0.02});
  return quiet;
}

Loop Clean(const Truth& truth, Draws& draws) { return {Measured(truth, draws), AllOf(truth.law)}; }

Loop GrossSlip(const Truth& truth, std::size_t level, Draws& draws) {
  Truth clean = Quiet(truth, level);
  clean.reach = draws.Uniform(1.3, 4.0);
  return Clean(clean, draws);
}

Loop NearSlip(const Truth& truth, std::size_t level, Draws& draws) {
  Truth clean = Quiet(truth, level);
  clean.reach = draws.Uniform(0.8, 1.2);
  return Clean(clean, draws);
}

Loop CleanPartialSlip(const Truth& truth, std::size_t level, Draws& draws) {
  Truth clean = Quiet(truth, level);
  clean.reach = draws.Uniform(0.3, 0.7);
  return Clean(clean, draws);
}

Loop Mindlin(const Truth& truth, std::size_t level, Draws& draws) {
  Truth clean = Quiet(truth, level);
  clean.law.shape_exponent = 1.0 / 3;
  return Clean(clean, draws);
}

Loop Jenkins(const Truth& truth, std::size_t level, Draws& draws) {
  Truth clean = Quiet(truth, level);
  clean.law.shape_exponent = 0.0;
  return Clean(clean, draws);
}

Loop LargeShape(const Truth& truth, std::size_t level, Draws& draws) {
  Truth clean = Quiet(truth, level);
  clean.law.shape_exponent = draws.Uniform(1.0, 1.5);
  clean.reach = draws.Uniform(1.0, 3.0);
  return Clean(clean, draws);
}

Loop Dense(const Truth& truth, std::size_t level, Draws& draws) {
  Truth clean = Quiet(truth, level);
  clean.cycles = 3;
  clean.samples_per_cycle = 3333;
  return Clean(clean, draws);
}

Loop ManyCycles(const Truth& truth, std::size_t level, Draws& draws) {
  Truth clean = Quiet(truth, level);
  clean.cycles = 40;
  clean.samples_per_cycle = 100;
  return Clean(clean, draws);
}

}  // namespace

std::vector<Kind> CleanKinds() {
  return {
      {"clean, gross slip", Half::kClean, GrossSlip, "reach 1.3 to 4"},
      {"clean, near slip", Half::kClean, NearSlip, "reach 0.8 to 1.2"},
      {"clean, partial slip", Half::kClean, CleanPartialSlip, "reach 0.3 to 0.7"},
      {"clean, Mindlin's contact", Half::kClean, Mindlin, "alpha = 1/3"},
      {"clean, Jenkins' element", Half::kClean, Jenkins, "alpha = 0"},
      {"clean, alpha above 1", Half::kClean, LargeShape, "1 to 1.5, reach 1 to 3"},
      {"clean, 10,000 rows", Half::kClean, Dense, "three cycles", false},
      {"clean, many cycles", Half::kClean, ManyCycles, "40 of 100 samples"},
  };
}

}  // namespace mindahl::reliability
