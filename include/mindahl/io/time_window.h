#pragma once

#include <string>

#include "mindahl/io/record_reader.h"

namespace mindahl::io {

/// Keeps the samples of a record whose time [s] lies from `first` to `last`, both included, with a
/// note of how many.
/// @param file  its name, for messages
/// @throws InputError when the record has no time, or no sample lies there
void KeepTimeWindow(RecordFile& input, const std::string& file, double first, double last);

}  // namespace mindahl::io
