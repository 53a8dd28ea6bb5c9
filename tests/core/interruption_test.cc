#include "mindahl/core/interruption.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace mindahl {
namespace {

TEST(Interruption, AsksTheInnermostOfItsThreadAndLetsItEndTheWork) {
  int asked = 0;
  const Interruptible outer([&] { ++asked; });
  AskWhetherToGoOn();
  EXPECT_LE(asked, 1);  // not again before 50 ms have passed
  {
    const Interruptible inner([] { throw std::runtime_error("stop"); });
    EXPECT_THROW(for (;;) AskWhetherToGoOn(), std::runtime_error);
  }
  const int before = asked;
  while (asked == before) AskWhetherToGoOn();
}

}  // namespace
}  // namespace mindahl
