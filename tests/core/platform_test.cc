#include "core/platform.h"

#include <cerrno>
#include <filesystem>
#include <fstream>

#include "support/prelude.h"

namespace mindahl::platform_test {
namespace {

/// The most memory that the process has had [bytes], as the kernel counts it.
std::uintmax_t PeakOfStatus() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    std::uintmax_t kibibytes = 0;
    if (word == "VmHWM:" && status >> kibibytes) return 1024 * kibibytes;
  }
  return 0;
}

TEST(PeakMemory, IsThatOfTheProcess) {
  const std::uintmax_t before = PeakOfStatus();
  if (before == 0) GTEST_SKIP() << "no /proc/self/status";
  // The kernel adds the counts of the processors from time to time, so that the peak may lag by a
  // tenth. It also counts the peak of the program that started this one, which may be far larger;
  // an error of the unit would be a factor of 1000 or more.
  const double ratio = static_cast<double>(PeakMemory()) / static_cast<double>(before);
  EXPECT_GT(ratio, 0.9);
  EXPECT_LT(ratio, 100.0);
}

TEST(RunProgram, SucceedsWhereItsStatusIsNought) {
  const std::string messages = ::testing::TempDir() + "messages_of_a_program";
  bool succeeded = false;
  EXPECT_EQ(RunProgram({"true"}, messages, succeeded), 0);
  EXPECT_TRUE(succeeded);
  EXPECT_EQ(RunProgram({"sh", "-c", "echo cannot >&2; exit 3"}, messages, succeeded), 0);
  EXPECT_FALSE(succeeded);
  std::string line;
  std::getline(std::ifstream(messages), line);
  EXPECT_EQ(line, "cannot");
  succeeded = true;
  EXPECT_EQ(RunProgram({"sh", "-c", "kill $$"}, messages, succeeded), 0);
  EXPECT_FALSE(succeeded);
  EXPECT_EQ(RunProgram({"no such program"}, messages, succeeded), ENOENT);
  std::filesystem::remove(messages);
}

}  // namespace
}  // namespace mindahl::platform_test
