#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

#include "mindahl/campaign/cycle_table.h"

namespace mindahl::cli {

/// Counts what a resumed run keeps of the table of cycles on disk: its whole batches.
struct KeptCycles {
  std::size_t fits = 0;
  std::uintmax_t bytes = 0;  ///< size of the header and these
  std::string last_batch;    ///< its rows, to compare with
};

/// @param header  of the table that is to be written
/// @param visit   is given every row that is kept
/// @throws InputError where the file is no such table
KeptCycles ReadKeptCycles(const std::string& path, std::string_view header,
                          const std::function<void(const campaign::CycleTableEntry&)>& visit);

}  // namespace mindahl::cli
