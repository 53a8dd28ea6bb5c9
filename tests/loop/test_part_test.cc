#include "mindahl/loop/segments.h"
#include "mindahl/models/friction_model.h"
#include "support/histories.h"
#include "support/prelude.h"

namespace mindahl::loop::test_part_test {
namespace {

constexpr std::size_t kCycle = 100;                    // samples
constexpr double kReach = 1e-3;                        // [m], 1.3 times gross slip
constexpr models::BranchLaw kLaw{8e4, 1.0 / 3, 40.0};  // δc = 0.75 mm
// The test begins and ends at a turning point, and the last stroke may be one with the travel that
// goes on in its direction: at most a cycle and a quarter of the sine are lost at an end.
constexpr std::size_t kLost = kCycle + kCycle / 4;

using OfCycle = std::function<double(double cycle)>;

/// A sine from zero, its amplitude [of kReach] going with the cycles.
std::vector<double> Sine(
    double cycles, const OfCycle& amplitude = [](double) { return 1.0; }) {
  std::vector<double> displacement;
  const auto samples = static_cast<std::size_t>(std::lround(cycles * static_cast<double>(kCycle)));
  for (std::size_t i = 0; i <= samples; ++i) {
    const double cycle = static_cast<double>(i) / static_cast<double>(kCycle);
    displacement.push_back(amplitude(cycle) * kReach * std::sin(2 * std::numbers::pi * cycle));
  }
  return displacement;
}

/// A straight way in so many samples, without its last place.
std::vector<double> Way(double from, double to, std::size_t samples) {
  std::vector<double> way;
  for (std::size_t i = 0; i < samples; ++i) {
    way.push_back(from + (to - from) * static_cast<double>(i) / static_cast<double>(samples));
  }
  return way;
}

std::vector<double> Joined(const std::vector<std::vector<double>>& parts) {
  std::vector<double> all;
  for (const std::vector<double>& part : parts) all.insert(all.end(), part.begin(), part.end());
  return all;
}

Record WithForce(std::vector<double> displacement) {
  Record record;
  record.displacement = std::move(displacement);
  record.force = testing::Respond(testing::Model("mindlin-dahl"), kLaw, record.displacement);
  return record;
}

bool IsWhole(const Record& record) {
  const TestPart test = FindTestPart(record);
  return test.before.empty() && test.after.empty() && test.first == 0 &&
         test.last == record.size() && !test.begins_cycled;
}

TEST(TestPart, IsTheWholeOfARecordOfOneTest) {
  for (const double cycles : {0.75, 1.25, 2.0, 5.0, 20.4}) {
    EXPECT_TRUE(IsWhole(WithForce(Sine(cycles)))) << cycles;
  }
  EXPECT_EQ(FindTestPart(Record()).last, 0U);
}

TEST(TestPart, KeepsAmplitudesThatGrowFallOrComeInTurn) {
  const std::vector<OfCycle> amplitudes = {
      [](double cycle) { return 0.1 + 0.9 * cycle / 8; },
      [](double cycle) { return 1.0 - 0.1 * cycle; },
      [](double cycle) { return cycle < 3 ? 0.15 : 1.0; },
      [](double cycle) { return static_cast<int>(cycle) % 2 == 0 ? 1.0 : 0.4; }};
  for (const OfCycle& amplitude : amplitudes) {
    EXPECT_TRUE(IsWhole(WithForce(Sine(8, amplitude))));
  }
}

TEST(TestPart, KeepsAMeanThatWandersAndARandomMotion) {
  std::vector<double> wandering = Sine(8);
  for (std::size_t i = 0; i < wandering.size(); ++i) {
    wandering[i] += 0.8 * kReach * static_cast<double>(i) / static_cast<double>(wandering.size());
  }
  EXPECT_TRUE(IsWhole(WithForce(wandering)));
  Generator generator(5);
  for (int record = 0; record < 50; ++record) {
    std::vector<double> places = {0.0};
    for (int turn = 0; turn < 12; ++turn) {
      const double next = kReach * testing::Uniform(generator, -1.0, 1.0);
      const std::vector<double> way = Way(places.back(), next, 40);
      places.insert(places.end(), way.begin() + 1, way.end());
    }
    const TestPart test = FindTestPart(WithForce(places));  // a small first swing may be a rest
    EXPECT_THAT(test.before, AnyOf("", "rest")) << record;
    EXPECT_THAT(test.after, AnyOf("", "rest")) << record;
  }
}

TEST(TestPart, LeavesOutATravelBeforeOrAfterOfAnyLengthAndDirection) {
  for (const double length : {2.0, -2.0, 10.0, -10.0, 300.0, -300.0}) {
    for (const std::size_t rest : {0, 60}) {
      const std::vector<double> test = Sine(5);
      const double far = length * kReach;
      const std::vector<double> before =
          Joined({Way(far, 0.0, 150), std::vector<double>(rest, 0.0)});
      const std::vector<double> after =
          Joined({std::vector<double>(rest, 0.0), Way(0.0, far, 150), {far}});
      const TestPart test_part = FindTestPart(WithForce(Joined({before, test, after})));
      EXPECT_TRUE(test_part.begins_cycled) << length;
      EXPECT_GE(test_part.first, before.size()) << length;
      EXPECT_LE(test_part.first, before.size() + kLost) << length;
      EXPECT_LE(test_part.last, before.size() + test.size() + rest) << length;
      EXPECT_GE(test_part.last, before.size() + test.size() - kLost) << length;
      EXPECT_EQ(test_part.before, "travel") << length;
      EXPECT_EQ(test_part.after, "travel") << length;
    }
  }
}

TEST(TestPart, KeepsAllAmplitudesAfterATravel) {
  const std::vector<double> blocks =
      Sine(12, [](double cycle) { return 0.25 * (1 + std::floor(cycle / 3)); });
  const TestPart part = FindTestPart(WithForce(Joined({Way(-8 * kReach, 0.0, 300), blocks})));
  EXPECT_GE(part.first, 300U);
  EXPECT_LE(part.first, 300U + kLost);
  EXPECT_EQ(part.last, 300U + blocks.size());
}

TEST(TestPart, LeavesOutTheFallOfASpecimenThatBreaks) {
  std::vector<double> cycles =
      Sine(30, [](double cycle) { return cycle < 27 ? 1.0 : 1 + (cycle - 27) * (cycle - 27); });
  const std::vector<double> fall = Way(cycles.back(), -40 * kReach, 20);
  const TestPart test = FindTestPart(WithForce(Joined({cycles, fall})));
  EXPECT_EQ(test.first, 0U);
  EXPECT_FALSE(test.begins_cycled);
  EXPECT_LE(test.last, 28 * kCycle);
  EXPECT_GE(test.last, 26 * kCycle);
}

TEST(TestPart, IsFoundInADisplacementWithNoise) {
  Generator generator(7);
  std::vector<double> displacement = Joined({Way(-20 * kReach, 0.0, 300), Sine(6)});
  for (double& place : displacement) place += 0.01 * kReach * testing::Normal(generator);
  const TestPart test = FindTestPart(WithForce(displacement));
  EXPECT_GE(test.first, 300U);
  EXPECT_LE(test.first, 300U + kLost);
  EXPECT_EQ(test.last, displacement.size());
}

TEST(TestPart, LeavesOutRestsButForTheSampleThatTheMotionBeginsFrom) {
  const std::vector<double> test = Sine(3);
  const TestPart part = FindTestPart(WithForce(
      Joined({std::vector<double>(90, 0.0), test, std::vector<double>(40, test.back())})));
  EXPECT_EQ(part.first, 90U);  // the sine's own first sample is at rest too, and stays
  EXPECT_EQ(part.last, 90U + test.size());
  EXPECT_FALSE(part.begins_cycled);
  EXPECT_EQ(part.before, "rest");
  EXPECT_EQ(part.after, "rest");
}

TEST(TestPart, KeepsADwellOfHalfAStroke) {
  // Usual strokes of 50 samples; the sine's own first sample rests too.
  const auto rested = [](std::size_t samples) {
    return WithForce(Joined({std::vector<double>(samples, 0.0), Sine(5)}));
  };
  EXPECT_TRUE(IsWhole(rested(kCycle / 4 - 1)));
  EXPECT_FALSE(IsWhole(rested(kCycle / 4)));
}

TEST(TestPart, LeavesOutTheRampsOfALoad) {
  Record record = WithForce(Sine(20));
  record.normal_load.assign(record.size(), 50.0);
  for (std::size_t i = 0; i < 2 * kCycle; ++i) {
    record.normal_load[i] = 50.0 * static_cast<double>(i) / (2.0 * kCycle);
  }
  const TestPart test = FindTestPart(record);
  EXPECT_GE(test.first, 2 * kCycle);  // at the second turning point under the load
  EXPECT_LE(test.first, 4 * kCycle);
  EXPECT_TRUE(test.begins_cycled);
  EXPECT_EQ(test.before, "load ramp");
  EXPECT_EQ(test.after, "");
}

}  // namespace
}  // namespace mindahl::loop::test_part_test
