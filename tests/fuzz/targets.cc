#include <algorithm>
#include <array>

#include "fuzz/target.h"

namespace mindahl::fuzz {
namespace {

constexpr std::array kTargets = {Target{"csv", &ReadRecords, 4096},
                                 Target{"units", &LookUpUnits, 64},
                                 Target{"reversals", &FindTurns, 1024},
                                 Target{"models", &EvaluateModels, 1024},
                                 Target{"contact_state", &MoveContacts, 1024},
                                 Target{"fit", &FitRecords, 4096},
                                 Target{"track", &TrackRecords, 4096},
                                 Target{"resume", &ResumeTables, 256},
                                 Target{"join", &JoinRecords, 4096},
                                 Target{"encodings", &ReadEncodedRecords, 4096}};

}  // namespace

std::span<const Target> Targets() { return kTargets; }

const Target* FindTarget(std::string_view name) {
  const auto found = std::ranges::find(kTargets, name, &Target::name);
  return found == kTargets.end() ? nullptr : found;
}

}  // namespace mindahl::fuzz
