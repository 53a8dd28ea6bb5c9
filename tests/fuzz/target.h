#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <span>
#include <string_view>

/// What is run on arbitrary bytes: by libFuzzer (scripts/fuzz.sh), and by the tests on a corpus and
/// on pseudo-random mutations of it.
namespace mindahl::fuzz {

using Input = std::span<const std::uint8_t>;

struct Target {
  std::string_view name;  ///< also of its folder in corpus/
  void (*run)(Input);
  std::size_t longest;  ///< bytes, so that the work for an input is bounded
};

/// Reads a record whole and as a stream, which must agree.
void ReadRecords(Input input);
/// Reads a record in an encoding that is given or found; one of ASCII is the same in UTF-16.
void ReadEncodedRecords(Input input);
/// Looks up units by any symbol.
void LookUpUnits(Input input);
/// Finds reversals under any gate, in one pass and sample by sample, and chooses a gate.
void FindTurns(Input input);
/// Evaluates every model of any parameters along any path.
void EvaluateModels(Input input);
/// Moves a contact step by step, as EvaluateForce has it.
void MoveContacts(Input input);
/// Runs `fit` on any record with some options.
void FitRecords(Input input);
/// Runs `track` on any record with some options.
void TrackRecords(Input input);
/// Runs `track --resume` on any table: it is completed to the undisturbed one, or left alone.
void ResumeTables(Input input);

inline constexpr std::array kTargets = {Target{"csv", &ReadRecords, 4096},
                                        Target{"units", &LookUpUnits, 64},
                                        Target{"reversals", &FindTurns, 1024},
                                        Target{"models", &EvaluateModels, 1024},
                                        Target{"contact_state", &MoveContacts, 1024},
                                        Target{"fit", &FitRecords, 4096},
                                        Target{"track", &TrackRecords, 4096},
                                        Target{"resume", &ResumeTables, 256},
                                        Target{"encodings", &ReadEncodedRecords, 4096}};

/// Ends the program where a property does not hold.
inline void Require(bool holds, std::string_view property) {
  if (holds) return;
  std::fprintf(stderr, "fuzz: violated: %.*s\n", static_cast<int>(property.size()),
               property.data());
  std::abort();
}

/// Returns the target of a name; ends the program where there is none.
inline const Target& FindTarget(std::string_view name) {
  const auto* const found = std::ranges::find(kTargets, name, &Target::name);
  Require(found != kTargets.end(), "a target has the name that is given");
  return *found;
}

}  // namespace mindahl::fuzz
