#include "cli/kept_cycles.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <vector>

#include "mindahl/campaign/tracker.h"
#include "mindahl/core/error.h"

namespace mindahl::cli {

namespace {

std::ifstream Open(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw InputError(fmt::format("cannot read '{}': {}", path, std::strerror(errno)));
  return file;
}

campaign::CycleTableEntry ReadRow(std::string_view row, const KeptRows& rows) {
  if (!row.starts_with(rows.before) || !row.ends_with(rows.after)) {
    throw InputError("is of another test");
  }
  row.remove_prefix(rows.before.size());
  row.remove_suffix(rows.after.size());
  return campaign::ReadCycleTableRow(row);
}

}  // namespace

void RequireHeader(const std::string& path, std::string_view header) {
  std::ifstream file = Open(path);
  std::string line;
  std::getline(file, line);
  if (line + '\n' == header) return;
  throw InputError(
      fmt::format("--resume: {} is no table of such cycles, its first line is another: give "
                  "another --output, or --overwrite",
                  path));
}

KeptCycles ReadKeptCycles(const std::string& path, const KeptRows& rows,
                          const std::function<void(const campaign::CycleTableEntry&)>& visit) {
  std::ifstream file = Open(path);
  file.seekg(static_cast<std::streamoff>(rows.offset));
  std::string line;
  KeptCycles kept;
  kept.bytes = rows.offset;
  std::vector<std::string> batch;
  // A line without a line feed was being written when a run was killed, and is no row.
  while (std::getline(file, line) && !file.eof()) {
    batch.push_back(line);
    if (batch.size() < campaign::kBatch) continue;
    kept.last_batch.clear();
    for (const std::string& row : batch) {
      ++kept.fits;
      try {
        visit(ReadRow(row, rows));
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
