#include "mindahl/campaign/tracker.h"

#include "campaign/test_record.h"
#include "mindahl/campaign/cycle_fit.h"
#include "support/prelude.h"

namespace mindahl::campaign::tracker_test {
namespace {

constexpr std::size_t kCycles = 150;  // two batches and a part

/// The rows of a run, the samples given in pieces of that size.
std::vector<std::string> Rows(TrackOptions options, std::size_t piece = 1000) {
  static const loop::Record record = TestRecord(kCycles + 1);
  static const std::vector<std::size_t> lines = LinesOf(record);
  std::vector<std::string> rows;
  Tracker tracker(std::move(options), [&](std::span<const CycleFit> fits) {
    EXPECT_LE(fits.size(), kBatch);
    for (const CycleFit& fit : fits) rows.push_back(CycleTableRow(fit, 0.0));
  });
  for (std::size_t begin = 0; begin < record.size(); begin += piece) {
    const std::size_t size = std::min(piece, record.size() - begin);
    const auto part = [&](const std::vector<double>& values) {
      return std::span(values).subspan(begin, size);
    };
    tracker.Add({part(record.displacement), part(record.force), part(record.time)},
                std::span(lines).subspan(begin, size));
  }
  tracker.NextFile();
  tracker.Finish();
  return rows;
}

TEST(Tracker, HasTheSameRowsWhateverTheThreadsAndThePieces) {
  const std::vector<std::string> rows = Rows({});
  ASSERT_EQ(rows.size(), kCycles);
  for (const std::size_t threads : {2U, 3U, 8U}) {
    EXPECT_EQ(Rows({.threads = threads}, 77 * threads), rows) << threads;
  }
}

TEST(Tracker, BeginsAtALaterBatchWithItsRows) {
  const std::vector<std::string> rows = Rows({});
  for (const std::size_t skipped : {kBatch, 2 * kBatch}) {
    EXPECT_EQ(
        Rows({.skipped = skipped}),
        std::vector<std::string>(rows.begin() + static_cast<std::ptrdiff_t>(skipped), rows.end()));
  }
}

TEST(Tracker, FitsCyclesTogether) {
  const std::vector<std::string> together = Rows({.together = 5});
  ASSERT_EQ(together.size(), kCycles / 5);
  EXPECT_TRUE(together[1].starts_with("6,"));
  // 149 and 1: the last row has what is left.
  const std::vector<std::string> unequal = Rows({.together = kCycles - 1});
  ASSERT_EQ(unequal.size(), 2U);
  EXPECT_TRUE(unequal[1].starts_with("150,"));
}

TEST(Tracker, RefusesOptionsBeforeItBegins) {
  using Change = std::function<void(TrackOptions&)>;
  for (const Change& change :
       {Change([](TrackOptions& options) { options.threads = 0; }),
        Change([](TrackOptions& options) { options.fit.max_iterations = 0; })}) {
    TrackOptions options;
    change(options);
    EXPECT_THROW(Tracker(options, {}), InvalidArgument);
  }
}

}  // namespace
}  // namespace mindahl::campaign::tracker_test
