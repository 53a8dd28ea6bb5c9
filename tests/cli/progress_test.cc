#include <fcntl.h>
#include <stdlib.h>
#include <unistd.h>

#include <chrono>
#include <iostream>
#include <sstream>
#include <thread>

#include "cli/output.h"
#include "support/prelude.h"

// What whoever waits at a terminal sees, and that nobody else does.
namespace mindahl::cli::progress_test {
namespace {

constexpr const char* kErase = "\r\x1b[K";

/// To be shown where patience is 0.
constexpr std::chrono::milliseconds kLongEnough{200};

/// Both ends of a pseudo-terminal, or -1 for the second where the machine has none mounted.
std::array<int, 2> OpenTerminal() {
  std::array<int, 2> ends{::posix_openpt(O_RDWR | O_NOCTTY), -1};
  if (ends[0] < 0 || ::grantpt(ends[0]) != 0 || ::unlockpt(ends[0]) != 0) return ends;
  const char* const name = ::ptsname(ends[0]);
  if (name != nullptr) ends[1] = ::open(name, O_RDWR | O_NOCTTY);
  return ends;
}

/// Standard error on a pseudo-terminal, or on a pipe, until this ends.
class Redirected {
 public:
  explicit Redirected(bool terminal) : saved_(::dup(STDERR_FILENO)) {
    std::array<int, 2> ends{-1, -1};
    if (terminal) {
      ends = OpenTerminal();
    } else {
      EXPECT_EQ(::pipe(ends.data()), 0);
    }
    EXPECT_GE(ends[1], 0);
    reads_ = ends[0];
    ::dup2(ends[1], STDERR_FILENO);
    ::close(ends[1]);
  }
  ~Redirected() {
    Restore();
    ::close(reads_);
  }
  Redirected(const Redirected&) = delete;
  Redirected& operator=(const Redirected&) = delete;

  void Restore() {
    if (saved_ < 0) return;
    ::dup2(saved_, STDERR_FILENO);
    ::close(saved_);
    saved_ = -1;
  }

  /// Waits for some text that ends so.
  std::string ReadTo(const std::string& end) const {
    std::string text;
    while (!text.ends_with(end)) {
      std::array<char, 256> some{};
      const ssize_t count = ::read(reads_, some.data(), some.size());
      if (count <= 0) break;
      text.append(some.data(), static_cast<std::size_t>(count));
    }
    return text;
  }

 private:
  int saved_;
  int reads_ = -1;
};

/// Skipped where there is no terminal to show anything on.
class ProgressOnATerminal : public ::testing::Test {
 protected:
  void SetUp() override {
    const std::array<int, 2> ends = OpenTerminal();
    for (const int end : ends) {
      if (end >= 0) ::close(end);
    }
    if (ends[1] < 0) GTEST_SKIP() << "this machine has no pseudo-terminal mounted (/dev/pts)";
  }
};

TEST_F(ProgressOnATerminal, IsShownAndErasedAtItsEnd) {
  Redirected terminal(/*terminal=*/true);
  std::string shown;
  {
    const Progress progress(std::cerr, "fitting 10001 samples", std::chrono::milliseconds(0));
    shown = terminal.ReadTo(" s");
  }
  const std::string last = terminal.ReadTo(kErase);
  terminal.Restore();
  EXPECT_THAT(shown, HasSubstr("mindahl: fitting 10001 samples, 0 s"));
  EXPECT_THAT(last, EndsWith(kErase));
  EXPECT_THAT(shown + last, Not(HasSubstr("\n"))) << "one line";
}

TEST_F(ProgressOnATerminal, SaysWhatComesNext) {
  Redirected terminal(/*terminal=*/true);
  {
    Progress progress(std::cerr, "one", std::chrono::milliseconds(0));
    progress.Say("another");
    terminal.ReadTo("another, 1 s");
  }
  const std::string last = terminal.ReadTo(kErase);
  terminal.Restore();
  EXPECT_THAT(last, EndsWith(kErase));
}

TEST_F(ProgressOnATerminal, IsNotShownForShortRuns) {
  Redirected terminal(/*terminal=*/true);
  { const Progress progress(std::cerr, "fitting"); }
  std::cerr << "done" << std::flush;
  const std::string all = terminal.ReadTo("done");
  terminal.Restore();
  EXPECT_EQ(all, "done");
}

TEST(Progress, IsNotShownInAPipe) {
  Redirected pipe(/*terminal=*/false);
  {
    const Progress progress(std::cerr, "fitting", std::chrono::milliseconds(0));
    std::this_thread::sleep_for(kLongEnough);
  }
  std::cerr << "done" << std::flush;
  EXPECT_EQ(pipe.ReadTo("done"), "done");
}

TEST_F(ProgressOnATerminal, IsNotShownWhereMessagesGoElsewhere) {
  Redirected terminal(/*terminal=*/true);
  const std::ostringstream elsewhere;
  {
    const Progress progress(elsewhere, "fitting", std::chrono::milliseconds(0));
    std::this_thread::sleep_for(kLongEnough);
  }
  std::cerr << "done" << std::flush;
  EXPECT_EQ(terminal.ReadTo("done"), "done");
}

}  // namespace
}  // namespace mindahl::cli::progress_test
