#pragma once

#include <chrono>
#include <condition_variable>
#include <iosfwd>
#include <mutex>
#include <stop_token>
#include <string>
#include <thread>

namespace mindahl::cli {

/// A line on standard error that says what the program is about, from two seconds on and every
/// second anew: "fitting 10001 samples, 3 s". Only where standard error is a terminal, and the
/// stream that messages go to; it is erased when this ends.
class Progress {
 public:
  /// @param messages  the console's; nothing is shown unless it is std::cerr
  /// @param patience  before it is first shown
  Progress(const std::ostream& messages, std::string what,
           std::chrono::milliseconds patience = std::chrono::seconds(2));
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// Replaces the text about the present work.
  void Say(std::string what);

 private:
  void Run(const std::stop_token& stop, std::chrono::milliseconds patience);

  std::mutex mutex_;  // of what_
  std::string what_;
  std::condition_variable_any ends_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  std::jthread thread_;  // the last: it uses the others
};

}  // namespace mindahl::cli
