#include "core/platform.h"

#include <cerrno>

#include "support/prelude.h"

namespace mindahl::platform_test {
namespace {

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
