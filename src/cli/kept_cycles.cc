#include "cli/kept_cycles.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <vector>

#include "mindahl/campaign/tracker.h"
#include "mindahl/core/error.h"

namespace mindahl::cli {

KeptCycles ReadKeptCycles(const std::string& path, std::string_view header,
                          const std::function<void(const campaign::CycleTableEntry&)>& visit) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw InputError(fmt::format("cannot read '{}': {}", path, std::strerror(errno)));
  std::string line;
  std::getline(file, line);
  if (line + '\n' != header) {
    throw InputError(
        fmt::format("--resume: {} is no table of such cycles, its first line is another: give "
                    "another --output, or --overwrite",
                    path));
  }
  KeptCycles kept;
  kept.bytes = header.size();
  std::vector<std::string> batch;
  // A line without a line feed was being written when a run was killed, and is no row.
  while (std::getline(file, line) && !file.eof()) {
    batch.push_back(line);
    if (batch.size() < campaign::kBatch) continue;
    kept.last_batch.clear();
    for (const std::string& row : batch) {
      ++kept.fits;
      try {
        visit(campaign::ReadCycleTableRow(row));
      } catch (const InputError& error) {
        throw InputError(fmt::format("--resume: {}:{}: {}: give another --output, or --overwrite",
                                     path, kept.fits + 1, error.what()));
      }
      kept.last_batch += row + '\n';
    }
    kept.bytes += kept.last_batch.size();
    batch.clear();
  }
  return kept;
}

}  // namespace mindahl::cli
