
#include <memory_resource>

#include "loop/rules.h"
#include "loop/scratch.h"
#include "loop/strokes.h"
#include "mindahl/loop/disturbances.h"
#include "support/histories.h"
#include "support/prelude.h"

// Each rule of the gate between a record on which it just holds and one on which it just does not:
// at twice or half of it one of them comes out otherwise.
namespace mindahl::loop::reversal_rules_test {
namespace {

ReversalGate Choose(const History& history, const ReversalRules& rules) {
  return ChooseReversalGate(history, rules, std::pmr::get_default_resource());
}

/// A way that is put together from strokes.
class Way {
 public:
  Way& To(double target, std::size_t samples) {
    const double from = history_.back();
    for (std::size_t k = 1; k <= samples; ++k) {
      const double share = static_cast<double>(k) / static_cast<double>(samples);
      history_.push_back(k == samples ? target : from + share * (target - from));
    }
    return *this;
  }
  /// Back by the range and on: smooth, or with the share of it in the first sample.
  Way& Dip(double range, std::size_t samples, double jump = 0.0) {
    const double top = history_.back();
    if (jump > 0) To(top - jump * range, 1);
    To(top - range, jump > 0 ? samples - 1 : samples);
    return To(top + 1e-6, samples);
  }
  [[nodiscard]] const History& history() const { return history_; }

 private:
  History history_ = {0.0};
};

constexpr std::size_t kStroke = 400;  // samples
constexpr std::size_t kStrokesReverse = 6;

/// Strokes between 0 and 1, with dips on the first.
History WithDips(const std::function<void(Way&)>& dips) {
  Way way;
  way.To(0.5, kStroke / 2);
  dips(way);
  way.To(1.0, kStroke / 2);
  for (std::size_t stroke = 0; stroke < kStrokesReverse; ++stroke) {
    way.To(stroke % 2 == 0 ? 0.0 : 1.0, kStroke);
  }
  return way.history();
}

/// Single readings, each this much behind.
void Jumps(Way& way, std::size_t count, double range) {
  for (std::size_t k = 0; k < count; ++k) way.Dip(range, 1).To(way.history().back() + 1e-6, 3);
}

bool SmoothDipVanishes(const ReversalRules& rules, double duration_share) {
  const History history = WithDips([&](Way& way) {
    Jumps(way, 100, 1e-3);
    way.Dip(0.02, static_cast<std::size_t>(duration_share * kStroke));
  });
  return Choose(history, rules).count == kStrokesReverse;
}

bool ADipAmongNoiseIsBriefBelowAThirdOfAStroke(const ReversalRules& rules) {
  return SmoothDipVanishes(rules, 0.28) && !SmoothDipVanishes(rules, 0.4);
}

bool JumpVanishes(const ReversalRules& rules, double duration_share, double jump) {
  const auto samples = static_cast<std::size_t>(duration_share * kStroke);
  const History history = WithDips([&](Way& way) {
    Jumps(way, 3, 1e-3);
    way.Dip(0.02, samples, jump);
  });
  return Choose(history, rules).count == kStrokesReverse;
}

bool AJumpIsOverInAnEighthOfAStroke(const ReversalRules& rules) {
  return JumpVanishes(rules, 0.11, 0.9) && !JumpVanishes(rules, 0.14, 0.9);
}

bool AJumpHasFourTenthsOfTheRangeInOneStep(const ReversalRules& rules) {
  return JumpVanishes(rules, 0.01, 0.45) && !JumpVanishes(rules, 0.01, 0.35);
}

bool ASettlingOfThreeStepsIsBeyondTheNoiseOfAnEncoder(const ReversalRules& rules) {
  // 2√(2 ln n)·q/√12 is 2.3 q at 2500 samples: two steps are within 1.25 of it, three without.
  const auto count = [&](double settles) {
    Way way;
    for (int k = 0; k < 3; ++k) way.To(1, 1).To(1, 2).To(0, 1).To(0, 3);
    for (int step = 1; step <= 100; ++step) way.To(step, 1).To(step, 6 + step % 3);
    for (int step = 99; step >= 0; --step) way.To(step, 1).To(step, 6 + step % 3);
    for (int step = 1; step <= 100; ++step) way.To(step, 1).To(step, 6 + step % 3);
    for (double step = 1; step <= settles; ++step) way.To(100 - step, 1).To(100 - step, 300);
    return Choose(way.history(), rules).count;
  };
  return count(2) == 2 && count(3) == 2 + 1;
}

/// Strokes of six samples, none of which is long enough for a jump, under white noise of this share
/// of the range, as it is estimated.
History RoughDrive(double share) {
  Generator generator(1);
  History noise;
  for (int i = 0; i < 700; ++i) noise.push_back(testing::Normal(generator));
  double lower = 0.0;
  double upper = 1.0;
  History drive;
  for (int iteration = 0; iteration < 60; ++iteration) {
    const double middle = (lower + upper) / 2;
    drive.clear();
    for (std::size_t i = 0; i < noise.size(); ++i) {
      const double at = static_cast<double>(i) * std::numbers::pi / 6;
      drive.push_back(std::sin(at) + middle * noise[i]);
    }
    const auto [least, greatest] = std::ranges::minmax(drive);
    (EstimateDisplacementNoise(drive) > share * (greatest - least) ? upper : lower) = middle;
  }
  return drive;
}

bool NoiseBeyondATwentiethOfTheRangeIsARoughDrive(const ReversalRules& rules) {
  const ReversalGate rough = Choose(RoughDrive(0.06), rules);
  return Choose(RoughDrive(0.04), rules).gate > 0 && rough.gate == 0 && rough.certain;
}

bool OneInTwentyMayLookOtherwise(const ReversalRules& rules) {
  const auto count = [&](std::size_t odd) {
    const History history = WithDips([&](Way& way) {
      Jumps(way, 100, 1e-3);
      for (std::size_t k = 0; k < odd; ++k) way.Dip(4e-3, 20);
    });
    return Choose(history, rules).count;
  };
  return count(4) == kStrokesReverse && count(6) == kStrokesReverse + 2 * 6;
}

/// Jumps, and inner loops of the drive so many times wider.
ReversalGate UnderPlateau(const ReversalRules& rules, std::size_t jumps, double ratio) {
  return Choose(WithDips([&](Way& way) {
                  Jumps(way, jumps, 1e-2);
                  way.Dip(ratio * 1e-2, kStroke / 2);
                }),
                rules);
}

bool APlateauOfTwoAndAHalfTimesIsClear(const ReversalRules& rules) {
  return UnderPlateau(rules, 500, 3.0).certain && !UnderPlateau(rules, 500, 2.0).certain;
}

bool NoiseThatIsTwentyTimesAsCommonIsBelieved(const ReversalRules& rules) {
  // Kept are the inner loop and the strokes: the first and the last, and three loops between.
  constexpr std::size_t kKept = 1 + 2 + (kStrokesReverse - 1) / 2;
  return UnderPlateau(rules, 22 * kKept, 1.2).gate > 0 &&
         UnderPlateau(rules, 18 * kKept, 1.2).gate == 0;
}

bool APlateauHalfAsWideCompetes(const ReversalRules& rules) {
  // The widths are ln(r/0.001) and ln(1/r).
  const auto is_certain = [&](double rival) {
    const double range = std::exp(std::log(1e-3) / (1 + rival));
    return Choose(WithDips([&](Way& way) {
                    Jumps(way, 100, 1e-3);
                    Jumps(way, 4, range);
                  }),
                  rules)
        .certain;
  };
  return is_certain(0.4) && !is_certain(0.6);
}

/// Smooth dips of ranges that fill a ratio evenly, below a gap of another.
bool IsDoubted(const ReversalRules& rules, int count, double spread, double gap) {
  const History history = WithDips([&](Way& way) {
    for (int k = 0; k < count; ++k) {
      const double part = count > 1 ? static_cast<double>(k) / (count - 1) : 0.0;
      way.Dip(std::pow(spread, part - 1) / gap, 20);
    }
  });
  const ReversalGate choice = Choose(history, rules);
  return !choice.certain && choice.count == kStrokesReverse;
}

bool EightSmoothOnesAreMany(const ReversalRules& rules) {
  return IsDoubted(rules, 9, 11, 20) && !IsDoubted(rules, 6, 11, 20);
}

bool DisturbancesSpreadOverTenTimesTheLeast(const ReversalRules& rules) {
  return IsDoubted(rules, 12, 11, 20) && !IsDoubted(rules, 12, 9, 20);
}

bool StrokesAreTenTimesWiderThanDisturbances(const ReversalRules& rules) {
  return IsDoubted(rules, 12, 20, 12) && !IsDoubted(rules, 12, 20, 8);
}

struct RuleCase {
  const char* name;
  std::function<void(ReversalRules&, double)> scale;
  bool (*holds)(const ReversalRules&);
};

#define SCALED(member) [](ReversalRules& rules, double factor) { rules.member *= factor; }

const std::vector<RuleCase>& Cases() {
  static const std::vector<RuleCase> cases = {
      {"brief", SCALED(brief), ADipAmongNoiseIsBriefBelowAThirdOfAStroke},
      {"sudden", SCALED(sudden), AJumpIsOverInAnEighthOfAStroke},
      {"jump", SCALED(jump), AJumpHasFourTenthsOfTheRangeInOneStep},
      {"beyond", SCALED(beyond), ASettlingOfThreeStepsIsBeyondTheNoiseOfAnEncoder},
      {"rough", SCALED(rough), NoiseBeyondATwentiethOfTheRangeIsARoughDrive},
      {"exceptions", SCALED(exceptions), OneInTwentyMayLookOtherwise},
      {"clear", SCALED(clear), APlateauOfTwoAndAHalfTimesIsClear},
      {"outnumber", SCALED(outnumber), NoiseThatIsTwentyTimesAsCommonIsBelieved},
      {"rival", SCALED(rival), APlateauHalfAsWideCompetes},
      {"many",
       [](ReversalRules& rules, double factor) {
         rules.many = static_cast<std::size_t>(factor * static_cast<double>(rules.many));
       },
       EightSmoothOnesAreMany},
      {"spread", SCALED(spread), DisturbancesSpreadOverTenTimesTheLeast},
      {"far", SCALED(far), StrokesAreTenTimesWiderThanDisturbances},
  };
  return cases;
}

class ReversalRule : public ::testing::TestWithParam<RuleCase> {};

TEST_P(ReversalRule, HoldsAtItsValueAndNeitherAtTwiceNorAtHalf) {
  EXPECT_TRUE(GetParam().holds({}));
  for (const double factor : {0.5, 2.0}) {
    ReversalRules rules;
    GetParam().scale(rules, factor);
    EXPECT_FALSE(GetParam().holds(rules)) << "at " << factor << " times the value";
  }
}

INSTANTIATE_TEST_SUITE_P(All, ReversalRule, ::testing::ValuesIn(Cases()),
                         [](const auto& param) { return std::string(param.param.name); });

}  // namespace
}  // namespace mindahl::loop::reversal_rules_test
