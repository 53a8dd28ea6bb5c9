#include "cli/cycle_output.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <deque>
#include <fstream>
#include <numeric>

#include "mindahl/campaign/tracker.h"
#include "mindahl/core/error.h"

namespace mindahl::cli {
namespace {

std::ifstream Open(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw InputError(fmt::format("cannot read '{}': {}", path, std::strerror(errno)));
  return file;
}

/// Rows that end in a line feed: what was being written when a run was killed is none.
std::size_t CountWholeRows(const std::string& path, std::string_view header) {
  std::ifstream file = Open(path);
  std::string line;
  const std::string_view names = header.substr(0, header.size() - 1);
  if (!std::getline(file, line)) return 0;
  if (line != names) {
    throw InputError(
        fmt::format("--resume: {} is no table of such cycles, its first line is another: give "
                    "another --output, or --overwrite",
                    path));
  }
  std::size_t rows = 0;
  while (std::getline(file, line) && !file.eof()) ++rows;
  return rows;
}

}  // namespace

CycleOutput::Kept CycleOutput::Read(
    const std::string& path, std::string_view header,
    const std::function<void(const campaign::CycleTableEntry&)>& visit) {
  Kept kept;
  const std::size_t rows = CountWholeRows(path, header);
  kept.fits = rows / campaign::kBatch * campaign::kBatch;
  kept.bytes = header.size();
  std::ifstream file = Open(path);
  std::string line;
  std::getline(file, line);
  for (std::size_t row = 0; row < kept.fits; ++row) {
    std::getline(file, line);
    if (row + campaign::kBatch == kept.fits) {
      kept.energy_before_last_batch = kept.accumulated_energy;
    }
    try {
      const campaign::CycleTableEntry entry = campaign::ReadCycleTableRow(line);
      visit(entry);
      kept.accumulated_energy = entry.accumulated_energy;
    } catch (const InputError& error) {
      throw InputError(fmt::format("--resume: {}:{}: {}: give another --output, or --overwrite",
                                   path, row + 2, error.what()));
    }
    kept.bytes += line.size() + 1;
    if (row + campaign::kBatch >= kept.fits) kept.last_batch += line + '\n';
  }
  return kept;
}

CycleOutput::CycleOutput(const std::string& path, std::string_view header, const Kept* kept)
    : file_(path, kept != nullptr ? kept->bytes : 0) {
  if (kept == nullptr) file_.Append(header);
}

void CycleOutput::Append(std::string_view rows) { file_.Append(rows); }

}  // namespace mindahl::cli
