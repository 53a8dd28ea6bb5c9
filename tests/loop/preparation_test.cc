#include "mindahl/loop/preparation.h"

#include "mindahl/loop/facts.h"
#include "mindahl/loop/reversals.h"
#include "support/histories.h"
#include "support/prelude.h"

// What is known of records before any model is asked.
namespace mindahl::loop::preparation_test {
namespace {

constexpr double kTwoPi = 6.283185307179586;
constexpr int kCycle = 100;  // samples

/// Cycles of a lagging force about ±1, loads of 10 and, in the second cycle, 12.
Record Made(int cycles = 3) {
  Record record;
  for (int i = 0; i <= cycles * kCycle; ++i) {
    record.displacement.push_back(std::sin(kTwoPi * i / kCycle));
    record.force.push_back(std::sin(kTwoPi * i / kCycle + 0.4));
    record.normal_load.push_back(i / kCycle == 1 ? 12.0 : 10.0);
  }
  return record;
}

PreparedRecords PrepareAll(const std::vector<Record>& records, const PreparationOptions& options) {
  const std::vector<RecordView> views(records.begin(), records.end());
  return Prepare(views, options);
}

TEST(Preparation, OneMaskLeavesOutWhatWindowCyclesAndMasksDo) {
  const std::vector<Record> records = {Made()};
  const std::size_t size = records[0].size();
  PreparationOptions options{.load_window = Interval{9.0, 11.0},
                             .cycles = CountRange{2, 9},
                             .held_out = {std::vector<bool>(size, false)}};
  options.held_out[0][290] = true;
  const PreparedRecords prepared = PrepareAll(records, options);
  const PreparedRecord& one = prepared.records[0];
  ASSERT_EQ(one.reversals.size(), 6U);
  std::size_t left_out = 0;
  for (std::size_t i = 0; i < size; ++i) {
    // The first cycle ends with the second reversal, at three quarters.
    const bool counts = i >= 75 && (i < 100 || i >= 200) && i != 290;
    EXPECT_EQ(one.counts[i], counts ? 1 : 0) << i;
    left_out += counts ? 0 : 1;
  }
  EXPECT_EQ(one.left_out, left_out);
  EXPECT_EQ(prepared.samples(), size);
  EXPECT_EQ(prepared.counted(), size - left_out);
}

/// Places of the samples that count.
std::vector<std::size_t> Counting(const PreparedRecord& record) {
  std::vector<std::size_t> places;
  for (std::size_t i = 0; i < record.size(); ++i) {
    if (record.counts[i] != 0) places.push_back(i);
  }
  return places;
}

std::vector<std::size_t> From(std::size_t first, std::size_t last) {
  std::vector<std::size_t> places;
  for (std::size_t i = first; i <= last; ++i) places.push_back(i);
  return places;
}

TEST(Preparation, CyclesAndSamplesCountFromOneAndTheRestMakesHistory) {
  const std::vector<Record> records = {Made()};  // reversals at 25, 75, 125 … 275
  const auto counting = [&](const PreparationOptions& options) {
    const PreparedRecords prepared = PrepareAll(records, options);
    EXPECT_EQ(prepared.records[0].reversals.size(), 6U) << "all of them";
    return Counting(prepared.records[0]);
  };
  EXPECT_EQ(counting({.cycles = CountRange{1, 1}}), From(0, 74));
  EXPECT_EQ(counting({.cycles = CountRange{2, 3}}), From(75, 274));
  EXPECT_EQ(counting({.cycles = CountRange{4, 99}}), From(275, 300)) << "the last is a part of one";
  EXPECT_EQ(counting({.samples = CountRange{101, 150}}), From(100, 149));
  EXPECT_EQ(counting({.cycles = CountRange{2, 2}, .samples = CountRange{1, 80}}), From(75, 79))
      << "both";
}

std::string RefusalOf(const PreparationOptions& options) {
  return MessageOf([&] { PrepareAll({Made()}, options); });
}

TEST(Preparation, CyclesAndSamplesThatARecordHasNotAreRefusedWithWhatItHas) {
  EXPECT_EQ(RefusalOf({.cycles = CountRange{5, 6}}),
            "cycles 5:6 contain nothing of record 1, which has 4 of them: --select cycles=1:4 "
            "is all");
  EXPECT_EQ(RefusalOf({.cycles = CountRange{0, 2}}),
            "--select cycles: '0:2' is empty: the first number must not be the larger");
  EXPECT_EQ(RefusalOf({.samples = CountRange{302, 400}}),
            "samples 302:400 contain nothing of record 1, which has 301 of them: --select "
            "samples=1:301 is all");
  EXPECT_EQ(RefusalOf({.samples = CountRange{7, 6}}),
            "--select samples: '7:6' is empty: the first number must not be the larger");
}

TEST(Preparation, ForceSignFollowsEnergyUnlessGiven) {
  Record opposite = Made();
  for (double& force : opposite.force) force = -force;
  EXPECT_EQ(PrepareAll({Made()}, {}).force_sense, 1);
  const PreparedRecords turned = PrepareAll({opposite}, {});
  EXPECT_EQ(turned.force_sense, -1);
  EXPECT_GT(turned.records[0].facts.energy_per_cycle, 0.0);
  EXPECT_EQ(PrepareAll({opposite}, {.force_sense = 1}).force_sense, 1);
  // Of several records, most.
  EXPECT_EQ(PrepareAll({opposite, Made(), opposite}, {}).force_sense, -1);
}

TEST(Preparation, GateIsGivenFoundOrFromAKnownNoise) {
  PreparationOptions options;
  EXPECT_EQ(PrepareAll({Made()}, options).records[0].gate.gate, 0.0);
  options.displacement_noise = 1e-3;
  const std::vector<Record> records = {Made()};
  const double reach = 2e-3 * std::sqrt(2 * std::log(static_cast<double>(records[0].size())));
  EXPECT_NEAR(PrepareAll(records, options).records[0].gate.gate, reach, 1e-12);
  options.reversal_gate = 0.25;
  EXPECT_EQ(PrepareAll(records, options).records[0].gate.gate, 0.25);
  EXPECT_TRUE(PrepareAll(records, options).records[0].gate.certain);
  Generator generator(2);
  Record noisy = Made();
  for (double& x : noisy.displacement) x += 0.02 * Normal(generator);
  const PreparedRecords found = PrepareAll({noisy}, {});
  EXPECT_GT(found.records[0].gate.gate, 0.02);
  EXPECT_EQ(found.records[0].reversals.size(), 6U);
}

TEST(Preparation, NoisyDisplacementIsSmoothedAndItsReversalsMoved) {
  Generator generator(3);
  const Record clean = Made();
  Record noisy = clean;
  for (double& x : noisy.displacement) x += 0.02 * Normal(generator);
  const PreparedRecords prepared = PrepareAll({noisy}, {});
  const PreparedRecord& one = prepared.records[0];
  ASSERT_EQ(one.smoothed.size(), clean.size());
  ASSERT_EQ(one.smoothing.size(), clean.size());
  EXPECT_NEAR(one.displacement_noise, 0.02, 0.005);
  EXPECT_EQ(one.displacement().data(), one.smoothed.data());
  EXPECT_EQ(one.reversals,
            MoveReversals(one.smoothed, FindReversals(noisy.displacement, one.gate.gate)));
  // What is exact is not touched.
  EXPECT_TRUE(PrepareAll({clean}, {}).records[0].smoothed.empty());
}

TEST(Preparation, ASpikeInDisplacementMakesNeitherReversalNorHistory) {
  const Record clean = Made();
  Record spiked = clean;
  spiked.displacement[120] += 3;
  const std::vector<Record> records = {spiked};
  const PreparedRecords prepared = PrepareAll(records, {});
  const PreparedRecord& one = prepared.records[0];
  EXPECT_EQ(one.glitches, std::vector<std::size_t>{120});
  EXPECT_EQ(one.counts[120], 0);
  EXPECT_EQ(one.left_out, 1U);
  EXPECT_EQ(one.reversals.size(), 6U);
  // A straight way over it is off by the sine's curvature, (2π/100)²/2, at most.
  EXPECT_NEAR(one.displacement()[120], clean.displacement[120], 2e-3);
  EXPECT_EQ(one.record.displacement[120], spiked.displacement[120]) << "as measured";
  EXPECT_NEAR(one.facts.amplitude, 1.0, 1e-12);
}

TEST(Preparation, DropoutsDoNotCountNorChangeTheLoop) {
  Generator generator(4);
  const Record clean = Made();
  Record broken = clean;
  std::size_t zeros = 0;
  for (std::size_t i = 2; i + 2 < broken.size(); ++i) {
    if (generator() % 20 != 0) continue;
    broken.displacement[i] = broken.force[i] = 0.0;
    ++zeros;
  }
  const std::vector<Record> cleans = {clean};
  const std::vector<Record> brokens = {broken};
  const PreparedRecords whole = PrepareAll(cleans, {});
  const PreparedRecords prepared = PrepareAll(brokens, {});
  const PreparedRecord& one = prepared.records[0];
  EXPECT_GE(one.glitches.size() + 1, zeros);
  EXPECT_EQ(one.left_out, one.glitches.size());
  EXPECT_EQ(one.reversals.size(), 6U);
  EXPECT_EQ(prepared.force_sense, 1);
  constexpr double kBridged = 0.01;  // of a loop with lines over 5 % of its samples
  const double energy = whole.records[0].facts.energy_per_cycle;
  EXPECT_NEAR(one.facts.energy_per_cycle, energy, kBridged * energy);
  EXPECT_NEAR(one.facts.peak_force, whole.records[0].facts.peak_force, kBridged);
}

TEST(Preparation, RefusesARecordThatIsEmptyOrNotFinite) {
  EXPECT_THROW(PrepareAll({Record{}}, {}), InvalidArgument);
  EXPECT_THROW(PrepareAll({Record{{1, 2}, {1}, {}, {}}}, {}), InvalidArgument);
  EXPECT_THROW(PrepareAll({Record{{1, 2}, {1, std::nan("")}, {}, {}}}, {}), InvalidArgument);
}

}  // namespace
}  // namespace mindahl::loop::preparation_test
