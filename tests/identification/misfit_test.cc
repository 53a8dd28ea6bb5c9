

#include "recovery/recovered.h"
#include "support/prelude.h"

// Records that no choice of parameters follows, and what the fit then says of them.
namespace mindahl::identification::misfit_test {
namespace {

using namespace loop;
using namespace models;

constexpr BranchLaw kLaw{4e7, 1.0 / 3, 40.0};
constexpr double kReach = 3e-6;  // [m], twice gross slip
constexpr double kNoise = 0.005 * 40.0;

Record CleanLoop() {
  const History displacement = Cycling(Wave::kSine, kReach, 5.0, 200);
  return MakeRecord(displacement, Respond(Model("mindlin-dahl"), kLaw, displacement));
}

/// A gap of 2b in the drive: the contact lags by b behind the displacement, and stands still while
/// the gap is crossed.
Record LoopWithBacklash(double b) {
  const History drive = Cycling(Wave::kSine, kReach, 5.0, 200);
  History contact;
  double at = 0.0;
  for (const double x : drive) contact.push_back(at = std::clamp(at, x - b, x + b));
  return MakeRecord(drive, Respond(Model("mindlin-dahl"), kLaw, contact));
}

/// Code and kind of `no_model_fits` or `systematic_residual`, or nothing.
std::string CodeAndStructure(const FitResult& fit) {
  for (const Finding& finding : fit.findings) {
    if (finding.code == "no_model_fits" || finding.code == "systematic_residual") {
      return std::string(finding.code) + ": " + std::string(finding.kind);
    }
  }
  return "";
}

TEST(Misfit, BacklashIsNamed) {
  struct Case {
    double half_gap;  // of the amplitude
    const char* code;
  };
  // The gap leaves some half of Tc over its share of the stroke: from a gap of a fifth of the
  // amplitude to either side on the rms passes 15 % of the half gap.
  for (const auto& [half_gap, code] : {Case{0.03, "systematic_residual"},
                                       {0.06, "systematic_residual"},
                                       {0.2, "no_model_fits"},
                                       {0.25, "no_model_fits"}}) {
    for (const std::uint64_t seed : {1U, 2U}) {
      Generator generator(seed);
      const std::string misfit = CodeAndStructure(
          FitOne(WithForceNoise(LoopWithBacklash(half_gap * kReach), kNoise, generator)));
      EXPECT_THAT(misfit, StartsWith(code)) << half_gap;
      EXPECT_THAT(misfit, HasSubstr("mirrored_early")) << half_gap;
    }
  }
}

TEST(Misfit, ForceOfPositionIsNamed) {
  struct Case {
    double size;   // of Tc
    double waves;  // over the half stroke
    const char* code;
  };
  // A sine of c·Tc has an rms of 0.7c, and adds up to c to T*.
  for (const auto& [size, waves, code] : {Case{0.05, 1.5, "systematic_residual"},
                                          {0.05, 3.0, "systematic_residual"},
                                          {0.1, 1.5, "systematic_residual"},
                                          {0.5, 1.5, "no_model_fits"},
                                          {0.5, 3.0, "no_model_fits"}}) {
    Record record = CleanLoop();
    for (std::size_t i = 0; i < record.size(); ++i) {
      const double phase = 2 * std::acos(-1.0) * waves * record.displacement[i] / kReach;
      record.force[i] += size * kLaw.slip_force * std::sin(phase);
    }
    Generator generator(2);
    const std::string misfit = CodeAndStructure(FitOne(WithForceNoise(record, kNoise, generator)));
    EXPECT_THAT(misfit, StartsWith(code)) << size << ", " << waves;
    EXPECT_THAT(misfit, HasSubstr("same_on_return")) << size << ", " << waves;
  }
}

TEST(Misfit, GoodFitIsNotBlamed) {
  // Also where the noise is as large as a poor misfit: it does not repeat.
  for (const double noise : {0.005, 0.05, 0.15}) {
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
      Generator generator(seed);
      const FitResult fit = FitOne(WithForceNoise(CleanLoop(), noise * kLaw.slip_force, generator));
      EXPECT_EQ(CodeAndStructure(fit), "") << noise << ", seed " << seed;
    }
  }
}

}  // namespace
}  // namespace mindahl::identification::misfit_test
