#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>

#include "io/unfinished_output.h"
#include "mindahl/io/output_file.h"
#include "support/prelude.h"
#include "temporary_directory.h"

namespace mindahl::io::temporary_names_test {
namespace {

TEST(TemporaryName, GoesWithItsObjectUnlessItIsKept) {
  const TemporaryDirectory directory;
  for (const bool kept : {false, true}) {
    {
      TemporaryName name(directory.Write("begun", "half").string());
      if (kept) name.Keep();
    }
    EXPECT_EQ(directory.FileCount(), kept ? 1u : 0u);
  }
}

/// Restores what signals do by default: a test started in the background of a script ignores
/// SIGINT, one started by nohup SIGHUP, and so would the program.
void RestoreDefaultSignals() {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) std::signal(signal, SIG_DFL);
}

TEST(TemporaryName, GoesWithTheProgramThatASignalEnds) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    const TemporaryDirectory directory;
    std::array<int, 2> ready{};
    ASSERT_EQ(::pipe(ready.data()), 0);
    const pid_t child = ::fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      RestoreDefaultSignals();
      RemoveTemporaryFilesOnSignals();
      const TemporaryName scratch((directory.path() / "scratch").string());
      std::filesystem::create_directory(scratch.name());
      const TemporaryName within(directory.Write("scratch/output", "half").string());
      TemporaryName kept(directory.Write("kept", "whole").string());
      const TemporaryName begun(directory.Write("begun", "half").string());
      { const TemporaryName gone(directory.Write("gone", "").string()); }
      kept.Keep();
      (void)!::write(ready[1], "!", 1);
      for (;;) ::pause();
    }
    char byte = 0;
    ASSERT_EQ(::read(ready[0], &byte, 1), 1);
    ::close(ready[0]);
    ::close(ready[1]);
    ASSERT_EQ(::kill(child, signal), 0);
    int status = 0;
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == signal) << status;
    EXPECT_FALSE(std::filesystem::exists(directory.path() / "begun"));
    EXPECT_FALSE(std::filesystem::exists(directory.path() / "scratch"));
    EXPECT_TRUE(std::filesystem::exists(directory.path() / "kept"));
  }
}

/// Runs a part of a program and returns how it ended, as waitpid() states it.
template <typename Part>
int StatusOf(Part part) {
  const pid_t child = ::fork();
  if (child == 0) part();
  int status = 0;
  EXPECT_EQ(::waitpid(child, &status, 0), child);
  return status;
}

TEST(DeferredSignals, NotesTheFirstAndEndsTheProgramAfterwards) {
  const int status = StatusOf([] {
    RestoreDefaultSignals();
    RemoveTemporaryFilesOnSignals();
    RaiseNotedSignal();  // of none
    {
      const DeferredSignals deferred;
      if (deferred.noted() != 0) ::_exit(1);
      ::raise(SIGTERM);
      if (deferred.noted() != SIGTERM) ::_exit(2);
    }
    RaiseNotedSignal();
    ::_exit(3);
  });
  EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGTERM) << status;
}

TEST(DeferredSignals, InterruptWhatWaitsForInput) {
  std::array<int, 2> pipe{};
  ASSERT_EQ(::pipe(pipe.data()), 0);
  const int status = StatusOf([&] {
    RestoreDefaultSignals();
    RemoveTemporaryFilesOnSignals();
    const DeferredSignals deferred;
    ::raise(SIGINT);  // before the wait begins
    char byte = 0;
    ::_exit(::read(pipe[0], &byte, 1) == -1 && errno == EINTR ? 7 : 1);
  });
  ::close(pipe[0]);
  ::close(pipe[1]);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 7) << status;
}

TEST(TemporaryName, LeavesASignalThatIsIgnoredAlone) {
  const int status = StatusOf([] {
    std::signal(SIGHUP, SIG_IGN);
    RemoveTemporaryFilesOnSignals();
    ::raise(SIGHUP);
    ::_exit(7);
  });
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 7);
}

}  // namespace
}  // namespace mindahl::io::temporary_names_test
