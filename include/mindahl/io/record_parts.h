#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mindahl/io/record_reader.h"

namespace mindahl::io {

/// Keeps the samples of a record whose time [s] lies from `first` to `last`, both included, with a
/// note of how many.
/// @param file  its name, for messages
/// @throws InputError when the record has no time, or no sample lies there
void KeepTimeWindow(RecordFile& input, const std::string& file, double first, double last);

/// One of several records of a file.
struct NamedRecord {
  std::string name;  ///< the file's, and of a piece its lines: series.csv:2-501
  RecordFile file;
};

/// Returns the part of a record under one constant load, where that ramps at its ends
/// (FindSettledLoad()); else the record itself.
/// @param file  its name
NamedRecord CutAtLoadRamps(const RecordFile& input, const std::string& file);

/// Returns a record whose normal load goes in steps (loop/load_steps.h) as one record for each
/// load; else the record itself.
/// @param file  its name
std::vector<NamedRecord> SplitAtLoadSteps(const RecordFile& input, const std::string& file);

}  // namespace mindahl::io
