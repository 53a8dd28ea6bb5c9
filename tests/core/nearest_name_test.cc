#include "core/nearest_name.h"

#include "support/prelude.h"

namespace mindahl::nearest_name_test {
namespace {

const std::vector<std::string> kOptions = {
    "--displacement", "--displacement-unit", "--displacement-noise",
    "--force",        "--force-unit",        "--fix",
    "--model",        "--normal-load"};

TEST(NearestName, FindsALetterThatIsMissingTooMuchWrongOrSwapped) {
  EXPECT_EQ(NearestName("--dispacement", kOptions), "--displacement");
  EXPECT_EQ(NearestName("--forrce", kOptions), "--force");
  EXPECT_EQ(NearestName("--modal", kOptions), "--model");
  EXPECT_EQ(NearestName("--froce", kOptions), "--force");
  EXPECT_EQ(NearestName("--normal_load", kOptions), "--normal-load");
}

TEST(NearestName, SharesALetterWithTheWord) {
  const std::vector<std::string> one = {"m"};
  EXPECT_EQ(NearestName("mn", one), "m");
  EXPECT_EQ(NearestName("n", one), std::nullopt);
}

TEST(NearestName, CountsASwapOfNeighboursOnce) {
  // "ab" is one swap from "ba" and two substitutions: a word of two letters is allowed one edit.
  EXPECT_EQ(NearestName("ba", std::vector<std::string>{"ab"}), "ab");
}

TEST(NearestName, TakesTheNameWithFewestEditsAndOfEqualsTheFirst) {
  EXPECT_EQ(NearestName("fitt", std::vector<std::string>{"fits", "fit"}), "fits");
  EXPECT_EQ(NearestName("--displacemnt-unit", kOptions), "--displacement-unit");
}

TEST(NearestName, AllowsAThirdOfTheLettersAtLeastOneAndAtMostThree) {
  const std::vector<std::string> names = {"abcdefghijklmnopqrst"};
  EXPECT_EQ(NearestName("abcdefghijklmnopq", names), names.front());
  EXPECT_EQ(NearestName("XXXdefghijklmnopqrst", names), names.front());
  EXPECT_EQ(NearestName("XXXXefghijklmnopqrst", names), std::nullopt);
  EXPECT_EQ(NearestName("pos", std::vector<std::string>{"pox"}), "pox");
  EXPECT_EQ(NearestName("pos", std::vector<std::string>{"dis"}), std::nullopt);
  EXPECT_EQ(NearestName("XXcdef", std::vector<std::string>{"abcdef"}), "abcdef");
  EXPECT_EQ(NearestName("XXcde", std::vector<std::string>{"abcde"}), std::nullopt);
}

TEST(NearestName, PaysNoHeedToCase) {
  EXPECT_EQ(NearestName("FORCE_N", std::vector<std::string>{"Time", "Force_N"}), "Force_N");
}

TEST(NearestName, TakesTheShortestThatBeginsWithAnAbbreviation) {
  EXPECT_EQ(NearestName("--disp", kOptions), "--displacement");
  EXPECT_EQ(NearestName("di", std::vector<std::string>{"displacement"}), std::nullopt);
}

TEST(NearestName, OfNothingLikeItIsNone) {
  EXPECT_EQ(NearestName("--stiffness", kOptions), std::nullopt);
  EXPECT_EQ(NearestName("load", std::vector<std::string>{"x", "F"}), std::nullopt);
  EXPECT_EQ(NearestName("x", std::vector<std::string>{"F"}), std::nullopt);
  EXPECT_EQ(NearestName("x", {}), std::nullopt);
  EXPECT_EQ(NearestName("", kOptions), std::nullopt);
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
