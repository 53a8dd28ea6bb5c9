#pragma once

#include "fuzz/target.h"

namespace mindahl::fuzz {

/// Reads a record whole and as a stream, which must agree.
void ReadRecords(Input input);
/// Reads a record in an encoding that is given or found; one of ASCII is the same in UTF-16.
void ReadEncodedRecords(Input input);
/// Looks up units by any symbol.
void LookUpUnits(Input input);

}  // namespace mindahl::fuzz
