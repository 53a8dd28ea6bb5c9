#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "mindahl/campaign/cycle_fit.h"
#include "mindahl/campaign/cycle_table.h"
#include "mindahl/io/appended_file.h"

namespace mindahl::cli {

/// The table of cycles on disk: begun, or taken up where a run ended before.
class CycleOutput {
 public:
  /// What is there already of a run that is to go on.
  struct Kept {
    std::size_t fits = 0;      ///< in whole batches
    std::uintmax_t bytes = 0;  ///< of header and these
    double accumulated_energy = 0.0;
    std::string last_batch;  ///< its rows, to compare with
    double energy_before_last_batch = 0.0;
  };

  /// Reads what is there.
  /// @param header   of the table that is to be written
  /// @param visit    is given every row that is kept
  /// @throws InputError where the file is no such table
  static Kept Read(const std::string& path, std::string_view header,
                   const std::function<void(const campaign::CycleTableEntry&)>& visit);

  /// @param kept  null: the file is begun anew
  CycleOutput(const std::string& path, std::string_view header, const Kept* kept);

  /// Appends rows as one block.
  /// @throws InputError where they cannot be written
  void Append(std::string_view rows);

 private:
  io::AppendedFile file_;
};

}  // namespace mindahl::cli
