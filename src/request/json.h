#pragma once

#include "report/fields.h"

namespace mindahl::request {

using report::Dump;
using report::Json;
using report::NumberOrNull;

}  // namespace mindahl::request
