#include "cli/progress.h"

#include <fmt/format.h>

#include <iostream>
#include <string_view>
#include <utility>

#include "core/platform.h"

namespace mindahl::cli {

Progress::Progress(const std::ostream& messages, std::string what,
                   std::chrono::milliseconds patience)
    : what_(std::move(what)) {
  if (&messages != &std::cerr || !IsTerminal(Stream::kMessages)) return;
  thread_ = std::jthread([this, patience](const std::stop_token& stop) { Run(stop, patience); });
}

Progress::~Progress() {
  if (!thread_.joinable()) return;
  thread_.request_stop();
  thread_.join();
}

void Progress::Say(std::string what) {
  const std::lock_guard lock(mutex_);
  what_ = std::move(what);
}

void Progress::Run(const std::stop_token& stop, std::chrono::milliseconds patience) {
  constexpr std::chrono::seconds kEvery{1};
  constexpr std::string_view kErase = "\r\x1b[K";  // to the line's beginning, and what follows
  bool is_shown = false;
  std::unique_lock lock(mutex_);
  const auto wait_until = [&](std::chrono::steady_clock::time_point time) {
    ends_.wait_until(lock, stop, time, [] { return false; });
    return !stop.stop_requested();
  };
  for (auto next = start_ + patience; wait_until(next); next += kEvery) {
    const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(next - start_).count();
    WriteMessage(fmt::format("{}mindahl: {}, {} s", kErase, what_, seconds));
    is_shown = true;
  }
  if (is_shown) WriteMessage(kErase);
}

}  // namespace mindahl::cli
