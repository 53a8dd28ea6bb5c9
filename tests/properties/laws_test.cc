// One test per law of friction, run over every model. A law that a model lacks is listed here with
// the reason, and its test then demands that the model breaks it.

#include "../support/histories.h"
#include "mindahl/models/branch_law.h"
#include "mindahl/models/friction_model.h"
#include "mindahl/models/steady_loop.h"
#include "support/prelude.h"

namespace mindahl::models::laws_test {
namespace {

/// What a law's test may find between two evaluations that are equal in exact arithmetic, over Tc:
/// twice the error bound of response.h.
constexpr double kRounding = 1e-13;

/// A law that is broken is broken by this much of Tc on some of the histories.
constexpr double kBroken = 1e-3;

struct Exception {
  std::string_view law;
  std::string_view model;
  std::string_view reason;
};

constexpr Exception kExceptions[] = {
    {"Masing", "dahl", "eq. 10 restarts with the slope (1 + T*/Tc)^alpha, not with the virgin one"},
    {"return-point memory", "dahl", "its only memory is the present force"},
    {"closed loops repeat", "dahl", "it creeps towards a steady loop over many cycles"},
};

const Exception* FindException(std::string_view law, std::string_view model) {
  const auto* found = std::ranges::find_if(
      kExceptions, [&](const Exception& e) { return e.law == law && e.model == model; });
  return found == std::end(kExceptions) ? nullptr : found;
}

class EveryModel : public ::testing::TestWithParam<FrictionModel> {
 protected:
  [[nodiscard]] const FrictionModel& model() const { return GetParam(); }

  /// σ = Tc = 1, so that displacements are in elastic limits and forces in Tc; α of the model or
  /// one of the typical ones.
  BranchLaw DrawLaw(Generator& generator) const {
    constexpr double kShapeExponents[] = {0.0, 0.1, 1.0 / 3.0, 0.5, 0.9, 1.0, 1.5, 2.0, 4.0};
    const double drawn = kShapeExponents[generator() % std::size(kShapeExponents)];
    return {1.0, model().shape_exponent.value_or(drawn), 1.0};
  }

  /// `violation` [Tc] of the law over so many random histories: within rounding for a model that
  /// has it, beyond kBroken for one that is listed to lack it.
  template <typename Violation>
  void Check(std::string_view law, std::uint64_t seed, int histories, Violation violation) {
    Generator generator(seed);
    double worst = 0.0;
    for (int i = 0; i < histories; ++i) worst = std::max(worst, violation(generator));
    if (const Exception* exception = FindException(law, model().name)) {
      EXPECT_GT(worst, kBroken) << model().name << " is listed to break '" << law << "' ("
                                << exception->reason << ") but does not";
    } else {
      EXPECT_LE(worst, kRounding) << model().name << " breaks '" << law << "'";
    }
  }
};

double LargestDifference(const std::vector<double>& a, const std::vector<double>& b) {
  double largest = a.size() == b.size() ? 0.0 : std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
    largest = std::max(largest, std::abs(a[i] - b[i]));
  }
  return largest;
}

/// ∮T dδ from sample `begin` to `end` of the path, which starts and ends at one displacement, on a
/// refined history.
double Work(const History& history, const std::vector<double>& force, std::size_t begin,
            std::size_t end) {
  double work = 0.0;
  for (std::size_t i = begin + 1; i <= end; ++i) {
    work += 0.5 * (force[i] + force[i - 1]) * (history[i] - history[i - 1]);
  }
  return work;
}

History Refined(const History& corners, std::size_t steps) {
  History history = {corners.front()};
  for (std::size_t i = 1; i < corners.size(); ++i) {
    const double from = corners[i - 1];
    for (std::size_t k = 1; k < steps; ++k) {
      const double share = static_cast<double>(k) / static_cast<double>(steps);
      history.push_back(from + share * (corners[i] - from));
    }
    history.push_back(corners[i]);
  }
  return history;
}

TEST_P(EveryModel, IsOdd) {
  Check("odd", 101, 3000, [&](Generator& generator) {
    const BranchLaw law = DrawLaw(generator);
    History history = RandomHistory(generator);
    std::vector<double> force = Respond(model(), law, history);
    for (double& displacement : history) displacement = -displacement;
    for (double& value : force) value = -value;
    // Bit for bit: nothing in the evaluation knows a sense.
    return Respond(model(), law, history) == force ? 0.0 : 1.0;
  });
}

/// Forgets its loading on inner loops at one end of the range, then sweeps to the other end.
History OneSidedHistory(Generator& generator) {
  const double size = testing::LogUniform(generator, 0.1, 2.0);
  History history = {-size};
  for (int i = 0; i < 40; ++i) history.push_back(Uniform(generator, -size, -size / 2));
  history.insert(history.end(), {-size, size});
  return history;
}

TEST_P(EveryModel, StaysWithinTheSlipForce) {
  Check("bounded", 102, 3000, [&](Generator& generator) {
    double excess = 0.0;
    const BranchLaw law = DrawLaw(generator);
    const History history =
        generator() % 2 == 0 ? RandomHistory(generator) : OneSidedHistory(generator);
    for (const double force : Respond(model(), law, history)) {
      excess = std::max(excess, std::abs(force) - 1);
    }
    // Not by an ulp: 1 − T/Tc is the base of powers.
    return excess > 0 ? 1.0 : 0.0;
  });
}

TEST_P(EveryModel, DoesNotDependOnRate) {
  // Samples repeated at random are a change of speed, dwells included.
  Check("rate independence", 103, 3000, [&](Generator& generator) {
    const BranchLaw law = DrawLaw(generator);
    const History history = RandomHistory(generator);
    const std::vector<double> force = Respond(model(), law, history);
    History slower;
    std::vector<double> expected;
    for (std::size_t i = 0; i < history.size(); ++i) {
      const std::size_t repeats = 1 + generator() % 3;
      slower.insert(slower.end(), repeats, history[i]);
      expected.insert(expected.end(), repeats, force[i]);
    }
    return Respond(model(), law, slower) == expected ? 0.0 : 1.0;
  });
}

TEST_P(EveryModel, DoesNotDependOnTheSteps) {
  // Points inserted on monotone pieces change nothing at the old ones.
  Check("step splitting", 104, 3000, [&](Generator& generator) {
    const BranchLaw law = DrawLaw(generator);
    const History history = RandomHistory(generator);
    History finer;
    std::vector<std::size_t> kept;
    double previous = 0.0;
    for (const double displacement : history) {
      History between;
      for (std::size_t k = generator() % 4; k > 0; --k) {
        between.push_back(previous + Uniform(generator, 0.0, 1.0) * (displacement - previous));
      }
      std::ranges::sort(between);
      if (displacement < previous) std::ranges::reverse(between);
      finer.insert(finer.end(), between.begin(), between.end());
      kept.push_back(finer.size());
      finer.push_back(previous = displacement);
    }
    const std::vector<double> all = Respond(model(), law, finer);
    std::vector<double> at_kept;
    for (const std::size_t i : kept) at_kept.push_back(all[i]);
    return LargestDifference(Respond(model(), law, history), at_kept);
  });
}

TEST_P(EveryModel, DoesNotForeseeTheFuture) {
  // Only Simplified-Dahl refers to the amplitude of what is still to come; the same is given to
  // both.
  Check("causality", 105, 1000, [&](Generator& generator) {
    const BranchLaw law = DrawLaw(generator);
    History history = RandomHistory(generator);
    const auto [lowest, highest] = std::ranges::minmax(history);
    history.insert(history.begin(), {lowest, highest});
    const std::size_t cut = 2 + generator() % (history.size() - 2);
    const History shorter(history.begin(), history.begin() + static_cast<std::ptrdiff_t>(cut) + 1);
    std::vector<double> force = Respond(model(), law, history);
    force.resize(cut + 1);
    return LargestDifference(Respond(model(), law, shorter), force);
  });
}

TEST_P(EveryModel, DissipatesOnClosedCycles) {
  // A closed path through random corners, run until the force closes too; its last round is
  // refined. The trapezoidal rule in 64 steps errs by about 1/64² of the path's length times the
  // force.
  constexpr std::size_t kSteps = 64;
  constexpr int kRounds = 400;
  constexpr double kTrapezoidal = 1e-3;
  constexpr double kClosed = 1e-6;  // of Tc
  int closed = 0;
  Check("dissipation", 106, 500, [&](Generator& generator) {
    const BranchLaw law = DrawLaw(generator);
    const std::size_t corners = 2 + generator() % 6;
    History once =
        testing::WhiteSequence(generator, corners, testing::LogUniform(generator, 0.1, 4));
    History history;
    for (int round = 0; round < kRounds; ++round) {
      history.insert(history.end(), once.begin(), once.end());
    }
    const std::size_t begin = history.size();
    once.push_back(once.front());
    const History last = Refined(once, kSteps);
    history.insert(history.end(), last.begin(), last.end());
    const std::vector<double> force = Respond(model(), law, history);
    if (std::abs(force.back() - force[begin]) > kClosed) return 0.0;
    ++closed;
    double length = 0.0;
    double largest = 0.0;
    for (std::size_t i = begin + 1; i < history.size(); ++i) {
      length += std::abs(history[i] - history[i - 1]);
      largest = std::max(largest, std::abs(force[i]));
    }
    const double work = Work(history, force, begin, history.size() - 1);
    return std::max(-work / (length * largest) - kTrapezoidal, 0.0);
  });
  EXPECT_GT(closed, 250) << "too few paths close in force to say anything";
}

TEST_P(EveryModel, ObeysMasing) {
  // From the first extreme X the way back is the virgin curve twice as large.
  Check("Masing", 107, 3000, [&](Generator& generator) {
    const BranchLaw law = DrawLaw(generator);
    if (law.shape_exponent == 0) return 0.0;  // Dahl's law too is Jenkins' there
    const double extreme = Uniform(generator, -3.0, 3.0);
    const double back = Uniform(generator, 0.0, 2.0) * extreme;
    const std::vector<double> force = Respond(model(), law, History{extreme, extreme - back});
    const std::vector<double> half = Respond(model(), law, History{back / 2});
    return std::abs(force[1] - (force[0] - 2 * half[0]));
  });
}

TEST_P(EveryModel, RemembersReturnPoints) {
  // An excursion from a branch and back to it leaves the rest of the history as it was.
  Check("return-point memory", 108, 3000, [&](Generator& generator) {
    const BranchLaw law = DrawLaw(generator);
    if (law.shape_exponent == 0) return 0.0;
    const History history = RandomHistory(generator);
    const std::size_t at = 1 + generator() % (history.size() - 1);
    if (history[at] == history[at - 1]) return 0.0;
    // Back by less than the last piece, so that nothing older is passed.
    const double back = Uniform(generator, 0.0, 0.999) * (history[at - 1] - history[at]);
    History excursion = history;
    excursion.insert(excursion.begin() + static_cast<std::ptrdiff_t>(at) + 1,
                     {history[at] + back, history[at]});
    std::vector<double> force = Respond(model(), law, excursion);
    force.erase(force.begin() + static_cast<std::ptrdiff_t>(at) + 1,
                force.begin() + static_cast<std::ptrdiff_t>(at) + 3);
    return LargestDifference(Respond(model(), law, history), force);
  });
}

TEST_P(EveryModel, RepeatsClosedLoops) {
  // Between limits that include the way there, every cycle is the first one over again.
  Check("closed loops repeat", 109, 1000, [&](Generator& generator) {
    const BranchLaw law = DrawLaw(generator);
    if (law.shape_exponent == 0) return 0.0;
    History once = RandomHistory(generator);
    const double extreme = 1.001 * std::max(std::abs(*std::ranges::min_element(once)),
                                            std::abs(*std::ranges::max_element(once)));
    once.insert(once.begin(), extreme);
    History twice = once;
    twice.insert(twice.end(), once.begin(), once.end());
    const std::vector<double> force = Respond(model(), law, twice);
    const auto middle = force.begin() + static_cast<std::ptrdiff_t>(once.size());
    return LargestDifference({force.begin(), middle}, {middle, force.end()});
  });
}

TEST_P(EveryModel, DoesNotDriftOverManyCycles) {
  // Steady from the start, off centre: the thousandth cycle is the second to the last digit or two.
  Check("no drift", 110, 30, [&](Generator& generator) {
    const BranchLaw law = DrawLaw(generator);
    const double extreme = testing::LogUniform(generator, 0.05, 4.0);
    const double centre = Uniform(generator, -2.0, 2.0);
    History history;
    for (int i = 0; i < 1000; ++i) {
      for (const double x : {1.0, 0.3, -1.0, 0.1}) history.push_back(centre + x * extreme);
    }
    const std::vector<double> force =
        Respond(model(), law, history, {.state = InitialState::kSteady});
    return LargestDifference({force.begin() + 4, force.begin() + 8},
                             {force.end() - 4, force.end()});
  });
}

TEST_P(EveryModel, IsInvariantUnderUnits) {
  // Powers of two change no digit: of length, of force, and of both.
  Check("unit invariance", 111, 3000, [&](Generator& generator) {
    const BranchLaw law = {Uniform(generator, 0.5, 2.0), DrawLaw(generator).shape_exponent,
                           Uniform(generator, 0.5, 2.0)};
    History history = RandomHistory(generator);
    std::vector<double> force = Respond(model(), law, history);
    const double length = std::ldexp(1.0, static_cast<int>(generator() % 81) - 40);
    const double newton = std::ldexp(1.0, static_cast<int>(generator() % 81) - 40);
    for (double& displacement : history) displacement *= length;
    for (double& value : force) value *= newton;
    const BranchLaw scaled = {law.tangential_stiffness * newton / length, law.shape_exponent,
                              law.slip_force * newton};
    return Respond(model(), scaled, history) == force ? 0.0 : 1.0;
  });
}

TEST_P(EveryModel, HasSteadyLoopsInAnyUnits) {
  // T* and W of a loop, bit for bit, over most of the range of double.
  Generator generator(114);
  for (int i = 0; i < 3000; ++i) {
    const BranchLaw law = {Uniform(generator, 0.5, 2.0), DrawLaw(generator).shape_exponent,
                           Uniform(generator, 0.5, 2.0)};
    const double amplitude = testing::LogUniform(generator, 1e-3, 1e3);
    const double length = std::ldexp(1.0, static_cast<int>(generator() % 401) - 200);
    const double newton = std::ldexp(1.0, static_cast<int>(generator() % 401) - 200);
    const BranchLaw scaled = {law.tangential_stiffness * newton / length, law.shape_exponent,
                              law.slip_force * newton};
    ASSERT_EQ(SteadyPeakForce(model(), scaled, amplitude * length),
              SteadyPeakForce(model(), law, amplitude) * newton);
    ASSERT_EQ(SteadyLoopEnergy(model(), scaled, amplitude * length),
              SteadyLoopEnergy(model(), law, amplitude) * newton * length);
  }
}

TEST_P(EveryModel, ShiftsWithTheUnloadedDisplacement) {
  // Shifts that are exact: multiples of 2⁻²⁰.
  Check("translation", 112, 1000, [&](Generator& generator) {
    const BranchLaw law = DrawLaw(generator);
    History history = RandomHistory(generator);
    for (double& displacement : history) displacement = std::round(displacement * 0x1p20) * 0x1p-20;
    const std::vector<double> force = Respond(model(), law, history);
    const double shift = std::round(Uniform(generator, -100.0, 100.0));
    for (double& displacement : history) displacement += shift;
    const std::vector<double> shifted =
        Respond(model(), law, history, {.unloaded_displacement = shift});
    return LargestDifference(force, shifted);
  });
}

TEST_P(EveryModel, ForceNeverDecreasesAlongItsDirection) {
  // Rises with displacement on a monotone piece, no steeper than the steepest start of a branch.
  Check("monotone", 113, 1000, [&](Generator& generator) {
    const BranchLaw law = DrawLaw(generator);
    const History history = Refined(RandomHistory(generator), 5);
    const std::vector<double> force = Respond(model(), law, history);
    double worst = 0.0;
    for (std::size_t i = 1; i < history.size(); ++i) {
      const double step = history[i] - history[i - 1];
      const double rise = (force[i] - force[i - 1]) * (step < 0 ? -1 : 1);
      worst = std::max(worst, -rise);
    }
    return worst;
  });
}

std::string NameOf(const ::testing::TestParamInfo<FrictionModel>& info) {
  std::string name(info.param.name);
  std::ranges::replace(name, '-', '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(Laws, EveryModel,
                         ::testing::ValuesIn(FrictionModels().begin(), FrictionModels().end()),
                         NameOf);

}  // namespace

void PrintTo(const FrictionModel& model, std::ostream* out) { *out << model.name; }

}  // namespace mindahl::models::laws_test
