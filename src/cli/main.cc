#include <fcntl.h>
#include <unistd.h>

#include <iostream>

#include "cli/app.h"
#include "mindahl/io/atomic_file.h"

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

}  // namespace

int main(int argc, char** argv) {
  OccupyClosedStreams();
  mindahl::io::RemoveTemporaryFilesOnSignals();
  return mindahl::cli::Run(argc, argv, std::cout, std::cerr);
}
