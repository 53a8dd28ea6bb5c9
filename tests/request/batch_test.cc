#include "mindahl/request/batch.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "mindahl/core/error.h"
#include "support/histories.h"

namespace mindahl::request::batch_test {
namespace {

std::vector<io::RecordFile> CleanRecord() {
  io::RecordFile file;
  for (int i = 0; i <= 300; ++i) {
    file.record.displacement.push_back(3e-6 * std::sin(2 * std::numbers::pi * i / 100));
  }
  file.record.force = testing::Respond(testing::Model("mindlin-dahl"), {4e7, 1.0 / 3, 40.0},
                                       file.record.displacement);
  return {file};
}

TEST(FitSource, IsNotDoneWhereItsPageCannotBeWritten) {
  const auto read = [](const FitRequest&, const Tell&) { return CleanRecord(); };
  EXPECT_TRUE(FitSource({}, "loop", Strictness::kNone, read).done);
  const BatchEntry entry =
      FitSource({}, "loop", Strictness::kNone, read,
                [](const report::Report&) -> std::string { throw InputError("the disk is full"); });
  EXPECT_FALSE(entry.done);
  EXPECT_EQ(entry.result.fault, "the disk is full");
}

}  // namespace
}  // namespace mindahl::request::batch_test
