#include "mindahl/convert/conversion.h"

#include <numeric>
#include <variant>

#include "mindahl/models/steady_loop.h"
#include "support/histories.h"
#include "support/prelude.h"

namespace mindahl::convert::conversion_test {
namespace {

using models::BranchLaw;

const ModelLaw kMindlin{&Model("mindlin-dahl"), {4e7, 1.0 / 3, 40.0}};
constexpr double kGrossSlip = 1.5e-6;  // 3Tc/(2σ) [m]
constexpr double kAmplitude = 0.8 * kGrossSlip;
/// A minimum's place is found to the root of a double's rounding, in three nested searches.
constexpr double kRefitted = 1e-5;

Conversion To(Target target, const ModelLaw& contact, ConversionOptions options = {}) {
  if (options.amplitude == 0) options.amplitude = kAmplitude;
  return Convert(contact, target, options);
}

/// Root mean square of the difference of force over the loop, over T*.
double RmsError(const SteadyLaw& law, const SteadyLaw& reference, double amplitude) {
  constexpr std::size_t kPlaces = 1025;
  std::vector<double> distance(kPlaces);
  for (std::size_t i = 0; i < kPlaces; ++i) {
    distance[i] = 2 * amplitude * (static_cast<double>(i) / (kPlaces - 1));
  }
  std::vector<double> force(kPlaces);
  std::vector<double> expected(kPlaces);
  EvaluateRisingBranch(law, amplitude, distance, force);
  EvaluateRisingBranch(reference, amplitude, distance, expected);
  double squares = 0.0;
  for (std::size_t i = 0; i < kPlaces; ++i) {
    squares += (force[i] - expected[i]) * (force[i] - expected[i]);
  }
  return std::sqrt(squares / kPlaces) / expected.back();
}

TEST(Conversion, BetweenMasingAndDahlIsExactAtTheAmplitude) {
  // Both sides' roundings, of some 16 ε each, over a T* near Tc and an energy of a fifth of 4XT*.
  constexpr double kRounding = 512 * std::numeric_limits<double>::epsilon();
  const Conversion dahl = To(Target::kDahl, kMindlin);
  EXPECT_LT(dahl.at_amplitude.force, kRounding);
  EXPECT_LT(std::abs(dahl.at_amplitude.energy), kRounding);
  const Conversion back = To(Target::kMasing, std::get<ModelLaw>(dahl.law));
  EXPECT_LT(back.at_amplitude.force, kRounding);
  const BranchLaw law = std::get<ModelLaw>(back.law).law;
  EXPECT_NEAR(law.tangential_stiffness / 4e7, 1.0, kRounding);
  EXPECT_NEAR(law.slip_force / 40.0, 1.0, kRounding);
  // Elsewhere it is not, and the range that is stated ends on either side.
  ASSERT_TRUE(dahl.within);
  EXPECT_GT(dahl.within->lower, 0.5 * kAmplitude);
  EXPECT_LT(dahl.within->lower, kAmplitude);
  EXPECT_GT(dahl.within->upper, kAmplitude);
}

TEST(Conversion, OfALawToItselfIsTheLaw) {
  const Conversion same = To(Target::kMasing, kMindlin);
  EXPECT_EQ(std::get<ModelLaw>(same.law).law.tangential_stiffness, 4e7);
  EXPECT_EQ(same.at_amplitude.force, 0.0);
  ASSERT_TRUE(same.within);
  EXPECT_NEAR(same.within->upper / kAmplitude, 1e4, 1.0);  // as far as is looked
}

TEST(Conversion, ToLuGreFindsDahlsExponentialWhereItIsOne) {
  const ModelLaw exponential{&Model("dahl"), {4e7, 1.0, 40.0}};
  const BranchLaw law = std::get<ModelLaw>(To(Target::kLuGre, exponential).law).law;
  EXPECT_NEAR(law.tangential_stiffness / 4e7, 1.0, kRefitted);
  EXPECT_NEAR(law.slip_force / 40.0, 1.0, kRefitted);
  EXPECT_EQ(law.shape_exponent, 1.0);
}

TEST(Conversion, ToBoucAndWenFindsDahlsExponentialAtABetaOfOne) {
  const ModelLaw exponential{&Model("dahl"), {4e7, 1.0, 40.0}};
  const auto law = std::get<BoucWenLaw>(To(Target::kBoucWen, exponential, {.beta = 1.0}).law);
  // n ends at its bound of 1, where the search for a minimum stops short of the end by 1e-8.
  EXPECT_NEAR(law.exponent, 1.0, 1e-4);
  EXPECT_NEAR(law.stiffness / 4e7, 1.0, 1e-4);
  EXPECT_NEAR(law.slip_force / 40.0, 1.0, 1e-4);
}

TEST(Conversion, ToASpringWithCoulombsLimitFindsItWhereItIsOne) {
  const ModelLaw jenkins{&Model("mindlin-dahl"), {4e7, 0.0, 40.0}};
  const Conversion lammps = To(Target::kLammps, jenkins, {.amplitude = 3e-6});
  EXPECT_NEAR(std::get<ModelLaw>(lammps.law).law.tangential_stiffness / 4e7, 1.0, kRefitted);
  EXPECT_NEAR(std::get<ModelLaw>(lammps.law).law.slip_force / 40.0, 1.0, kRefitted);
  const Conversion iwan = To(Target::kIwan, jenkins, {.amplitude = 3e-6});
  EXPECT_EQ(std::get<methods::IwanElements>(iwan.law).size(), 1U);
  EXPECT_LT(iwan.at_amplitude.force, 1e-14);
}

TEST(Conversion, ToCoulombsFrictionLosesTheEnergyOfTheLoopAndNoPresliding) {
  // A rectangle of height F differs by F + T* after a reversal; F of least squares is W/4X.
  constexpr double kElastic = 1e-12;  // ten times what a spring of 1e-13·X leaves
  const double energy = LoopEnergy(kMindlin, kAmplitude);
  const double peak = models::SteadyPeakForce(*kMindlin.model, kMindlin.law, kAmplitude);
  for (const Target target : {Target::kMujocoJoint, Target::kUrdf, Target::kSdf}) {
    const Conversion joint = To(target, kMindlin);
    const double friction = std::get<ModelLaw>(joint.law).law.slip_force;
    EXPECT_NEAR(friction, energy / (4 * kAmplitude), 1e-14 * friction);
    EXPECT_NEAR(joint.at_amplitude.energy, 0.0, kElastic);
    EXPECT_NEAR(joint.at_amplitude.force, (friction + peak) / peak, kElastic);
    // No other height is nearer in the mean square, by its own definition.
    for (const double factor : {0.9, 1.1}) {
      ModelLaw other = std::get<ModelLaw>(joint.law);
      other.law.slip_force *= factor;
      other.law.tangential_stiffness *= factor;
      EXPECT_GT(RmsError(other, kMindlin, kAmplitude), RmsError(joint.law, kMindlin, kAmplitude));
    }
  }
}

TEST(Conversion, ToCoulombsFrictionOverARangeIsTheLeastMeanSquareOfEachLoopOverItsPeak) {
  // A stroke's mean square difference is F² − 2F·W/4X and what does not depend on F; of one
  // amplitude and nine from end to end, each over its T*².
  const AmplitudeRange range{0.2 * kGrossSlip, 3 * kGrossSlip};
  const Conversion joint = To(Target::kUrdf, kMindlin, {.range = range});
  double mean = 0.0;
  double weights = 0.0;
  const auto add = [&](double amplitude) {
    const double peak = models::SteadyPeakForce(*kMindlin.model, kMindlin.law, amplitude);
    mean += LoopEnergy(kMindlin, amplitude) / (4 * amplitude) / (peak * peak);
    weights += 1 / (peak * peak);
  };
  add(kAmplitude);
  for (int i = 0; i <= 8; ++i) add(range.lower * std::pow(range.upper / range.lower, i / 8.0));
  const double friction = std::get<ModelLaw>(joint.law).law.slip_force;
  EXPECT_NEAR(friction, mean / weights, 1e-12 * friction);
}

TEST(Conversion, LargestErrorsIncludeThoseAtTheEndsOfTheRange) {
  const AmplitudeRange range{0.3 * kGrossSlip, 3 * kGrossSlip};
  for (const Target target : {Target::kLuGre, Target::kLammps, Target::kUrdf}) {
    const Conversion conversion = To(target, kMindlin, {.range = range});
    for (const double amplitude : {range.lower, range.upper}) {
      const LoopError error = CompareLoops(conversion.law, kMindlin, amplitude);
      constexpr double kRounding = 1e-9;  // of the amplitude, by its logarithm
      EXPECT_GE(conversion.largest.force, error.force - kRounding);
      EXPECT_GE(conversion.largest.energy, std::abs(error.energy) - kRounding);
    }
  }
}

TEST(Conversion, IsRefittedToTheLeastMeanSquareError) {
  // No parameter can be moved to a smaller error, and 3 % make it larger.
  constexpr double kMove = 1.03;
  for (const Target target : {Target::kLuGre, Target::kLammps}) {
    const SteadyLaw best = To(target, kMindlin).law;
    const double least = RmsError(best, kMindlin, kAmplitude);
    for (const double factor : {kMove, 1 / kMove}) {
      ModelLaw stiffer = std::get<ModelLaw>(best);
      stiffer.law.tangential_stiffness *= factor;
      ModelLaw stronger = std::get<ModelLaw>(best);
      stronger.law.slip_force *= factor;
      EXPECT_GT(RmsError(stiffer, kMindlin, kAmplitude), least);
      EXPECT_GT(RmsError(stronger, kMindlin, kAmplitude), least);
    }
  }
  const auto best = std::get<BoucWenLaw>(To(Target::kBoucWen, kMindlin).law);
  const double least = RmsError(best, kMindlin, kAmplitude);
  for (const double factor : {kMove, 1 / kMove}) {
    BoucWenLaw other = best;
    other.stiffness *= factor;
    EXPECT_GT(RmsError(other, kMindlin, kAmplitude), least);
    other = best;
    other.slip_force *= factor;
    EXPECT_GT(RmsError(other, kMindlin, kAmplitude), least);
    other = best;
    other.exponent = std::max(other.exponent * factor, 1.0);
    EXPECT_GE(RmsError(other, kMindlin, kAmplitude), least);
  }
}

TEST(Conversion, OverARangeIsAsGoodAsMayBeOnTheWholeOfIt) {
  const AmplitudeRange range{0.3 * kGrossSlip, 3 * kGrossSlip};
  for (const Target target : {Target::kLuGre, Target::kBoucWen, Target::kLammps}) {
    const Conversion at_one = To(target, kMindlin);
    const Conversion over_all = To(target, kMindlin, {.range = range});
    double at_ends = 0.0;
    double over_ends = 0.0;
    for (const double amplitude : {range.lower, range.upper}) {
      at_ends += RmsError(at_one.law, kMindlin, amplitude);
      over_ends += RmsError(over_all.law, kMindlin, amplitude);
    }
    EXPECT_LT(over_ends, at_ends);
    EXPECT_GE(over_all.largest.force, over_all.at_amplitude.force);
    EXPECT_GT(RmsError(over_all.law, kMindlin, kAmplitude),
              RmsError(at_one.law, kMindlin, kAmplitude));
  }
}

TEST(Conversion, SaysWhereForceAndEnergyAreWithinTheTolerance) {
  constexpr double kTolerance = 0.05;
  const double amplitude = 1.1 * kGrossSlip;
  const Conversion iwan = To(Target::kIwan, kMindlin,
                             {.amplitude = amplitude, .tolerance = kTolerance, .elements = 12});
  ASSERT_TRUE(iwan.within);
  for (const double end : {iwan.within->lower, iwan.within->upper}) {
    const LoopError inside = CompareLoops(iwan.law, kMindlin, end);
    EXPECT_LE(std::max(inside.force, std::abs(inside.energy)), kTolerance);
  }
  // Next to the lower end either is not; elements of gross slip are as good at any amplitude.
  const LoopError outside = CompareLoops(iwan.law, kMindlin, 0.999 * iwan.within->lower);
  EXPECT_GT(std::max(outside.force, std::abs(outside.energy)), kTolerance);
  EXPECT_NEAR(iwan.within->upper / amplitude, 1e4, 1.0);
  // One element is not within 1 % of Mindlin's loop.
  EXPECT_FALSE(To(Target::kIwan, kMindlin, {.tolerance = 0.01, .elements = 1}).within);
}

TEST(Conversion, ToMoreElementsIsBetter) {
  double last = 1.0;
  for (const std::size_t elements : {1, 2, 4, 8, 16}) {
    const Conversion iwan = To(Target::kIwan, kMindlin, {.elements = elements});
    EXPECT_LT(iwan.at_amplitude.force, last);
    last = iwan.at_amplitude.force;
    const auto& made = std::get<methods::IwanElements>(iwan.law);
    EXPECT_EQ(made.size(), elements);
    // One that sticks has what the others leave of the slip force: sums of 16 roundings.
    if (elements > 1) {
      EXPECT_NEAR(std::accumulate(made.slip_force.begin(), made.slip_force.end(), 0.0), 40.0,
                  1e-12);
    }
  }
}

TEST(Conversion, ToElementsIsNeverWorseThanTheTangents) {
  // What even places here and the middles of cells there make of one mean square.
  constexpr double kPlaces = 1.02;
  for (const double alpha : {0.05, 1.0 / 3, 1.0, 2.5}) {
    const ModelLaw contact{&Model("mindlin-dahl"), {4e7, alpha, 40.0}};
    for (const double amplitude : {1e-8, 1.2e-6, 1.5e-6, 4e-6}) {
      for (const std::size_t elements : {1, 2, 5, 16}) {
        for (const bool over_a_range : {false, true}) {
          ConversionOptions options{.amplitude = amplitude, .elements = elements};
          if (over_a_range) options.range = AmplitudeRange{0.3 * amplitude, amplitude};
          const Conversion iwan = Convert(contact, Target::kIwan, options);
          const auto tangents =
              methods::MakeIwanElements(contact.law, elements, methods::IwanSpacing::kOptimal);
          std::vector<double> amplitudes = {amplitude};
          for (int i = 0; over_a_range && i <= 8; ++i) {
            amplitudes.push_back(amplitude * std::pow(0.3, 1 - i / 8.0));
          }
          double squares = 0.0;
          double of_tangents = 0.0;
          double largest = 0.0;
          for (const double each : amplitudes) {
            squares += std::pow(RmsError(iwan.law, contact, each), 2);
            of_tangents += std::pow(RmsError(tangents, contact, each), 2);
            largest = std::max(largest, CompareLoops(tangents, contact, each).force);
          }
          EXPECT_LE(squares, kPlaces * of_tangents) << alpha << ' ' << amplitude << ' ' << elements;
          EXPECT_LE(iwan.largest.force, largest * (1 + 1e-12))
              << alpha << ' ' << amplitude << ' ' << elements;
        }
      }
    }
  }
}

TEST(Conversion, ToElementsIsAsGoodAsStraightLinesCanBe) {
  // n straight lines nearest to f leave (∫|f''|^{2/5}dx)^{5/2}/(√720·n²), root of the integral of
  // squares; a loop's difference is twice that. f'' = −(3/4)·Tc/δc²·(1 − x/δc)^{−1/2}.
  const double to_slip = std::pow(1.25, 2.5) * 0.75;
  // The next order: beside slip, where f'' has no bound, the last lines are not short.
  constexpr double kNextOrder = 0.06;
  for (const double slips : {1.0, 3.0}) {
    double last = 0.0;
    for (const std::size_t elements : {16, 32, 64, 128}) {  // the last are placed, not searched
      const double amplitude = slips * kGrossSlip;
      const Conversion iwan =
          To(Target::kIwan, kMindlin, {.amplitude = amplitude, .elements = elements});
      const double error = RmsError(iwan.law, kMindlin, amplitude);
      const auto n = static_cast<double>(elements);
      const double best = 2 * to_slip / std::sqrt(720 * slips) / (n * n);
      EXPECT_NEAR(error / best, 1.0, kNextOrder) << slips << ' ' << elements;
      if (last > 0) {
        EXPECT_NEAR(last / error, 4.0, 4 * kNextOrder) << slips << ' ' << elements;
      }
      last = error;
    }
  }
}

TEST(Conversion, ToElementsOverARangeIsBetterThanAtOneAmplitude) {
  const AmplitudeRange range{0.1 * kGrossSlip, 3 * kGrossSlip};
  for (const std::size_t elements : {2, 6, 20}) {
    const Conversion at_one = To(Target::kIwan, kMindlin, {.elements = elements});
    const Conversion over_all = To(Target::kIwan, kMindlin, {.range = range, .elements = elements});
    double squares_of_one = 0.0;
    double squares = 0.0;
    for (int i = 0; i <= 8; ++i) {
      const double amplitude = range.lower * std::pow(range.upper / range.lower, i / 8.0);
      squares_of_one += std::pow(RmsError(at_one.law, kMindlin, amplitude), 2);
      squares += std::pow(RmsError(over_all.law, kMindlin, amplitude), 2);
    }
    EXPECT_LT(squares, squares_of_one);
    // Where the contact slides they hold its slip force, but for the error that is stated.
    const auto& made = std::get<methods::IwanElements>(over_all.law);
    EXPECT_NEAR(std::accumulate(made.slip_force.begin(), made.slip_force.end(), 0.0) / 40.0, 1.0,
                over_all.largest.force);
  }
}

TEST(Conversion, ToOneElementIsToTheSpringWithCoulombsLimit) {
  // Even places there, fine cells here: the mean square to 1e-4 of the loop's, and a minimum's
  // place to the root of that.
  constexpr double kPlaces = 0.01;
  const auto spring = std::get<ModelLaw>(To(Target::kLammps, kMindlin).law).law;
  const auto element =
      std::get<methods::IwanElements>(To(Target::kIwan, kMindlin, {.elements = 1}).law);
  EXPECT_NEAR(element.stiffness[0] / spring.tangential_stiffness, 1.0, kPlaces);
  EXPECT_NEAR(element.slip_force[0] / spring.slip_force, 1.0, kPlaces);
}

TEST(Conversion, OfDahlsOwnLawToElementsFollowsItsLoopsOverARange) {
  const ModelLaw dahl{&Model("dahl"), {4e7, 1.0 / 3, 40.0}};
  const AmplitudeRange range{0.5 * kAmplitude, 2 * kAmplitude};
  const Conversion at_one = To(Target::kIwan, dahl, {.elements = 6});
  const Conversion over_all = To(Target::kIwan, dahl, {.range = range, .elements = 6});
  double at_ends = 0.0;
  double over_ends = 0.0;
  for (const double amplitude : {range.lower, range.upper}) {
    at_ends += RmsError(at_one.law, dahl, amplitude);
    over_ends += RmsError(over_all.law, dahl, amplitude);
  }
  EXPECT_LT(over_ends, at_ends);
}

TEST(Conversion, RefusesOptionsThatBreakARule) {
  EXPECT_THROW(Convert({nullptr, kMindlin.law}, Target::kDahl, {.amplitude = 1.0}),
               InvalidArgument);
  EXPECT_THROW(
      Convert({&Model("simplified-dahl"), kMindlin.law}, Target::kDahl, {.amplitude = 1.0}),
      InvalidArgument);
  EXPECT_THROW(Convert(kMindlin, Target::kDahl, {.amplitude = 0.0}), InvalidArgument);
  EXPECT_THROW(Convert(kMindlin, Target::kDahl, {.amplitude = 1e-6, .tolerance = 1.0}),
               InvalidArgument);
  EXPECT_THROW(Convert(kMindlin, Target::kIwan, {.amplitude = 1e-6, .elements = 0}),
               InvalidArgument);
  EXPECT_THROW(Convert(kMindlin, Target::kBoucWen, {.amplitude = 1e-6, .beta = 1.5}),
               InvalidArgument);
  EXPECT_THROW(
      Convert(kMindlin, Target::kLuGre, {.amplitude = 1e-6, .range = AmplitudeRange{2e-6, 3e-6}}),
      InvalidArgument);
}

}  // namespace
}  // namespace mindahl::convert::conversion_test
