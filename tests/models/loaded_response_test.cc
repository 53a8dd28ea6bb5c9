#include "models/loaded_response.h"

#include "../support/histories.h"
#include "support/prelude.h"
#include "support/variable_load.h"

namespace mindahl::models::loaded_response_test {
namespace {

constexpr double kTwoPi = 2 * std::numbers::pi;
constexpr std::array kShapeExponents = {0.0, 0.1, 1.0 / 3, 0.5, 0.7, 0.95};

/// δ = λ·δc·sin, N = 1 + swing·sin at some multiple of the frequency.
struct Test {
  double shape_exponent = 1.0 / 3;
  double lambda = 1.2;
  double swing = 0.3;
  double multiple = 2.0;
  double cycles = 3.0;
  int samples_per_cycle = 97;  // odd: no sample of one stroke repeats another's
};

struct Path {
  History displacement;
  History load;
};

constexpr double kRate = 2.5;  // κ

Path PathOf(const Test& test) {
  const double slip = 1 / (kRate * (1 - test.shape_exponent));
  Path path;
  const int last = static_cast<int>(std::lround(test.cycles * test.samples_per_cycle));
  for (int i = 0; i <= last; ++i) {
    const double phase = kTwoPi * i / test.samples_per_cycle;
    path.displacement.push_back(test.lambda * slip * std::sin(phase));
    path.load.push_back(1 + test.swing * std::sin(test.multiple * phase + 0.4));
  }
  return path;
}

LoadedHistory HistoryOf(const Path& path, InitialState state = InitialState::kVirgin) {
  return MakeLoadedHistory(path.displacement, path.load,
                           loop::FindReversals(path.displacement, 0.0), state);
}

History Evaluate(const NormalizedLaw& law, const LoadedHistory& history, double unloaded = 0.0) {
  History t(history.displacement.size());
  EvaluateNormalizedForce(law, history, unloaded, t);
  return t;
}

TEST(EvaluateNormalizedForceUnderLoad, IsTheForceUnderLoadOverTheSlipForce) {
  // 8 ε·(σ·max|δ| + Tc/(1−α)) each, and as much of powers by way of logarithms;
  // σ·max|δ| <= 5, loads <= 3, 1/(1−α) <= 20 here.
  constexpr double kRounding = 2 * 8 * 2.3e-16 * (5 * 3 + 3 * 20);
  Generator generator(3);
  for (const double alpha : kShapeExponents) {
    for (int i = 0; i < 200; ++i) {
      Path path{testing::RandomHistory(generator), {}};
      for (double& displacement : path.displacement) {
        displacement = std::clamp(displacement, -5.0, 5.0);
        const bool lifts_off = i % 3 == 0 && generator() % 10 == 0;
        path.load.push_back(lifts_off ? 0.0 : LogUniform(generator, 0.3, 3.0));
      }
      const LoadDependentLaw law{.friction_coefficient = 1.0,
                                 .reference_load = 1.0,
                                 .reference_stiffness = 1.0,
                                 .shape_exponent = alpha};
      History expected(path.load.size());
      EvaluateForceUnderLoad(law, path.displacement, path.load, expected);
      const History t = Evaluate({.rate = 1.0, .shape_exponent = alpha}, HistoryOf(path));
      for (std::size_t k = 0; k < t.size(); ++k) {
        ASSERT_NEAR(t[k], expected[k], kRounding) << "alpha " << alpha << ", path " << i;
      }
    }
  }
}

/// Central differences at steps h and 2h, extrapolated: of fourth order where t is smooth.
template <typename Function>
History Differences(Function function, double h) {
  const History above = function(h);
  const History below = function(-h);
  const History far_above = function(2 * h);
  const History far_below = function(-2 * h);
  History result;
  for (std::size_t k = 0; k < above.size(); ++k) {
    const double near = (above[k] - below[k]) / (2 * h);
    const double far = (far_above[k] - far_below[k]) / (4 * h);
    result.push_back(near + (near - far) / 3);
  }
  return result;
}

TEST(EvaluateNormalizedForceUnderLoad, HasTheDerivativesOfItsDifferences) {
  // ε/h = 1e-12 of rounding; a sample that a zone's edge or complete slip passes within 2h of the
  // point has a derivative that jumps, or for α < 1/2 one that bends as √h: a handful of samples.
  constexpr double kStep = 1e-4;
  constexpr double kSmooth = 1e-7;
  constexpr double kBent = 0.1;
  constexpr double kFewBent = 0.03;
  for (const double alpha : {0.2, 1.0 / 3, 0.5, 0.7, 0.9}) {
    for (const double lambda : {0.6, 1.5}) {
      for (const double swing : {0.0, 0.05, 0.6}) {
        const Path path = PathOf({.shape_exponent = alpha, .lambda = lambda, .swing = swing});
        const LoadedHistory history = HistoryOf(path);
        const double unloaded = 0.03;
        const auto at = [&](double log_rate, double shape, double place) {
          return Evaluate({.rate = kRate * std::exp(log_rate), .shape_exponent = alpha + shape},
                          history, unloaded + place);
        };
        const std::size_t samples = path.load.size();
        History t(samples);
        std::array<History, 3> columns;
        for (History& column : columns) column.resize(samples);
        EvaluateNormalizedForce({.rate = kRate, .shape_exponent = alpha}, history, unloaded, t,
                                {columns[0], columns[1], columns[2]});
        EXPECT_EQ(t.size(), samples);
        const std::array<History, 3> expected = {
            Differences([&](double h) { return at(h, 0, 0); }, kStep),
            Differences([&](double h) { return at(0, h, 0); }, kStep),
            Differences([&](double h) { return at(0, 0, h); }, kStep)};
        for (std::size_t c = 0; c < columns.size(); ++c) {
          std::size_t bent = 0;
          for (std::size_t k = 0; k < samples; ++k) {
            const double error = std::abs(columns[c][k] - expected[c][k]);
            ASSERT_LT(error, kBent) << "alpha " << alpha << ", lambda " << lambda << ", swing "
                                    << swing << ", column " << c << ", sample " << k;
            if (error > kSmooth) ++bent;
          }
          EXPECT_LT(static_cast<double>(bent), kFewBent * static_cast<double>(samples))
              << "alpha " << alpha << ", lambda " << lambda << ", swing " << swing << ", column "
              << c;
        }
      }
    }
  }
}

TEST(LoadedHistory, OfASteadyContactIsThatOfOneThatHasCycledForLong) {
  // The law repeats itself from the second cycle on, exactly; the jump from the extremes into the
  // first cycle leaves nothing where that cycle reaches them.
  constexpr double kRounding = 1e-12;
  for (const double lambda : {0.6, 1.3}) {
    for (const double swing : {0.05, 0.3}) {
      for (const double cut : {0.1, 0.4, 0.9}) {  // where in a cycle the record starts
        constexpr int kCycle = 96;
        const Path whole =
            PathOf({.lambda = lambda, .swing = swing, .cycles = 8.0, .samples_per_cycle = kCycle});
        const History expected = Evaluate({.rate = kRate}, HistoryOf(whole));
        const auto begin = static_cast<std::ptrdiff_t>((4 + cut) * kCycle);
        const Path seen{{whole.displacement.begin() + begin, whole.displacement.end()},
                        {whole.load.begin() + begin, whole.load.end()}};
        const History t = Evaluate({.rate = kRate}, HistoryOf(seen, InitialState::kSteady));
        for (std::size_t k = 0; k < t.size(); ++k) {
          ASSERT_NEAR(t[k], expected[k + static_cast<std::size_t>(begin)], kRounding)
              << "lambda " << lambda << ", swing " << swing << ", cut " << cut << ", sample " << k;
        }
        // It turns twice in a cycle and a tenth.
        constexpr std::ptrdiff_t kShort = 11 * kCycle / 10;
        const Path turning_twice{{seen.displacement.begin(), seen.displacement.begin() + kShort},
                                 {seen.load.begin(), seen.load.begin() + kShort}};
        const History of_short =
            Evaluate({.rate = kRate}, HistoryOf(turning_twice, InitialState::kSteady));
        for (std::size_t k = 0; k < of_short.size(); ++k) ASSERT_NEAR(of_short[k], t[k], kRounding);
      }
    }
  }
}

TEST(EvaluateNormalizedForceUnderLoad, RefusesWhatTheLawDoesNotModel) {
  const LoadedHistory history = HistoryOf(PathOf({}));
  History t(history.displacement.size());
  const auto message = [&](const NormalizedLaw& law) {
    return MessageOf([&] { EvaluateNormalizedForce(law, history, 0.0, t); });
  };
  EXPECT_THAT(message({.rate = 1.0, .shape_exponent = 1.0}), HasSubstr("must be < 1"));
  EXPECT_THAT(message({.rate = 1.0, .spring_travel = 0.1}), HasSubstr("must be 0"));
  t.pop_back();
  EXPECT_THAT(message({.rate = 1.0}), HasSubstr("response"));
  EXPECT_THROW(MakeLoadedHistory(History{0, 1}, History{1, -1}, {}, InitialState::kVirgin),
               InvalidArgument);
}

}  // namespace
}  // namespace mindahl::models::loaded_response_test
