#include "core/nearest_name.h"

#include "support/prelude.h"

namespace mindahl::nearest_name_test {
namespace {

const std::vector<std::string> kOptions = {
    "--displacement", "--displacement-unit", "--displacement-noise",
    "--force",        "--force-unit",        "--fix",
    "--model",        "--normal-load"};

TEST(NearestName, HasFewestEditsAndOfEqualsIsTheFirst) {
  // A letter that is missing, too much, wrong or swapped.
  EXPECT_EQ(NearestName("--dispacement", kOptions), "--displacement");
  EXPECT_EQ(NearestName("--forrce", kOptions), "--force");
  EXPECT_EQ(NearestName("--modal", kOptions), "--model");
  EXPECT_EQ(NearestName("--froce", kOptions), "--force");
  EXPECT_EQ(NearestName("--normal_load", kOptions), "--normal-load");
  EXPECT_EQ(NearestName("--displacemnt-unit", kOptions), "--displacement-unit");
  EXPECT_EQ(NearestName("--stiffness", kOptions), std::nullopt);
  EXPECT_EQ(NearestName("", kOptions), std::nullopt);
  // An abbreviation is completed to the shortest name that begins with it.
  EXPECT_EQ(NearestName("--disp", kOptions), "--displacement");
  EXPECT_EQ(NearestName("fitt", std::vector<std::string>{"fits", "fit"}), "fits");
  EXPECT_EQ(NearestName("FORCE_N", std::vector<std::string>{"Time", "Force_N"}), "Force_N");
  EXPECT_EQ(NearestName("load", std::vector<std::string>{"x", "F"}), std::nullopt);
  EXPECT_EQ(NearestName("x", {}), std::nullopt);
}

TEST(NearestName, HasAThirdOfTheLettersOtherAtLeastOneAndAtMostThree) {
  struct Case {
    std::string word, name;
    bool is_near;
  };
  for (const Case& at : {Case{"abcdefghijklmnopq", "abcdefghijklmnopqrst", true},
                         {"XXXdefghijklmnopqrst", "abcdefghijklmnopqrst", true},
                         {"XXXXefghijklmnopqrst", "abcdefghijklmnopqrst", false},
                         {"pos", "pox", true},
                         {"pos", "dis", false},
                         {"XXcdef", "abcdef", true},
                         {"XXcde", "abcde", false},
                         {"di", "displacement", false},
                         {"ba", "ab", true},  // one swap, two substitutions
                         {"mn", "m", true},
                         {"n", "m", false}}) {  // it shares a letter
    EXPECT_EQ(NearestName(at.word, std::vector{at.name}).has_value(), at.is_near) << at.word;
  }
}

TEST(DidYouMean, AsksOnlyWhereANameIsNear) {
  EXPECT_EQ(DidYouMean("--forse", kOptions), ": did you mean '--force'?");
  EXPECT_EQ(DidYouMean("--stiffness", kOptions), ":");
}

TEST(UnknownAmong, NamesTheNearestAndAll) {
  const std::vector<std::string> models = {"dahl", "mindlin"};
  EXPECT_EQ(UnknownAmong("mindin", models),
            "'mindin' is unknown: did you mean 'mindlin'? must be one of dahl, mindlin");
  EXPECT_EQ(UnknownAmong("iwan", models), "'iwan' is unknown: must be one of dahl, mindlin");
}

}  // namespace
}  // namespace mindahl::nearest_name_test
