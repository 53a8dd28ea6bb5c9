#include <iostream>

#include "cli/app.h"
#include "core/platform.h"
#include "mindahl/io/output_file.h"

int main(int argc, char** argv) {
  mindahl::KeepFreedMemory();
  mindahl::OccupyClosedStreams();
  mindahl::io::RemoveTemporaryFilesOnSignals();
  mindahl::IgnoreFileSizeSignal();
  return mindahl::cli::Run(argc, argv, std::cout, std::cerr);
}
