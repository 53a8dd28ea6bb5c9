#include <set>

#include "kind.h"
#include "mindahl/loop/record.h"
#include "support/prelude.h"

namespace mindahl::reliability::kinds_test {
namespace {

constexpr std::uint64_t kSeed = 7;

TEST(Kinds, MakeConsistentRecordsAndAskForSomethingThatIsPossible) {
  std::set<std::string_view> names;
  for (const Kind& kind : Kinds()) {
    SCOPED_TRACE(kind.name);
    EXPECT_TRUE(names.insert(kind.name).second);
    for (std::size_t level = 0; level < kLevels; ++level) {
      const Loop loop = MakeLoop(kind, level, kSeed);
      EXPECT_GE(loop.record.size(), 6U);
      EXPECT_NO_THROW(loop::Validate(loop.record)) << "level " << level + 1;
    }
    const Expected expected = MakeLoop(kind, 0, kSeed).expected;
    EXPECT_TRUE(expected.sigma || expected.slip_force);
    for (const auto& truth : {expected.sigma, expected.alpha, expected.slip_force}) {
      EXPECT_TRUE(!truth || truth->lowest <= truth->highest);
    }
  }
}

TEST(Kinds, MakeTheSameLoopOfTheSameSeedAndAnotherOfAnother) {
  for (const Kind& kind : Kinds()) {
    SCOPED_TRACE(kind.name);
    const loop::Record record = MakeLoop(kind, 1, kSeed).record;
    EXPECT_EQ(MakeLoop(kind, 1, kSeed).record.force, record.force);
    EXPECT_NE(MakeLoop(kind, 1, kSeed + 1).record.force, record.force);
    EXPECT_NE(MakeLoop(kind, 2, kSeed).record.force, record.force);
  }
}

TEST(Kinds, OfEveryFamilyAreInBothHalves) {
  for (const auto family : {NoiseKinds, ChannelKinds, LoggerKinds, RigKinds, ContactKinds,
                            LoadKinds, SamplingKinds, ExcitationKinds}) {
    const std::vector<Kind> kinds = family();
    for (const Half half : {Half::kDevelopment, Half::kHeldOut}) {
      EXPECT_NE(std::ranges::find(kinds, half, &Kind::half), kinds.end()) << kinds.front().name;
    }
  }
}

}  // namespace
}  // namespace mindahl::reliability::kinds_test
