#include "mindahl/models/loading_path.h"

#include "../support/histories.h"
#include "mindahl/loop/reversals.h"
#include "support/prelude.h"

namespace mindahl::models::loading_path_test {
namespace {

using namespace loop;

LoadingPath MasingPath(const History& history, const InitialContact& initial = {},
                       double gate = 0.0) {
  return MakeLoadingPath(history, FindReversals(history, gate), Memory::kReturnPoint, initial);
}

LoadingPath MemorylessPath(const History& history, const InitialContact& initial = {}) {
  return MakeLoadingPath(history, FindReversals(history, 0.0), Memory::kNone, initial);
}

/// Origins of the branches that the last sample's branch goes back to, youngest first.
std::vector<double> OriginsAtTheEnd(const LoadingPath& path) {
  std::vector<double> origins;
  for (std::int32_t i = path.runs.back().branch; i >= 0;) {
    const Branch& branch = path.branches[static_cast<std::size_t>(i)];
    origins.push_back(branch.origin);
    i = branch.parent;
  }
  return origins;
}

using Origins = std::vector<double>;

TEST(LoadingPath, StartsOnTheVirginCurve) {
  const LoadingPath path = MasingPath({0.5, 1.0, 2.0});
  ASSERT_EQ(path.branches.size(), 1U);
  EXPECT_EQ(path.branches[0].start, BranchStart::kUnloaded);
  EXPECT_EQ(path.branches[0].origin, 0.0);
  EXPECT_EQ(path.branches[0].direction, 1.0);
  EXPECT_EQ(path.branches[0].parent, -1);
}

TEST(LoadingPath, AReversalOpensABranchFromTheExtremum) {
  const LoadingPath path = MasingPath({1.0, 3.0, 2.0});
  EXPECT_EQ(OriginsAtTheEnd(path), (Origins{3.0, 0.0}));
  EXPECT_EQ(path.branches.back().direction, -1.0);
  EXPECT_EQ(path.branches.back().start, BranchStart::kReversal);
}

TEST(LoadingPath, GoesBackToTheExtremaThatMadelungsRulesLeave) {
  struct Rule {
    std::string_view name;
    History history;
    Origins origins;
  };
  for (const Rule& rule : std::initializer_list<Rule>{
           {"every extremum of a nested history", {4, -3, 2, -1, 0.5}, {-1, 2, -3, 4, 0}},
           {"an inner loop stays until it is passed", {4, 0, 2, 0.1}, {2, 0, 4, 0}},
           {"an inner loop is erased when passed", {4, 0, 2, -0.1}, {4, 0}},
           {"reaching the extremum exactly is passing it", {4, 0, 2, 0}, {4, 0}},
           {"so it is downwards", {-4, 0, -2, 0}, {-4, 0}},
           {"one of several loops in a step", {4, -3, 2, -1, 1, -2}, {2, -3, 4, 0}},
           {"several loops in a step", {4, -3, 2, -1, 1, -3.5}, {4, 0}},
           {"short of the first extremum", {4, 1, 3.999}, {1, 4, 0}},
           {"the virgin curve is rejoined at its first extremum", {4, 1, 4}, {0}},
           {"short of its mirror image", {4, -3.999}, {4, 0}},
           {"or at its mirror image", {4, -4}, {0}},
           {"or beyond, with loops on the way", {4, 1, 2, -1, 0, -5}, {0}},
           {"the new extremum is the first then", {2, -3, 2.9}, {-3, 0}},
           {"whose mirror image counts", {2, -3, 3}, {0}},
           // Up to 2 before the record, then down: 2 is an extremum although no sample turns there.
           {"a first row away from the unloaded contact is a step", {2, 1, 0}, {2, 0}},
           {"which may go on", {2, 3}, {0}},
           {"or turn", {-2, -1, -1.5}, {-1, -2, 0}},
           {"a first row at the unloaded contact is none", {0, -1, -2}, {0}},
           {"a dwell at an extremum opens nothing", {3, 3, 3, 1, 1, 2}, {1, 3, 0}},
           {"a single sample", {0.7}, {0}},
           {"a constant record", {0.7, 0.7, 0.7}, {0}}}) {
    EXPECT_EQ(OriginsAtTheEnd(MasingPath(rule.history)), rule.origins) << rule.name;
  }
  EXPECT_EQ(MasingPath({0, -1, -2}).branches.front().direction, -1.0);
  EXPECT_EQ(MasingPath({3, 3, 3, 1, 1, 2}).branches.size(), 3U);
}

TEST(LoadingPath, TheMirrorImageIsTakenAboutTheUnloadedDisplacement) {
  const InitialContact at_one{.unloaded_displacement = 1.0};
  EXPECT_EQ(OriginsAtTheEnd(MasingPath({4, -1.9}, at_one)), (Origins{4, 1}));
  EXPECT_EQ(OriginsAtTheEnd(MasingPath({4, -2}, at_one)), (Origins{1}));
}

TEST(LoadingPath, StartingDownwardIsTheMirrorImage) {
  Generator generator(21);
  for (int i = 0; i < 500; ++i) {
    History history = testing::RandomHistory(generator);
    const LoadingPath up = MasingPath(history);
    for (double& displacement : history) displacement = -displacement;
    const LoadingPath down = MasingPath(history);
    ASSERT_EQ(up.branches.size(), down.branches.size());
    for (std::size_t k = 0; k < up.branches.size(); ++k) {
      ASSERT_EQ(up.branches[k].origin, -down.branches[k].origin);
      ASSERT_EQ(up.branches[k].direction, -down.branches[k].direction);
      ASSERT_EQ(up.branches[k].parent, down.branches[k].parent);
    }
  }
}

TEST(LoadingPath, GatedNoiseOpensNothing) {
  const History noisy = {1, 2, 1.9, 3, 2.95, 4, 3, 3.1, 1, 1.05, 0};
  EXPECT_EQ(MasingPath(noisy, {}, 0.2).branches.size(), 2U);
  EXPECT_EQ(OriginsAtTheEnd(MasingPath(noisy, {}, 0.2)), (Origins{4, 0}));
  EXPECT_GT(MasingPath(noisy).branches.size(), 2U);
}

TEST(LoadingPath, RunsCoverEverySampleInOrderAndParentsComeFirst) {
  Generator generator(22);
  for (int i = 0; i < 1000; ++i) {
    const History history = testing::RandomHistory(generator);
    for (const InitialState state : {InitialState::kVirgin, InitialState::kSteady}) {
      for (const Memory memory : {Memory::kReturnPoint, Memory::kNone}) {
        const LoadingPath path =
            MakeLoadingPath(history, FindReversals(history, 0.0), memory, {.state = state});
        std::size_t next = 0;
        for (const BranchRun& run : path.runs) {
          ASSERT_EQ(run.begin, next);
          ASSERT_LT(run.begin, run.end);
          next = run.end;
        }
        ASSERT_EQ(next, history.size());
        for (std::size_t k = 0; k < path.branches.size(); ++k) {
          ASSERT_LT(path.branches[k].parent, static_cast<std::int32_t>(k));
        }
      }
    }
  }
}

TEST(LoadingPath, ASteadyContactStartsInsideItsLoop) {
  // Upward from mid-swing: on the branch from the lower extreme, which answers the upper.
  const LoadingPath path = MasingPath({0, 1, -3, 0}, {.state = InitialState::kSteady});
  const Branch& first = path.branches[static_cast<std::size_t>(path.runs.front().branch)];
  EXPECT_EQ(first.origin, -3.0);
  EXPECT_EQ(first.direction, 1.0);
  EXPECT_EQ(path.branches[static_cast<std::size_t>(first.parent)].origin, 1.0);
  EXPECT_EQ(path.branches[0].start, BranchStart::kSteadyCentre);
  EXPECT_EQ(path.branches[0].origin, -1.0);
}

TEST(LoadingPath, ASteadyContactWithoutMemoryStartsAtAnExtremeOfItsLoop) {
  const LoadingPath path = MemorylessPath({0, -3, 1, 0}, {.state = InitialState::kSteady});
  EXPECT_EQ(path.branches[0].start, BranchStart::kSteadyExtreme);
  EXPECT_EQ(path.branches[0].amplitude, 2.0);
  EXPECT_EQ(path.branches[0].origin, 1.0);
  EXPECT_EQ(path.branches[0].direction, -1.0);
}

TEST(LoadingPath, WithoutMemoryEveryReversalStartsFromTheLast) {
  EXPECT_EQ(OriginsAtTheEnd(MemorylessPath({4, 0, 2, -0.1})), (Origins{2, 0, 4, 0}));
}

TEST(LoadingPath, RejectsInvalidHistory) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(MakeLoadingPath({}, {}, Memory::kNone, {}), InvalidArgument);
  const History bad = {0, kNan};
  EXPECT_THROW(MakeLoadingPath(bad, {}, Memory::kNone, {}), InvalidArgument);
  const History good = {0, 1};
  EXPECT_THROW(MakeLoadingPath(good, {}, Memory::kNone, {.unloaded_displacement = kNan}),
               InvalidArgument);
}

}  // namespace
}  // namespace mindahl::models::loading_path_test
