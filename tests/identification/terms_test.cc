#include "mindahl/identification/terms.h"

#include <set>

#include "identification/problem/parameters.h"
#include "identification/sample_loop.h"
#include "identification/stages.h"
#include "support/prelude.h"

// The table of parameters, and θ of each.
namespace mindahl::identification::terms_test {
namespace {

constexpr TermUnits kUnits{.force = 20.0,
                           .length = 3e-6,
                           .half_duration = 5.0,
                           .force_sense = -1.0,
                           .force_reference = 7.0,
                           .displacement_reference = 2e-6};

TEST(Terms, EveryRowIsComplete) {
  std::set<std::string_view> names;
  for (const Term& term : Terms()) {
    SCOPED_TRACE(term.name);
    EXPECT_TRUE(names.insert(term.name).second) << "twice";
    EXPECT_FALSE(term.unit.empty());
    EXPECT_FALSE(term.meaning.empty());
    EXPECT_LT(term.lowest, term.highest);
    EXPECT_TRUE(!term.positive || (term.lowest > 0 && term.scale(kUnits) > 0));
    // A term that leads a group is asked for.
    const bool is_asked_for =
        term.presence == Presence::kOnDemand || term.presence == Presence::kReported;
    EXPECT_TRUE(!LeadsGroup(term) || is_asked_for);
    EXPECT_EQ(FindTerm(term.name), &term);
  }
}

TEST(Terms, OfTheContactComeBeforeThoseOfARecord) {
  bool seen_record = false;
  for (const Term& term : Terms()) {
    EXPECT_FALSE(seen_record && !term.is_of_record) << term.name;
    seen_record = seen_record || term.is_of_record;
  }
}

TEST(Terms, OfTheLawStandWhereTheSolverLooksForThem) {
  ASSERT_GT(Terms().size(), kLoadExponent);
  EXPECT_EQ(Terms()[kStiffness].name, "sigma");
  EXPECT_EQ(Terms()[kShape].name, "alpha");
  EXPECT_EQ(Terms()[kSlipForce].name, "slip_force");
  EXPECT_EQ(Terms()[kRig].name, "rig_stiffness");
  EXPECT_EQ(Terms()[kLoadExponent].name, "load_exponent");
  const testing::Stages stages(testing::Loop());
  for (const std::size_t p : {kStiffness, kShape, kSlipForce, kRig, kLoadExponent}) {
    EXPECT_EQ(stages.problem.parameters[p].term, &Terms()[p]);
  }
}

TEST(Terms, UnknownNamesAreNone) {
  EXPECT_EQ(FindTerm("stiffness"), nullptr);
  EXPECT_EQ(FindTerm(""), nullptr);
  EXPECT_EQ(FindTerm("force_offset_1"), nullptr) << "without the record's number";
}

TEST(Terms, NumberOfARecordIsNoPartOfTheName) {
  EXPECT_EQ(TermNameOf("force_offset_2"), "force_offset");
  EXPECT_EQ(TermNameOf("force_offset_120"), "force_offset");
  EXPECT_EQ(TermNameOf("force_offset"), "force_offset");
  EXPECT_EQ(TermNameOf("alpha"), "alpha");
  EXPECT_EQ(TermNameOf("alpha2"), "alpha2");
  EXPECT_EQ(TermNameOf("12"), "12");
  EXPECT_EQ(TermNameOf(""), "");
}

TEST(Parameters, OfSeveralRecordsAreNumberedAndFound) {
  const Record wide = testing::Loop();
  const testing::Stages stages(std::vector<Record>{wide, testing::Scaled(wide, 0.5, 0.5)});
  const Parameters& parameters = stages.problem.parameters;
  std::set<std::string> names;
  for (std::size_t p = 0; p < parameters.size(); ++p) {
    const std::string name = parameters.NameOf(p);
    EXPECT_TRUE(names.insert(name).second) << name;
    EXPECT_EQ(TermNameOf(name), parameters[p].term->name);
    EXPECT_EQ(parameters.PositionOf(parameters[p].term->id, parameters[p].record), p) << name;
  }
  EXPECT_TRUE(names.contains("sigma") && names.contains("force_offset_1") &&
              names.contains("displacement_offset_2"));
  // One record's have no number.
  const testing::Stages one(wide);
  EXPECT_EQ(one.problem.parameters.NameOf(one.problem.parameters.PositionOf(TermId::kForceOffset)),
            "force_offset");
}

TEST(Parameters, ValuesAreScaleTimesThetaAndBack) {
  constexpr double kRounding = 1e-14;
  for (const Term& term : Terms()) {
    Parameter parameter{.term = &term, .scale = term.scale(kUnits)};
    parameter.reference = term.reference(kUnits);
    for (const double theta : {-1.5, 0.0, 0.25, 2.0}) {
      const double value = parameter.ToValue(theta);
      EXPECT_NEAR(parameter.ToTheta(value), theta, kRounding) << term.name;
      const double expected = term.positive ? parameter.scale * std::exp(theta)
                                            : parameter.reference + parameter.scale * theta;
      EXPECT_DOUBLE_EQ(value, expected) << term.name;
    }
  }
}

TEST(Parameters, HaveTheUnitsOfTheFile) {
  const auto value_of_one = [](std::string_view name) {
    const Term& term = *FindTerm(name);
    return term.scale(kUnits);
  };
  EXPECT_DOUBLE_EQ(value_of_one("sigma"), 20.0 / 3e-6);
  EXPECT_DOUBLE_EQ(value_of_one("slip_force"), 20.0);
  EXPECT_DOUBLE_EQ(value_of_one("rig_stiffness"), 20.0 / 3e-6);
  EXPECT_DOUBLE_EQ(value_of_one("plateau_slope"), 20.0 / 3e-6);
  // A force turned round in the file.
  EXPECT_DOUBLE_EQ(value_of_one("force_offset"), -20.0);
  EXPECT_DOUBLE_EQ(FindTerm("force_offset")->reference(kUnits), -7.0);
  EXPECT_DOUBLE_EQ(value_of_one("force_drift"), -20.0 / 5.0);
  EXPECT_DOUBLE_EQ(value_of_one("displacement_offset"), 3e-6);
  EXPECT_DOUBLE_EQ(FindTerm("displacement_offset")->reference(kUnits), 2e-6);
}

TEST(Parameters, EndsOfTheTheorysOwnAreNoSearchLimits) {
  const auto is_limit = [](std::string_view name, BoundSide side) {
    const Parameter parameter{.term = FindTerm(name)};
    return IsSearchLimit(parameter, side);
  };
  struct Case {
    std::string_view term;
    bool below;
    bool above;
  };
  // Jenkins' α, the speed or its logarithm, no slip force at rest, no gap, no drag; rigs have both.
  for (const auto& [term, below, above] :
       {Case{"alpha", false, true}, Case{"slip_speed_exponent", false, false},
        Case{"slip_speed", true, false}, Case{"backlash", false, true},
        Case{"drag_fraction", false, false}, Case{"rig_stiffness", true, true}}) {
    EXPECT_EQ(is_limit(term, BoundSide::kLower), below) << term;
    EXPECT_EQ(is_limit(term, BoundSide::kUpper), above) << term;
    EXPECT_FALSE(is_limit(term, BoundSide::kInside)) << term;
  }
}

}  // namespace
}  // namespace mindahl::identification::terms_test
