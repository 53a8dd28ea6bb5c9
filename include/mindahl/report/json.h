#pragma once

#include <string>

#include "mindahl/report/report.h"

namespace mindahl::report {

/// Returns the JSON of schema mindahl.fit/1, as `mindahl fit --json` writes it, with the end of
/// line: docs/contract.md. UTF-8; bytes of a file name that are not are replaced.
std::string ToJson(const Report& report);

}  // namespace mindahl::report
