#pragma once

#include "fuzz/target.h"

namespace mindahl::fuzz {

/// Runs `fit` on any record with some options.
void FitRecords(Input input);
/// Runs `track` on any record with some options.
void TrackRecords(Input input);
/// Runs `track --resume` on any table: it is completed to the undisturbed one, or left alone.
void ResumeTables(Input input);

/// Runs `fit --join` or `track --join` on pieces of a record.
void JoinRecords(Input input);

}  // namespace mindahl::fuzz
