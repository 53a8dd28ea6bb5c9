#include "kind.h"

namespace mindahl::reliability {
namespace {

/// Fowler, Noll and Vo: of text, the same everywhere.
std::uint64_t HashOf(std::string_view text) {
  std::uint64_t hash = 0xcbf29ce484222325U;
  for (const char character : text) {
    hash = (hash ^ static_cast<unsigned char>(character)) * 0x100000001b3U;
  }
  return hash;
}

void Install(loop::Record& record, const Truth& truth) {
  for (double& force : record.force) force = truth.force_sense * force + truth.force_offset;
  for (double& displacement : record.displacement) displacement += truth.displacement_offset;
}

}  // namespace

std::string_view Name(Half half) {
  switch (half) {
    case Half::kDevelopment:
      return "development";
    case Half::kHeldOut:
      return "held-out";
    case Half::kClean:
      return "clean";
  }
  return "";
}

Expected AllOf(const models::BranchLaw& law) {
  return {.sigma = Range{law.tangential_stiffness, law.tangential_stiffness},
          .alpha = Range{law.shape_exponent, law.shape_exponent},
          .slip_force = Range{law.slip_force, law.slip_force}};
}

Expected StiffnessAndSlipForce(double sigma, double slip_force) {
  return {.sigma = Range{sigma, sigma}, .slip_force = Range{slip_force, slip_force}};
}

std::vector<Kind> Kinds() {
  std::vector<Kind> kinds;
  for (const auto family : {NoiseKinds, ChannelKinds, LoggerKinds, RigKinds, ContactKinds,
                            LoadKinds, SamplingKinds, ExcitationKinds, CleanKinds}) {
    const std::vector<Kind> more = family();
    kinds.insert(kinds.end(), more.begin(), more.end());
  }
  return kinds;
}

Loop MakeLoop(const Kind& kind, std::size_t level, std::uint64_t seed) {
  constexpr std::uint64_t kSpread = 0x9e3779b97f4a7c15U;  // 2⁶⁴ over the golden ratio
  Draws draws(HashOf(kind.name) ^ (kSpread * (seed * kLevels + level + 1)));
  const Truth truth = DrawTruth(draws);
  Loop loop = kind.make(truth, level, draws);
  Install(loop.record, truth);
  return loop;
}

}  // namespace mindahl::reliability
