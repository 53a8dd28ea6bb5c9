#include <cstdlib>
#include <exception>
#include <iostream>
#include <new>

#include "cli/app.h"
#include "core/platform.h"

namespace {

const std::terminate_handler kDefaultEnd = std::get_terminate();

/// Ends a program whose memory ran out where no exception may leave, as in the destructor of a JSON
/// value, as it ends otherwise for want of memory; anything else as std::terminate() does.
[[noreturn]] void EndForWantOfMemory() {
  try {
    if (const std::exception_ptr error = std::current_exception()) std::rethrow_exception(error);
  } catch (const std::bad_alloc&) {
    mindahl::EndAtOnce("mindahl: memory ran out\n", mindahl::cli::kBadInput);
  } catch (...) {  // NOLINT(bugprone-empty-catch): ends below
  }
  kDefaultEnd();
  std::abort();
}

}  // namespace

int main(int argc, char** argv) {
  std::set_terminate(&EndForWantOfMemory);
  mindahl::KeepFreedMemory();
  mindahl::OccupyClosedStreams();
  mindahl::IgnoreFileSizeSignal();
  return mindahl::cli::Run(argc, argv, std::cout, std::cerr);
}
