#include "identification/diagnosis/adequacy.h"
#include "identification/stages.h"
#include "support/prelude.h"

// Which cause is named first: contacts with something beside the law, as measured records have it,
// whose cause is known because it was put in.
namespace mindahl::identification::causes_test {
namespace {

constexpr BranchLaw kLaw{4e7, 1.0 / 3, 40.0};
constexpr double kReach = 3e-5;  // [m], twenty times gross slip, as a damper or a seal has it
constexpr double kNoise = 0.002 * kLaw.slip_force;
constexpr double kCycles = 4.0;
constexpr int kSamples = 400;  // a cycle

double SineAt(double phase) { return std::sin(2 * std::numbers::pi * phase); }
double CosineAt(double phase) { return std::cos(2 * std::numbers::pi * phase); }

/// What is beside the contact at a sample, over Tc.
struct Place {
  double position;   // over the reach
  double speed;      // over its largest, with its sign
  double direction;  // of the motion
  double force;      // of the contact, over Tc
};

/// A sine with something in addition to the contact's force.
Record With(const std::function<double(const Place&)>& beside, double frequency = 1.0) {
  Record record;
  for (int i = 0; i <= static_cast<int>(kCycles * kSamples); ++i) {
    const double phase = static_cast<double>(i) / kSamples;
    record.time.push_back(phase / frequency);
    record.displacement.push_back(kReach * SineAt(phase));
  }
  record.force = Respond(Model("mindlin-dahl"), kLaw, record.displacement);
  Generator generator(1);
  for (std::size_t i = 0; i < record.size(); ++i) {
    const double phase = static_cast<double>(i) / kSamples;
    const double speed = CosineAt(phase);
    const Place place{.position = SineAt(phase),
                      .speed = speed,
                      .direction = speed < 0 ? -1.0 : 1.0,
                      .force = record.force[i] / kLaw.slip_force};
    record.force[i] += kLaw.slip_force * beside(place) + kNoise * Normal(generator);
  }
  return record;
}

FitResult Fitted(const Record& record, const FitOptions& options = {}) {
  return Fit({&record, 1}, options, Depth::kIntervals);
}

std::string_view FirstOf(const FitResult& fit) {
  return fit.adequacy.causes.empty() ? "none" : fit.adequacy.causes.front().code;
}

// --- speed and lag

TEST(FirstCause, OfAKneeThatTheSpeedRoundsIsAPowerOfTheSpeedAtAnyFrequency) {
  for (const double frequency : {0.25, 5.0}) {
    SCOPED_TRACE(frequency);
    const FitResult fit = Fitted(
        With([](const Place& at) { return 0.3 * at.direction * std::sqrt(std::abs(at.speed)); },
             frequency));
    EXPECT_EQ(FirstOf(fit), "speed_power");
    EXPECT_GT(fit.adequacy.causes.front().explains, 0.8);
  }
}

TEST(FirstCause, OfALateChannelIsTheLag) {
  constexpr std::size_t kLate = 2;  // samples
  Record record = With([](const Place&) { return 0.0; });
  for (std::size_t i = record.size(); i-- > kLate;) record.force[i] = record.force[i - kLate];
  record = testing::From(record, kLate);
  for (const bool timed : {true, false}) {
    if (!timed) record.time.clear();
    const FitResult fit = Fitted(record);
    EXPECT_EQ(FirstOf(fit), "channel_lag") << timed;
    EXPECT_GT(fit.adequacy.causes.front().explains, 0.5) << timed;
  }
}

// --- position

TEST(FirstCause, OfASlipForceThatGrowsAlongTheStrokeIsThat) {
  const FitResult fit = Fitted(With(
      [](const Place& at) { return at.force * (at.direction > 0 ? 0.1 : 0.05) * at.position; }));
  EXPECT_THAT(FirstOf(fit), ::testing::StartsWith("slip_position"));
  EXPECT_GT(fit.adequacy.causes.front().explains, 0.9);
}

TEST(FirstCause, OfASlipForceThatBendsAlongTheStrokeIsTheQuadraticOne) {
  const FitResult fit = Fitted(With([](const Place& at) {
    return at.force * (at.direction > 0 ? 0.1 : -0.05) * at.position * at.position;
  }));
  EXPECT_EQ(FirstOf(fit), "slip_position_quadratic");
}

TEST(FirstCause, OfASpringInParallelIsThePlateauSlope) {
  const FitResult fit = Fitted(With([](const Place& at) { return 0.1 * at.position; }));
  EXPECT_EQ(FirstOf(fit), "plateau_slope");
}

// --- columns of the file

TEST(Covariates, AreOneChannelWhereATenthIsTheirOwn) {
  // If y has the variance of x and is not correlated with it, the columns x and a + b(x + c·y) have
  // the correlation 1/√(1 + c²). It equals √(1 − 0.1²) at c = 0.1005.
  const auto are_one = [](double own) {
    std::vector<double> x;
    std::vector<double> y;
    for (int i = 0; i < 300; ++i) {
      const double phase = 0.07 * 2 * std::numbers::pi * i;
      x.push_back(5 + std::sin(phase));
      y.push_back(3 - 2 * (std::sin(phase) + own * std::cos(phase)));
    }
    return AreOneChannel(x, y);
  };
  EXPECT_TRUE(are_one(0.09));
  EXPECT_FALSE(are_one(0.112));
}

}  // namespace
}  // namespace mindahl::identification::causes_test
