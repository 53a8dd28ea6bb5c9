#pragma once

#include <string>

#include "cli/app.h"
#include "mindahl/io/record_reader.h"

namespace mindahl::cli {

/// Writes the cheapest law that a record does not distinguish from the best, as text and, unless
/// empty, JSON. Not established where no law describes the record.
/// @param json  path, or "-" for standard output, which then has nothing else
/// @throws InputError naming the file, and line and column where there are any
void RecommendForRecord(const std::string& record, const io::RecordColumns& columns,
                        const std::string& json, Console& console);

}  // namespace mindahl::cli
