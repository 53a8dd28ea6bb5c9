#include "mindahl/loop/facts.h"

#include "mindahl/loop/preparation.h"
#include "mindahl/loop/reversals.h"
#include "support/histories.h"
#include "support/measured.h"
#include "support/prelude.h"

// What a record says before any model is asked, on loops whose facts are known in closed form.
namespace mindahl::loop::facts_test {
namespace {

/// Rounding of sums of a few hundred terms.
constexpr double kRounding = 1e-10;

/// A stick of stiffness σ that slips at Tc, the displacement a triangle about a centre: a
/// parallelogram with its corners on samples.
struct Parallelogram {
  double stiffness = 20.0;   // [N/m]
  double slip_force = 2.0;   // [N]
  double centre = 0.0;       // [m]
  double offset = 0.0;       // [N]
  double normal_load = 0.0;  // [N]; 0 where it is not known
  double curvature = 0.0;    // [N/m²] of a force in both strokes, about the centre
  double growth = 0.0;       // of the slip force, a cycle
  double falling = 1.0;      // stiffness of the strokes that fall, over that of those that rise
  std::vector<double> amplitudes = {1.0, 1.0, 1.0, 1.0, 1.0};  // [m] of each cycle
};

constexpr std::size_t kStroke = 400;  // samples

Record MakeRecord(const Parallelogram& loop) {
  Record record;
  double force = 0.0;
  double last = 0.0;
  const auto go = [&](double to, double slip_force) {
    const double from = last;
    for (std::size_t i = 1; i <= kStroke; ++i) {
      const double x = from + (to - from) * static_cast<double>(i) / kStroke;
      const double stiffness = (x < last ? loop.falling : 1.0) * loop.stiffness;
      force = std::clamp(force + stiffness * (x - last), -slip_force, slip_force);
      last = x;
      record.displacement.push_back(loop.centre + x);
      record.force.push_back(loop.offset + force + loop.curvature * x * x);
      if (loop.normal_load > 0) record.normal_load.push_back(loop.normal_load);
    }
  };
  double slip_force = loop.slip_force;
  go(-loop.amplitudes.front(), slip_force);
  for (const double amplitude : loop.amplitudes) {
    go(amplitude, slip_force);
    go(-amplitude, slip_force);
    slip_force += loop.growth * loop.slip_force;
  }
  return record;
}

LoopFacts FactsOf(const Record& record, int force_sense = 1) {
  return MeasureFacts(record, FindReversals(record.displacement, 0.0), force_sense);
}

TEST(LoopFacts, OfALoopThatIsSofterOneWayAreOfBothStrokes) {
  Parallelogram loop;
  loop.falling = 0.25;
  const LoopFacts facts = FactsOf(MakeRecord(loop));
  // Up at 20 N/m, down at 5 N/m between ∓2 N: over 0.2 m and 0.8 m of strokes of 2 m.
  EXPECT_NEAR(*facts.half_gap, 2.0, kRounding);
  EXPECT_NEAR(facts.energy_per_cycle, 2 * (1.8 + 1.2), kRounding);
  EXPECT_NEAR(facts.energy_ratio, 6.0 / 8.0, kRounding);
  // The force passes nought at −0.9 m and at 0.6 m.
  EXPECT_NEAR(*facts.sliding_amplitude, 0.75, kRounding);
}

TEST(LoopFacts, OfAContactThatIsLoadedFirstAtAnEndOfItsStrokesAreOfLaterCycles) {
  // From 0 to 2X and back: the first stroke is the virgin one, and the force does not come back.
  const models::BranchLaw law{4e7, 1.0 / 3, 40.0};
  Record record{.displacement = Sine(3.0, 200)};
  for (std::size_t i = 0; i < record.size(); ++i) {
    const double turns = static_cast<double>(i) / 200;
    record.displacement[i] = 2.25e-6 * (1 - std::cos(2 * std::numbers::pi * turns));
  }
  record.force = testing::Respond(testing::Model("mindlin-dahl"), law, record.displacement);
  const LoopFacts facts = FactsOf(record);
  ASSERT_EQ(facts.cycles.size(), 2U);
  EXPECT_NEAR(facts.cycles[0].energy, facts.cycles[1].energy, 1e-9 * facts.cycles[1].energy);
  EXPECT_LT(*facts.half_gap_standard_deviation, 1e-9 * *facts.half_gap);
  record.displacement.resize(200);
  record.force.resize(200);
  EXPECT_FALSE(FactsOf(record).closed);
}

TEST(Slides, FromAnEnergyRatioOfThreeFifthsOn) {
  // A parallelogram's is 1 − Tc/(σX).
  Parallelogram loop;
  for (const double ratio : {0.55, 0.65}) {
    loop.stiffness = loop.slip_force / (1 - ratio);
    EXPECT_EQ(Slides(FactsOf(MakeRecord(loop))), ratio > 0.6);
  }
  EXPECT_FALSE(Slides(LoopFacts()));
}

TEST(HasSlipped, AtTheEndsOfTheStrokeHoweverSoftTheRig) {
  const auto loop_of = [](double shape, double reach, double rig) {
    const models::BranchLaw law{1e7, shape, 10.0};
    Record record{.displacement = Sine(4.25, 400)};
    for (double& x : record.displacement) x *= reach * 1.5e-6;
    record.force = testing::Respond(testing::Model("mindlin-dahl"), law, record.displacement);
    for (std::size_t i = 0; i < record.size(); ++i) record.displacement[i] += record.force[i] / rig;
    return FactsOf(record);
  };
  for (const double rig : {1e20, 2e6}) {
    EXPECT_FALSE(HasSlipped(loop_of(1.0 / 3, 0.8, rig)));
    EXPECT_FALSE(HasSlipped(loop_of(1.0 / 3, 1.1, rig)));
    EXPECT_TRUE(HasSlipped(loop_of(1.0 / 3, 1.4, rig)));
    EXPECT_FALSE(HasSlipped(loop_of(1.0, 1.6, rig))) << "T* is 0.91 of Tc";
  }
  EXPECT_FALSE(HasSlipped(LoopFacts()));
}

TEST(Slides, BesideASpringThatRaisesThePeakForce) {
  Parallelogram loop;
  loop.stiffness = loop.slip_force / 0.05;  // slides over 95 % of the stroke
  Record record = MakeRecord(loop);
  // A spring that adds 0.7 Tc at the ends lowers the energy ratio to 0.95/1.7.
  for (std::size_t i = 0; i < record.size(); ++i) {
    record.force[i] -= 0.7 * loop.slip_force * record.displacement[i];
  }
  const LoopFacts facts = FactsOf(record);
  ASSERT_LT(facts.energy_ratio, 0.6);
  EXPECT_TRUE(Slides(facts));
  // One that adds twice Tc leaves a gap below half the peak: friction of a guide would be alike.
  for (std::size_t i = 0; i < record.size(); ++i) {
    record.force[i] -= 1.3 * loop.slip_force * record.displacement[i];
  }
  EXPECT_FALSE(Slides(FactsOf(record)));
}

TEST(MeasureFacts, OfAParallelogramAreThoseOfItsStickAndSlipWhateverTheSignOfTheForce) {
  for (const int sense : {1, -1}) {
    Record record = MakeRecord({.centre = -11.0, .offset = 7.0, .normal_load = 5.0});
    for (double& force : record.force) force *= sense;
    const LoopFacts facts = FactsOf(record, sense);
    ASSERT_TRUE(facts.closed);
    ASSERT_EQ(facts.cycles.size(), 5U);
    EXPECT_EQ(facts.steady_cycles, 5U);
    EXPECT_EQ(facts.cycles[1].start, 3 * kStroke - 1);
    EXPECT_NEAR(facts.amplitude, 1.0, kRounding);
    EXPECT_NEAR(facts.peak_force, 2.0, kRounding);
    EXPECT_NEAR(*facts.half_gap, 2.0, kRounding);
    EXPECT_NEAR(*facts.half_gap_standard_deviation, 0.0, kRounding);
    EXPECT_NEAR(*facts.cycles[0].centre_force, 7.0, kRounding);
    // The stick takes Tc/σ to mid-force, twice that to the plateau.
    const double sliding = 1.0 - 0.1;
    EXPECT_NEAR(*facts.sliding_amplitude, sliding, kRounding);
    EXPECT_NEAR(facts.energy_per_cycle, 4 * 2.0 * sliding, kRounding);
    EXPECT_NEAR(facts.energy_ratio, sliding, kRounding);
    EXPECT_NEAR(*facts.asymmetry, 0.0, kRounding);
  }
}

TEST(MeasureFacts, OfAnEllipseAreThoseOfItsMiddleThird) {
  // The strokes are T*(± sin φ √(1 − u²)) about the slope: the median part of five lies at
  // 1/15 < |u| < 1/5.
  constexpr double kLag = 0.4;
  constexpr int kCycle = 4000;  // samples: chords are short of the arc by (2π/4000)²/8 = 3e-7
  Record record;
  for (int i = 0; i <= 4 * kCycle; ++i) {
    const double angle = 2 * std::numbers::pi * i / kCycle;
    record.displacement.push_back(3 + 2 * std::sin(angle));
    record.force.push_back(10 * std::sin(angle + kLag));
  }
  const auto integral = [](double u) { return (u * std::sqrt(1 - u * u) + std::asin(u)) / 2; };
  const double mean = (integral(0.2) - integral(1.0 / 15)) / (0.2 - 1.0 / 15);
  const LoopFacts facts = FactsOf(record);
  EXPECT_NEAR(*facts.half_gap, 10 * std::sin(kLag) * mean, 1e-5);
  EXPECT_NEAR(facts.energy_per_cycle, std::numbers::pi * 2 * 10 * std::sin(kLag), 1e-4);
  EXPECT_NEAR(*facts.asymmetry, 0.0, 1e-6);
}

TEST(MeasureFacts, MeansAreOfTheWidestCyclesAlone) {
  const Parallelogram loop{.amplitudes = {0.5, 1.0, 1.0, 0.3, 0.3, 0.3}};
  const LoopFacts facts = FactsOf(MakeRecord(loop));
  // Between amplitudes a cycle has strokes of two widths and is neither.
  EXPECT_EQ(facts.cycles.size(), 5U);  // the last stroke of all ends nowhere
  EXPECT_EQ(facts.steady_cycles, 1U);
  EXPECT_NEAR(facts.amplitude, 1.0, kRounding);
  EXPECT_NEAR(facts.energy_per_cycle, 4 * 2.0 * 0.9, kRounding);
  EXPECT_FALSE(facts.half_gap_standard_deviation);
}

TEST(MeasureFacts, MeansAreOfTheCyclesThatCount) {
  const Parallelogram loop{.amplitudes = {1.0, 1.0, 1.0, 0.5, 0.5, 0.5}};
  const Record record = MakeRecord(loop);
  const std::vector<std::size_t> reversals = FindReversals(record.displacement, 0.0);
  std::vector<unsigned char> counts(record.size(), 1);
  std::fill_n(counts.begin(), FactsOf(record).cycles.back().start, 0);
  const LoopFacts facts = MeasureFacts(record, reversals, 1, counts);
  EXPECT_EQ(facts.cycles.size(), 5U);
  EXPECT_NEAR(facts.amplitude, 0.5, kRounding) << "half as wide as those that do not count";
  counts.assign(record.size(), 0);
  EXPECT_NEAR(MeasureFacts(record, reversals, 1, counts).amplitude, 1.0, kRounding)
      << "where no cycle counts all do";
}

TEST(MeasureFacts, AmplitudeIsThatOfCyclesAndNotOfATravel) {
  Parallelogram loop;
  Record record = MakeRecord(loop);
  for (double x = -loop.amplitudes.back(); x < 5; x += 0.01) {
    record.displacement.push_back(x);
    record.force.push_back(0.0);
  }
  EXPECT_NEAR(FactsOf(record).amplitude, loop.amplitudes.back(), kRounding);
}

TEST(MeasureFacts, AsymmetryIsHowMuchTheStrokesDifferTurnedAboutTheCentre) {
  // A force aδ² in both strokes: of the turned strokes it is the mean that differs.
  constexpr double kCurvature = 0.3;
  constexpr std::size_t kParts = 10;
  const LoopFacts facts = FactsOf(MakeRecord({.curvature = kCurvature}));
  std::array<double, kParts> squares{};
  double mean = 0.0;
  for (std::size_t j = 0; j < kParts; ++j) {
    const double from = 0.95 * (2.0 * static_cast<double>(j) / kParts - 1);
    const double to = from + 0.95 * 2.0 / kParts;
    squares[j] = (to * to * to - from * from * from) / (3 * (to - from));
    mean += squares[j] / kParts;
  }
  double variance = 0.0;
  for (const double square : squares) variance += (square - mean) * (square - mean) / (kParts - 1);
  // A chord of 1/200 m lies above the parabola by a/6 of its square at most.
  constexpr double kChord = kCurvature / 200 / 200;
  EXPECT_NEAR(*facts.asymmetry * facts.peak_force, kCurvature * std::sqrt(variance), kChord);
}

TEST(MeasureFacts, ReportsThatNoCycleCloses) {
  const LoopFacts facts = FactsOf(Record{{0, 1, 2, 3}, {0, 1, 2, 2}, {}, {}});
  EXPECT_FALSE(facts.closed);
  EXPECT_TRUE(facts.cycles.empty());
  EXPECT_FALSE(facts.half_gap);
}

TEST(MeasureFacts, RejectsInvalidRecordAndSign) {
  EXPECT_THROW(FactsOf(Record{}), InvalidArgument);
  EXPECT_THROW(FactsOf(Record{{1, 2}, {1}, {}, {}}), InvalidArgument);
  EXPECT_THROW(FactsOf(MakeRecord({}), 0), InvalidArgument);
}

LoopFacts FactsOfPrepared(const Record& record) {
  const std::vector<RecordView> views = {record};
  return Prepare(views, {}).records[0].facts;
}

// Reference values are those of the measured records' README, read off the loops by others.
TEST(MeasureFacts, OfMeasuredSealsAreWhatOthersReadOff) {
  constexpr double kRead = 0.2;  // [N]
  struct Seal {
    const char* name;
    double half_gap;  // [N]
  };
  for (const Seal& seal :
       {Seal{"O-ring257_3bar", 8.5}, Seal{"NAP310_5bar", 7.2}, Seal{"Circle_1bar", 5.6},
        Seal{"Circle_2bar", 9.3}, Seal{"KDN_5bar", 8.15}, Seal{"Stadium_1bar", 6.85}}) {
    SCOPED_TRACE(seal.name);
    const std::string file = "seals/" + std::string(seal.name) + ".csv";
    const auto rows = testing::ReadMeasured(file, '\t');
    if (!rows) GTEST_SKIP() << "no " << testing::MeasuredPath(file);
    Record record;
    record.displacement = testing::Column(*rows, 4);  // mm
    record.force = testing::Column(*rows, 6);
    const LoopFacts facts = FactsOfPrepared(record);
    EXPECT_NEAR(*facts.half_gap, seal.half_gap, kRead);
    EXPECT_EQ(facts.cycles.size(), 9U);
  }
}

TEST(MeasureFacts, OfTheMeasuredTribometerAreItsEnergyAndFriction) {
  const std::string file = "tribometer/test_data_2.txt";
  const auto rows = testing::ReadMeasured(file, '\t');
  if (!rows) GTEST_SKIP() << "no " << testing::MeasuredPath(file);
  Record record;
  for (const auto& row : *rows) {
    if (row[0] < 20 || row[0] > 60) continue;
    record.normal_load.push_back(1e-6 * row[1]);
    record.displacement.push_back(1e-3 * row[2]);
    record.force.push_back(1e-6 * row[3]);
  }
  const LoopFacts facts = FactsOfPrepared(record);
  EXPECT_NEAR(facts.energy_per_cycle, 516e-6, 9e-6);
  const double load = std::accumulate(record.normal_load.begin(), record.normal_load.end(), 0.0) /
                      static_cast<double>(record.size());
  EXPECT_NEAR(facts.energy_per_cycle / (4 * load * *facts.sliding_amplitude), 0.47, 0.03);
  EXPECT_EQ(facts.cycles.size(), 10U);
}

TEST(CycleEnergy, BeyondTheRangeOfDoubleIsRefusedWithItsSign) {
  const auto refusal = [](double force) {
    const Record record{.displacement = {0, 1e200, 0}, .force = {0, 0, force}};
    return MessageOf([&] { CycleEnergy(record, 0, 2); });
  };
  EXPECT_THAT(refusal(1e200), StartsWith("energy of a cycle [J] = -inf is invalid"));
  EXPECT_THAT(refusal(-1e200), StartsWith("energy of a cycle [J] = inf is invalid"));
}

TEST(MeasureFacts, PeakForceTakesTheMeanOfTheTwoEndsOfACycle) {
  // Up and down in 60 samples each: the force follows the displacement to ±10 but for the last
  // turn, −14 in one sample. Of means over three samples the least is −11, of the two ends −12.
  Record record;
  for (int i = 0; i <= 120; ++i) {
    const double x = i <= 60 ? -1 + i / 30.0 : 3 - i / 30.0;
    record.displacement.push_back(x);
    record.force.push_back(i == 120 ? -14.0 : 10 * x);
  }
  const LoopFacts facts = FactsOf(record);
  ASSERT_EQ(facts.cycles.size(), 1U);
  EXPECT_NEAR(facts.cycles[0].peak_force, (10 + 12) / 2.0, kRounding);
}

}  // namespace
}  // namespace mindahl::loop::facts_test
