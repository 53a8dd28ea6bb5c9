#include <fcntl.h>
#include <malloc.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <exception>
#include <iostream>
#include <new>
#include <string_view>

#include "cli/app.h"
#include "mindahl/io/output_file.h"

namespace {

/// A standard stream that was closed by whoever started the program is occupied: the next file to
/// be opened would get its number, and what is printed.
void OccupyClosedStreams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (::fcntl(stream, F_GETFD) >= 0) continue;
    // Writing results must fail, writing messages need not.
    if (::open("/dev/null", stream == STDERR_FILENO ? O_WRONLY : O_RDONLY) != stream) return;
  }
}

/// Keeps what a fit's columns of samples take and give back, instead of asking the system for it
/// anew: a tenth of the time of a fit of 10,000 samples.
void KeepFreedMemory() {
#ifdef __GLIBC__
  constexpr int kMost = 1 << 30;  // [bytes]
  mallopt(M_MMAP_THRESHOLD, kMost);
  mallopt(M_TRIM_THRESHOLD, kMost);
#endif
}

const std::terminate_handler kDefaultEnd = std::get_terminate();

/// Ends a program whose memory ran out where no exception may leave, as in the destructor of a JSON
/// value, as it ends otherwise for want of memory; anything else as std::terminate() does.
[[noreturn]] void EndForWantOfMemory() {
  try {
    if (const std::exception_ptr error = std::current_exception()) std::rethrow_exception(error);
  } catch (const std::bad_alloc&) {
    constexpr std::string_view kMessage = "mindahl: memory ran out\n";
    (void)!::write(STDERR_FILENO, kMessage.data(), kMessage.size());
    mindahl::io::RemoveTemporaryFiles();
    ::_exit(mindahl::cli::kBadInput);
  } catch (...) {  // NOLINT(bugprone-empty-catch): ends below
  }
  kDefaultEnd();
  std::abort();
}

}  // namespace

int main(int argc, char** argv) {
  KeepFreedMemory();
  OccupyClosedStreams();
  std::set_terminate(&EndForWantOfMemory);
  mindahl::io::RemoveTemporaryFilesOnSignals();
  std::signal(SIGXFSZ, SIG_IGN);  // a file that may not grow is an error of its write()
  const int status = mindahl::cli::Run(argc, argv, std::cout, std::cerr);
  mindahl::io::RaiseNotedSignal();
  return status;
}
