#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <set>
#include <string>
#include <string_view>

#include "kind.h"
#include "mindahl/loop/record.h"

namespace mindahl::reliability {
namespace {

constexpr std::uint64_t kSeed = 7;

class EachKind : public testing::TestWithParam<Kind> {};

TEST_P(EachKind, MakesAConsistentRecordAtEveryLevel) {
  for (std::size_t level = 0; level < kLevels; ++level) {
    const Loop loop = MakeLoop(GetParam(), level, kSeed);
    EXPECT_GE(loop.record.size(), 6U);
    EXPECT_NO_THROW(loop::Validate(loop.record)) << "level " << level + 1;
  }
}

TEST_P(EachKind, MakesTheSameLoopOfTheSameSeedAndAnotherOfAnother) {
  const loop::Record record = MakeLoop(GetParam(), 1, kSeed).record;
  EXPECT_EQ(MakeLoop(GetParam(), 1, kSeed).record.force, record.force);
  EXPECT_NE(MakeLoop(GetParam(), 1, kSeed + 1).record.force, record.force);
  EXPECT_NE(MakeLoop(GetParam(), 2, kSeed).record.force, record.force);
}

TEST_P(EachKind, AsksSomethingThatIsPossible) {
  const Expected expected = MakeLoop(GetParam(), 0, kSeed).expected;
  EXPECT_TRUE(expected.sigma || expected.slip_force);
  for (const auto& truth : {expected.sigma, expected.alpha, expected.slip_force}) {
    if (!truth) continue;
    EXPECT_LE(truth->lowest, truth->highest);
  }
}

std::string NameOf(const testing::TestParamInfo<Kind>& kind) {
  std::string name(kind.param.name);
  std::erase_if(name, [](unsigned char character) { return std::isalnum(character) == 0; });
  return name;
}

INSTANTIATE_TEST_SUITE_P(Reliability, EachKind, testing::ValuesIn(Kinds()), NameOf);

TEST(Kinds, HaveNamesOfTheirOwn) {
  std::set<std::string_view> names;
  for (const Kind& kind : Kinds()) EXPECT_TRUE(names.insert(kind.name).second) << kind.name;
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
}  // namespace mindahl::reliability
