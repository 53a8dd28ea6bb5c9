

#include "identification/diagnosis/diagnosis.h"
#include "mindahl/identification/fit_result.h"
#include "recovery/recovered.h"
#include "support/prelude.h"

// Branches compared with each other: is a record of Masing's memory, of Dahl's, or of neither?
namespace mindahl::identification::memory_test {
namespace {

using namespace models;

using loop::Record;

constexpr BranchLaw kMindlin{4e7, 1.0 / 3, 40.0};
constexpr double kGrossSlip = 1.5e-6;  // [m]
constexpr int kPerCycle = 200;
constexpr double kNoise = 0.2;  // [N], 0.5 % of Tc
constexpr double kWide = 0.9 * kGrossSlip;

/// Of one sample to the next.
constexpr double kWhite = 0.0;
constexpr double kAutocorrelated = 0.7;

History OneAmplitude() { return Cycling(Wave::kSine, kWide, 3, kPerCycle); }

History TwoAmplitudes() {
  History displacement = Cycling(Wave::kSine, 0.5 * kGrossSlip, 2, kPerCycle);
  for (const double x : Cycling(Wave::kSine, kWide, 2, kPerCycle)) displacement.push_back(x);
  return displacement;
}

/// Strokes with loops within them, which are closed on the way.
History WithInnerLoops() {
  History displacement;
  const double start = 0.35 * std::sin(0.4);
  for (int i = 0; i <= 3 * kPerCycle; ++i) {
    const double phase = 2 * M_PI * i / kPerCycle;
    displacement.push_back(kGrossSlip *
                           (0.7 * std::sin(phase) + 0.35 * std::sin(3 * phase + 0.4) - start));
  }
  return displacement;
}

Record Of(const char* model, const History& displacement) {
  return MakeRecord(displacement, Respond(Model(model), kMindlin, displacement));
}

/// From the first extreme on, where nothing is left of the virgin branch.
Record Steady(const Record& record) { return From(record, kPerCycle / 4); }

/// Sixty contacts that set in one after the other as they are pressed down: a backbone that is none
/// of the law's.
Record Asperities(const History& displacement) {
  constexpr int kCount = 60;
  Record record = MakeRecord(displacement, std::vector<double>(displacement.size()));
  for (int i = 1; i <= kCount; ++i) {
    const double height = static_cast<double>(i) / kCount;  // of the highest
    const BranchLaw law{2 * std::sqrt(height) * kMindlin.tangential_stiffness / kCount, 1.0 / 3,
                        2 * std::pow(height, 1.5) * kMindlin.slip_force / kCount};
    const std::vector<double> force = Respond(Model("mindlin-dahl"), law, displacement);
    for (std::size_t k = 0; k < force.size(); ++k) record.force[k] += force[k];
  }
  return record;
}

/// A process of order one, of the deviation kNoise.
Record Noisy(Record record, double autocorrelation, Generator& generator) {
  double state = Normal(generator);
  const double innovation = std::sqrt(1 - autocorrelation * autocorrelation);
  for (double& force : record.force) {
    force += kNoise * state;
    state = autocorrelation * state + innovation * Normal(generator);
  }
  return record;
}

FitResult Thorough(const Record& record, const FitOptions& options = {}) {
  return Fit({&record, 1}, options, Depth::kThorough);
}

MemoryTest MemoryOf(const Record& record, const FitOptions& options = {}) {
  const FitResult fit = Thorough(record, options);
  EXPECT_TRUE(fit.memory);
  return fit.memory.value_or(MemoryTest{});
}

MemoryTest MemoryOfNoisy(const Record& record, std::uint64_t seed = 7) {
  Generator generator(seed);
  return MemoryOf(Noisy(record, kWhite, generator));
}

const MemoryComparison* Find(const MemoryTest& memory, std::string_view code) {
  const auto found = std::ranges::find(memory.comparisons, code, &MemoryComparison::code);
  return found == memory.comparisons.end() ? nullptr : &*found;
}

bool Rejects(const MemoryTest& memory, std::string_view code) {
  constexpr double kChance = 1e-6;
  const MemoryComparison* const comparison = Find(memory, code);
  return comparison != nullptr && comparison->p_value < kChance;
}

std::vector<Record> RecordsOf(const char* model) {
  return {Of(model, OneAmplitude()), Of(model, TwoAmplitudes()), Steady(Of(model, TwoAmplitudes())),
          Of(model, WithInnerLoops())};
}

TEST(Memory, IsMasingsForIdentifiableMasingContact) {
  for (const Record& record : RecordsOf("mindlin-dahl")) {
    const MemoryTest memory = MemoryOfNoisy(record);
    EXPECT_EQ(memory.verdict, MemoryVerdict::kMasing);
    EXPECT_GT(memory.p_value, 0.01);
    EXPECT_LT(memory.dahl_p_value, 1e-6);
  }
}

TEST(Memory, IsDahlsForDahlContactWhicheverLawIsFitted) {
  for (const char* fitted : {"mindlin-dahl", "dahl"}) {
    FitOptions options;
    options.model = &Model(fitted);
    for (const Record& record : RecordsOf("dahl")) {
      Generator generator(8);
      const MemoryTest memory = MemoryOf(Noisy(record, kWhite, generator), options);
      EXPECT_EQ(memory.verdict, MemoryVerdict::kDahl) << fitted;
      EXPECT_LT(memory.p_value, 1e-6) << fitted;
    }
  }
}

TEST(Memory, IsDeterminedWithoutNoiseToo) {
  for (const auto& [model, verdict] : {std::pair{"mindlin-dahl", MemoryVerdict::kMasing},
                                       std::pair{"dahl", MemoryVerdict::kDahl}}) {
    for (const Record& record : RecordsOf(model)) {
      EXPECT_EQ(MemoryOf(record).verdict, verdict) << model;
    }
  }
}

TEST(Memory, IsUndecidedOnASteadyLoopOfOneAmplitudeWhereBothAreOneCurve) {
  const MemoryTest memory = MemoryOfNoisy(Steady(Of("mindlin-dahl", OneAmplitude())));
  EXPECT_EQ(memory.verdict, MemoryVerdict::kUndecided);
  EXPECT_EQ(memory.p_value, memory.dahl_p_value);
  EXPECT_EQ(Find(memory, "virgin_branch"), nullptr);
  EXPECT_EQ(Find(memory, "amplitudes"), nullptr);
  EXPECT_EQ(Find(memory, "slope_at_reversal"), nullptr);
  EXPECT_NE(Find(memory, "directions"), nullptr);
}

TEST(Memory, IsMasingsWhateverTheBackbone) {
  for (const History& displacement : {TwoAmplitudes(), WithInnerLoops()}) {
    const MemoryTest memory = MemoryOfNoisy(Asperities(displacement));
    EXPECT_EQ(memory.verdict, MemoryVerdict::kMasing);
  }
}

TEST(Memory, IsNeitherWhereTheStiffnessDiffersByDirection) {
  Record record = Of("mindlin-dahl", OneAmplitude());
  for (std::size_t i = 1; i < record.size(); ++i) {
    const bool falls = record.displacement[i] < record.displacement[i - 1];
    const double share = record.force[i] / kMindlin.slip_force;
    if (falls) record.force[i] -= 5 * kNoise * (1 - share * share);
  }
  const MemoryTest memory = MemoryOfNoisy(record);
  EXPECT_EQ(memory.verdict, MemoryVerdict::kNeither);
  EXPECT_TRUE(Rejects(memory, "directions"));
}

TEST(Memory, IsNeitherWithHardeningSpringInParallel) {
  Record record = Of("mindlin-dahl", OneAmplitude());
  for (std::size_t i = 0; i < record.size(); ++i) {
    record.force[i] += 20 * kNoise * std::pow(record.displacement[i] / kWide, 3);
  }
  const MemoryTest memory = MemoryOfNoisy(record);
  EXPECT_EQ(memory.verdict, MemoryVerdict::kNeither);
  EXPECT_TRUE(Rejects(memory, "virgin_branch"));
}

TEST(Memory, ReportsBehaviourAfterInnerLoopsIfThereAreAny) {
  EXPECT_FALSE(Find(MemoryOfNoisy(Of("mindlin-dahl", OneAmplitude())), "return_point"));
  EXPECT_TRUE(Find(MemoryOfNoisy(Of("mindlin-dahl", WithInnerLoops())), "return_point"));
  EXPECT_TRUE(Rejects(MemoryOfNoisy(Of("dahl", WithInnerLoops())), "return_point"));
}

// Eq. 12: σ(1 + T*/Tc)^α after a reversal by Dahl's own law, σ by Masing's rule.
TEST(Memory, HasSlopesThatGrowWithTheForceAtTheReversalByDahlsLawAlone) {
  EXPECT_TRUE(Rejects(MemoryOfNoisy(Steady(Of("dahl", TwoAmplitudes()))), "slope_at_reversal"));
  EXPECT_FALSE(
      Rejects(MemoryOfNoisy(Steady(Of("mindlin-dahl", TwoAmplitudes()))), "slope_at_reversal"));
}

/// How many of a law's noisy loops are denied its memory at 5 %.
std::size_t Denied(const char* model, double MemoryTest::*p_value, std::size_t each) {
  std::size_t denied = 0;
  Generator generator(9);
  for (const double autocorrelation : {kWhite, kAutocorrelated}) {
    for (const Record& record : RecordsOf(model)) {
      for (std::size_t k = 0; k < each; ++k) {
        const MemoryTest memory = MemoryOf(Noisy(record, autocorrelation, generator));
        if (memory.*p_value < 0.05) ++denied;
      }
    }
  }
  return denied;
}

/// At 5 %: noise makes as few, or as many, once in a thousand.
void ExpectOneInTwenty(std::size_t denied, std::size_t loops) {
  const auto count = static_cast<double>(loops);
  const double deviations = 3.3;  // of the binomial law: Φ(−3.3) = 1/2000
  EXPECT_NEAR(static_cast<double>(denied), 0.05 * count,
              deviations * std::sqrt(0.05 * 0.95 * count));
}

TEST(Memory, IsDeniedToOneLoopInTwentyAtThatChance) {
  constexpr std::size_t kEach = 12;
  ExpectOneInTwenty(Denied("mindlin-dahl", &MemoryTest::p_value, kEach), 8 * kEach);
  ExpectOneInTwenty(Denied("dahl", &MemoryTest::dahl_p_value, kEach), 8 * kEach);
}

TEST(MemoryOfThousandLoops, IsDeniedToOneInTwentyAtThatChance) {
  constexpr std::size_t kEach = 125;
  const std::size_t masing = Denied("mindlin-dahl", &MemoryTest::p_value, kEach);
  const std::size_t dahl = Denied("dahl", &MemoryTest::dahl_p_value, kEach);
  RecordProperty("masing", static_cast<int>(masing));
  RecordProperty("dahl", static_cast<int>(dahl));
  ExpectOneInTwenty(masing, 8 * kEach);
  ExpectOneInTwenty(dahl, 8 * kEach);
}

TEST(Memory, IsNotAskedWhereBranchesAreNoCopiesOfEachOther) {
  const Record record = Of("mindlin-dahl", TwoAmplitudes());
  FitOptions held;
  held.fixed["sigma"] = kMindlin.tangential_stiffness;
  EXPECT_FALSE(Thorough(record, held).memory);
  FitOptions lagging;
  lagging.terms = {"lag"};
  EXPECT_FALSE(Thorough(record, lagging).memory);
  History one_way = OneAmplitude();
  one_way.resize(kPerCycle / 4);
  EXPECT_FALSE(Thorough(Of("mindlin-dahl", one_way)).memory);
}

TEST(Memory, OfTooFewSamplesIsUndecided) {
  const History displacement = Cycling(Wave::kSine, kWide, 2, 40);
  const MemoryTest memory = MemoryOfNoisy(Of("mindlin-dahl", displacement));
  EXPECT_EQ(memory.verdict, MemoryVerdict::kUndecided);
  EXPECT_TRUE(memory.comparisons.empty());
}

TEST(Memory, ContradictsALawThatIsBetterWithTheOtherMemory) {
  const FrictionModel& masing = Model("mindlin-dahl");
  LawChoice choice;
  choice.decided = true;
  choice.preferred = &masing;
  choice.alternative = &Model("dahl");
  choice.delta_aicc = 50.0;
  MemoryTest memory;
  for (const auto& [verdict, contradicts] :
       {std::pair{MemoryVerdict::kMasing, false}, std::pair{MemoryVerdict::kUndecided, false},
        std::pair{MemoryVerdict::kNeither, false}, std::pair{MemoryVerdict::kDahl, true}}) {
    memory.verdict = verdict;
    const std::optional<Finding> finding = FindContradictedLaw(memory, choice, masing);
    EXPECT_EQ(finding.has_value(), contradicts);
    if (finding) {
      EXPECT_EQ(finding->kind, "masing");
    }
  }
  choice.preferred = &Model("dahl");
  choice.delta_aicc = -50.0;
  memory.verdict = MemoryVerdict::kMasing;
  const std::optional<Finding> finding = FindContradictedLaw(memory, choice, masing);
  ASSERT_TRUE(finding);
  EXPECT_EQ(finding->kind, "dahl");
  EXPECT_EQ(finding->Number("delta_aicc"), 50.0);
  choice.preferred = nullptr;
  EXPECT_FALSE(FindContradictedLaw(memory, choice, masing));
}

}  // namespace
}  // namespace mindahl::identification::memory_test
