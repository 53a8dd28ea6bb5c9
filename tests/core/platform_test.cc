#include "core/platform.h"

#include "support/prelude.h"

namespace mindahl::platform_test {
namespace {

TEST(OutputOfACommand, IsThereWhereItsStatusIsNought) {
  EXPECT_EQ(OutputOf("cat", "a line\n"), "a line\n");
  for (const char* command : {"echo cannot >&2; exit 3", "kill $$", "no-such-program"}) {
    EXPECT_FALSE(OutputOf(command, "")) << command;
  }
}

}  // namespace
}  // namespace mindahl::platform_test
