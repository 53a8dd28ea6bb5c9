#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

#include "mindahl/io/output_file.h"
#include "support/prelude.h"
#include "temporary_directory.h"

namespace mindahl::io::temporary_names_test {
namespace {

/// Restores what signals do by default: a test started in the background of a script ignores
/// SIGINT, one started by nohup SIGHUP, and so would the program.
void RestoreDefaultSignals() {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) std::signal(signal, SIG_DFL);
}

TEST(TemporaryFiles, GoWithTheProgramThatASignalEnds) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    const TemporaryDirectory directory;
    std::array<int, 2> ready{};
    ASSERT_EQ(::pipe(ready.data()), 0);
    const pid_t child = ::fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      RestoreDefaultSignals();
      RemoveTemporaryFilesOnSignals();
      const std::string content(1U << 20U, '7');
      for (std::size_t written = 0;; ++written) {
        WriteFileAtomically(directory.path() / "whole", content);
        if (written == 0) (void)!::write(ready[1], "!", 1);
      }
    }
    char byte = 0;
    ASSERT_EQ(::read(ready[0], &byte, 1), 1);
    ::close(ready[0]);
    ::close(ready[1]);
    ASSERT_EQ(::kill(child, signal), 0);
    int status = 0;
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == signal) << status;
    EXPECT_EQ(directory.FileCount(), 1U);
    EXPECT_EQ(FileContent(directory.path() / "whole").size(), 1U << 20U);
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

TEST(TemporaryFiles, LeaveASignalThatIsIgnoredAlone) {
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
