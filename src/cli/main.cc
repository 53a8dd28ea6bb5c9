#include <iostream>

#include "cli/app.h"
#include "core/platform.h"

int main(int argc, char** argv) {
  mindahl::KeepFreedMemory();
  mindahl::IgnoreFileSizeSignal();
  return mindahl::cli::Run(argc, argv, std::cout, std::cerr);
}
