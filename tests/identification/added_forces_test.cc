#include "identification/solve/projected_residual.h"
#include "identification/stages.h"
#include "support/prelude.h"

// Forces of speed by a power, of position and direction, of a ripple and of a mass: recovered from
// loops that have them, with exact derivatives.
namespace mindahl::identification::added_forces_test {
namespace {

constexpr BranchLaw kLaw{5e7, 0.4, 60.0};
constexpr double kReach = 4e-6;  // 2 of gross slip
constexpr int kSamplesPerCycle = 160;
constexpr double kStep = 0.01;  // [s]
/// The regularised speed differs from |v|^m by ½(1 − m)(v_ε/v)², 1e-10 next to a turning point of
/// these sines; the condition of the fit is 1e4 for the contact and up to ten times that with a
/// force that looks like it.
constexpr double kRecovered = 1e-5;

Record Loop(double cycles = 2.3) {
  const auto displacement = Cycling(Wave::kSine, kReach, cycles, kSamplesPerCycle);
  return Timed(LoopOf(kLaw, displacement), kStep);
}

/// Central differences, as a fit knows the velocity [m/s].
std::vector<double> Velocity(const Record& record) {
  const std::size_t last = record.size() - 1;
  std::vector<double> velocity;
  for (std::size_t i = 0; i <= last; ++i) {
    const std::size_t before = i == 0 ? 0 : i - 1;
    const std::size_t after = std::min(i + 1, last);
    velocity.push_back((record.displacement[after] - record.displacement[before]) /
                       (record.time[after] - record.time[before]));
  }
  return velocity;
}

/// Mean of the speed over the path in the middle third [m/s].
double SpeedInTheMiddle(const Record& record, const std::vector<double>& velocity) {
  double sum = 0.0;
  double path = 0.0;
  for (std::size_t i = 1; i < record.size(); ++i) {
    if (std::abs(record.displacement[i]) > kReach / 3) continue;
    const double step = std::abs(record.displacement[i] - record.displacement[i - 1]);
    sum += step * std::abs(velocity[i]);
    path += step;
  }
  return sum / path;
}

/// Direction of the stroke of each sample, a turning point ending its stroke.
std::vector<double> Direction(const Record& record) {
  std::vector<double> direction;
  for (std::size_t i = 0; i < record.size(); ++i) {
    const std::size_t from = i == 0 ? 0 : i - 1;
    direction.push_back(record.displacement[from + 1] > record.displacement[from] ? 1.0 : -1.0);
  }
  return direction;
}

double ValueOf(const FitResult& fit, const char* name) { return fit.Find(name)->value; }

TEST(AddedForces, PowerOfTheSpeedIsRecovered) {
  for (const double exponent : {0.35, 0.8}) {
    Record record = Loop();
    const std::vector<double> velocity = Velocity(record);
    const double factor = 12 / std::pow(2 * std::numbers::pi * kReach / 1.6, exponent);
    for (std::size_t i = 0; i < record.size(); ++i) {
      record.force[i] +=
          std::copysign(factor * std::pow(std::abs(velocity[i]), exponent), velocity[i]);
    }
    const FitResult fit = FitOne(record, {.terms = {"viscous", "speed_exponent"}});
    EXPECT_TRUE(Recovers(fit, kLaw, kRecovered));
    EXPECT_NEAR(ValueOf(fit, "speed_exponent"), exponent, kRecovered);
    // C belongs to 1 m/s: ∂ ln C/∂m = ln(u/v), of a speed of 1e-5 m/s.
    EXPECT_NEAR(ValueOf(fit, "viscous"), factor, 12 * kRecovered * factor);
  }
}

TEST(AddedForces, SlipForceOfPositionAndDirectionIsRecovered) {
  Record record = Loop();
  constexpr double kSlope = 0.12;
  constexpr double kCurvature = -0.2;
  const double plateau_slope = 5 / kReach;
  const double plateau_curvature = -4 / (kReach * kReach);
  for (std::size_t i = 0; i < record.size(); ++i) {
    const double position = record.displacement[i] / kReach;
    record.force[i] *= 1 + kSlope * position + kCurvature * position * position;
    record.force[i] += plateau_slope * record.displacement[i] +
                       plateau_curvature * record.displacement[i] * record.displacement[i];
  }
  const FitResult fit = FitOne(
      record, {.terms = {"slip_slope", "slip_curvature", "plateau_slope", "plateau_curvature"}});
  EXPECT_TRUE(Recovers(fit, kLaw, kRecovered));
  EXPECT_NEAR(ValueOf(fit, "slip_slope"), kSlope, kRecovered);
  EXPECT_NEAR(ValueOf(fit, "slip_curvature"), kCurvature, kRecovered);
  EXPECT_NEAR(ValueOf(fit, "plateau_slope"), plateau_slope, 10 * kRecovered * plateau_slope);
  EXPECT_NEAR(ValueOf(fit, "plateau_curvature"), plateau_curvature,
              -10 * kRecovered * plateau_curvature);
}

TEST(AddedForces, DriftOfARecordWithoutTimeIsOfASample) {
  Record record = Loop();
  EXPECT_EQ(FitOne(record, {.terms = {"force_drift"}}).Find("force_drift")->unit, "N/s");
  record.time.clear();
  EXPECT_EQ(FitOne(record, {.terms = {"force_drift"}}).Find("force_drift")->unit, "N/sample");
}

TEST(AddedForces, SlipForceOfTheSpeedIsRecoveredAtTheSpeedInTheMiddle) {
  Record record = Loop();
  constexpr double kOfSpeed = 0.4;
  constexpr double kExponent = 0.5;
  const std::vector<double> velocity = Velocity(record);
  const double usual = SpeedInTheMiddle(record, velocity);
  for (std::size_t i = 0; i < record.size(); ++i) {
    const double ratio = std::abs(velocity[i]) / usual;
    record.force[i] *= 1 + kOfSpeed * (std::pow(ratio, kExponent) - 1);
  }
  const FitResult fit = FitOne(record, {.terms = {"slip_speed", "slip_speed_exponent"}});
  EXPECT_TRUE(Recovers(fit, kLaw, kRecovered / kLaw.shape_exponent));
  EXPECT_NEAR(fit.law.tangential_stiffness / kLaw.tangential_stiffness, 1, kRecovered);
  EXPECT_NEAR(fit.law.slip_force / kLaw.slip_force, 1, kRecovered);
  // At rest a fit has 1 − c(1 − (v_ε/v₀)^m), with a resolution of 1e-6 of the speed.
  constexpr double kAtRest = 1e-3;
  EXPECT_NEAR(ValueOf(fit, "slip_speed"), kOfSpeed, kAtRest);
  EXPECT_NEAR(ValueOf(fit, "slip_speed_exponent"), kExponent, kAtRest);
}

TEST(AddedForces, DragIsRecoveredAndTcIsItsSumWithTheContactsForceInTheMiddle) {
  // A slip force of 60 N and 40 N of drag at the speed in the middle: 100 N, of which 0.4.
  Record record = Loop();
  const std::vector<double> velocity = Velocity(record);
  constexpr double kDrag = 40.0;
  constexpr double kExponent = 0.5;
  const double usual = SpeedInTheMiddle(record, velocity);
  for (std::size_t i = 0; i < record.size(); ++i) {
    const double ratio = std::abs(velocity[i]) / usual;
    record.force[i] += std::copysign(kDrag * std::pow(ratio, kExponent), velocity[i]);
  }
  const FitResult fit = FitOne(record, {.terms = {"drag_fraction", "drag_exponent"}});
  EXPECT_TRUE(fit.converged) << fit.solver.message;
  constexpr double kAtRest = 1e-3;  // as above
  const double together = kLaw.slip_force + kDrag;
  EXPECT_NEAR(fit.law.slip_force, together, kAtRest * together);
  EXPECT_NEAR(ValueOf(fit, "drag_fraction"), kDrag / together, kAtRest);
  EXPECT_NEAR(ValueOf(fit, "drag_exponent"), kExponent, 10 * kAtRest);
  // Its stiffness is that of the branch, of which the slip force's fraction is seen.
  EXPECT_NEAR(fit.law.tangential_stiffness * kLaw.slip_force / together, kLaw.tangential_stiffness,
              10 * kAtRest * kLaw.tangential_stiffness);
}

TEST(AddedForces, SlipForceThatChangesWithTimeIsRecovered) {
  Record record = Loop();
  constexpr double kTrend = -0.12;
  const double middle = (record.time.front() + record.time.back()) / 2;
  for (std::size_t i = 0; i < record.size(); ++i) {
    const double time = (record.time[i] - middle) / (record.time.back() - middle);
    record.force[i] *= 1 + kTrend * time;
  }
  const FitResult fit = FitOne(record, {.terms = {"slip_trend"}});
  EXPECT_TRUE(Recovers(fit, kLaw, kRecovered));
  EXPECT_NEAR(ValueOf(fit, "slip_trend"), kTrend, -10 * kRecovered * kTrend);
}

TEST(AddedForces, RippleWithAPhaseForEachDirectionIsRecovered) {
  Record record = Loop();
  const double period = kReach / 3.7;
  const std::vector<double> direction = Direction(record);
  for (std::size_t i = 0; i < record.size(); ++i) {
    const double phase = 2 * std::numbers::pi * record.displacement[i] / period;
    record.force[i] += direction[i] > 0 ? 2 * std::cos(phase + 0.7) : 3 * std::cos(phase - 1.9);
  }
  const FitResult fit =
      FitOne(record, {.terms = {"ripple_period", "ripple_cosine_up", "ripple_sine_up",
                                "ripple_cosine_down", "ripple_sine_down"}});
  EXPECT_TRUE(Recovers(fit, kLaw, kRecovered));
  EXPECT_NEAR(ValueOf(fit, "ripple_period"), period, kRecovered * period);
  const double up = std::hypot(ValueOf(fit, "ripple_cosine_up"), ValueOf(fit, "ripple_sine_up"));
  const double down =
      std::hypot(ValueOf(fit, "ripple_cosine_down"), ValueOf(fit, "ripple_sine_down"));
  EXPECT_NEAR(up, 2, 2 * 10 * kRecovered);
  EXPECT_NEAR(down, 3, 3 * 10 * kRecovered);
  // cos(φ + 0.7) = cos 0.7·cos φ − sin 0.7·sin φ
  EXPECT_NEAR(std::atan2(-ValueOf(fit, "ripple_sine_up"), ValueOf(fit, "ripple_cosine_up")), 0.7,
              10 * kRecovered);
}

TEST(AddedForces, MassIsRecovered) {
  Record record = Loop();
  const std::vector<double> velocity = Velocity(record);
  constexpr double kMass = 1e5;  // [kg], of which these few micrometres make 6 N
  for (std::size_t i = 0; i < record.size(); ++i) {
    const std::size_t before = i == 0 ? 0 : i - 1;
    const std::size_t after = std::min(i + 1, record.size() - 1);
    record.force[i] +=
        kMass * (velocity[after] - velocity[before]) / (record.time[after] - record.time[before]);
  }
  const FitResult fit = FitOne(record, {.terms = {"inertia"}});
  EXPECT_TRUE(Recovers(fit, kLaw, kRecovered));
  EXPECT_NEAR(ValueOf(fit, "inertia"), kMass, kRecovered * kMass);
}

TEST(AddedForces, ExponentsAndAPeriodMustBePositive) {
  const std::vector<std::pair<std::vector<std::string>, double>> refused = {
      {{"speed_exponent", "viscous"}, 0.0},
      {{"speed_exponent", "viscous"}, -1e308},
      {{"slip_speed_exponent", "slip_speed"}, -0.5},
      {{"drag_exponent", "drag_fraction"}, -1.0},
      {{"ripple_period", "ripple_cosine_up"}, 0.0}};
  const Record record = Loop();
  for (const auto& [terms, value] : refused) {
    const std::string message = MessageOf([&] {
      FitOne(record, {.terms = terms, .fixed = {{terms.front(), value}}});
    });
    EXPECT_THAT(message, ::testing::StartsWith("fixed " + terms.front() + " ["));
    EXPECT_THAT(message, HasSubstr("must be "));
  }
}

}  // namespace
}  // namespace mindahl::identification::added_forces_test
