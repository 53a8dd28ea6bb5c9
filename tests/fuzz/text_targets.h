#pragma once

#include "fuzz/target.h"

namespace mindahl::fuzz {

/// Reads a record whole and as a stream, which must agree.
void ReadRecords(Input input);
/// Looks up units by any symbol.
void LookUpUnits(Input input);
/// Reads the TOML of --config.
void ReadConfigurations(Input input);

}  // namespace mindahl::fuzz
