#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

#include "mindahl/campaign/cycle_fit.h"

namespace mindahl::cli {

/// Counts what a resumed run keeps of the table of cycles on disk: its whole batches.
struct KeptCycles {
  std::size_t fits = 0;
  std::uintmax_t bytes = 0;  ///< size of the header and these
  std::string last_batch;    ///< its rows, to compare with
};

/// Says which rows of a table are those of a test, and what they hold besides its cycles' cells.
struct KeptRows {
  std::uintmax_t offset = 0;  ///< [bytes] in the table before the first row
  std::string_view before;    ///< at the beginning of each
  std::string_view after;     ///< at its end
};

/// @throws InputError where the first line of the file is another
void RequireHeader(const std::string& path, std::string_view header);

/// @param visit   is given every row that is kept
/// @throws InputError where the file is no such table
KeptCycles ReadKeptCycles(const std::string& path, const KeptRows& rows,
                          const std::function<void(const campaign::CycleTableEntry&)>& visit);

}  // namespace mindahl::cli
