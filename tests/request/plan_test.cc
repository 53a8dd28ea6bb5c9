#include "mindahl/request/plan.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <numbers>
#include <string_view>
#include <utility>

#include "support/histories.h"

// These tests concern the loops that a plan expects.
namespace mindahl::request::plan_test {
namespace {

constexpr double kNoise = 2e-8;  // [m]

/// A loop of 40 N whose displacement is read with a noise of kNoise.
io::RecordFile NoisyRecord() {
  constexpr std::uint64_t kSeed = 3;
  testing::Generator generator(kSeed);
  loop::Record record;
  for (int i = 0; i <= 600; ++i) {
    record.displacement.push_back(3e-6 * std::sin(2 * std::numbers::pi * i / 200));
  }
  record.force =
      testing::Respond(testing::Model("mindlin-dahl"), {4e7, 1.0 / 3, 40.0}, record.displacement);
  for (double& reading : record.displacement) reading += kNoise * testing::Normal(generator);
  for (double& force : record.force) force += 0.2 * testing::Normal(generator);
  io::RecordFile file;
  file.record = std::move(record);
  return file;
}

double ExpectedDisplacementNoise(double given) {
  PlanRequest request;
  request.record = &NoisyRecord;
  request.record_name = "loop.csv";
  request.displacement_noise = given;
  request.amplitudes = {3e-6};
  request.initial_state = models::InitialState::kSteady;
  return MakePlan(request, [](std::string_view) {}).expected.displacement_noise;
}

TEST(MakePlan, TakesTheDisplacementNoiseOfItsRecordUnlessOneIsGiven) {
  // The estimate from 600 third differences, neighbours correlated, scatters by less than a tenth.
  EXPECT_NEAR(ExpectedDisplacementNoise(0.0), kNoise, 0.3 * kNoise);
  EXPECT_EQ(ExpectedDisplacementNoise(5e-8), 5e-8);
}

}  // namespace
}  // namespace mindahl::request::plan_test
