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

TEST(OutOfMemoryText, HasThePeakOfTheProcess) {
  const std::uintmax_t before = PeakOfStatus();
  if (before == 0) GTEST_SKIP() << "no /proc/self/status";
  // The kernel adds the counts of the processors from time to time, so that the peak may lag by a
  // tenth. It also counts the peak of the program that started this one, which may be far larger;
  // an error of the unit would be a factor of 1000 or more.
  const std::string text = OutOfMemoryText();
  constexpr std::string_view kBefore = "memory ran out: the process had ";
  ASSERT_TRUE(text.starts_with(kBefore)) << text;
  const double peak = 1e6 * std::stod(text.substr(kBefore.size()));
  ASSERT_THAT(text.substr(kBefore.size()), HasSubstr(" MB and may have "));
  const double ratio = peak / static_cast<double>(before);
  EXPECT_GT(ratio, 0.9);
  EXPECT_LT(ratio, 100.0);
}

TEST(RunProgram, SucceedsWhereItsStatusIsNought) {
  ProgramOutput written;
  EXPECT_EQ(RunProgram({"cat"}, "a line\n", written), 0);
  EXPECT_TRUE(written.succeeded);
  EXPECT_EQ(written.output, "a line\n");
  EXPECT_EQ(RunProgram({"sh", "-c", "echo cannot >&2; exit 3"}, "", written), 0);
  EXPECT_FALSE(written.succeeded);
  EXPECT_EQ(written.messages, "cannot\n");
  written.succeeded = true;
  EXPECT_EQ(RunProgram({"sh", "-c", "kill $$"}, "", written), 0);
  EXPECT_FALSE(written.succeeded);
  EXPECT_EQ(RunProgram({"no such program"}, "", written), ENOENT);
}

}  // namespace
}  // namespace mindahl::platform_test
