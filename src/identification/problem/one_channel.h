#pragma once

#include <cstddef>

#include "identification/problem/scaled_records.h"

namespace mindahl::identification {

/// True if two covariates are one channel, read twice or in other units: linear in each other in
/// every record but for a tenth of their deviation.
bool AreOneChannel(const ScaledRecords& data, std::size_t one, std::size_t other);

}  // namespace mindahl::identification
