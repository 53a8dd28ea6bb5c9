#include "mindahl/core/version.h"

namespace mindahl {

std::string_view Version() { return MINDAHL_VERSION; }

}  // namespace mindahl
