#include "mindahl/core/interruption.h"

#include <chrono>
#include <utility>

namespace mindahl {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::milliseconds kPause{50};

thread_local std::function<void()> ask_now;
thread_local Clock::time_point next_time;

}  // namespace

Interruptible::Interruptible(std::function<void()> ask)
    : before_(std::exchange(ask_now, std::move(ask))) {}

Interruptible::~Interruptible() { ask_now = std::move(before_); }

void AskWhetherToGoOn() {
  if (!ask_now) return;
  const Clock::time_point now = Clock::now();
  if (now < next_time) return;
  next_time = now + kPause;
  ask_now();
}

}  // namespace mindahl
