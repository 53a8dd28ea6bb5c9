#include <set>

#include "mindahl/tradeoff/work_precision.h"
#include "support/prelude.h"

namespace mindahl::tradeoff::approximation_test {
namespace {

using namespace models;
using namespace methods;

TEST(Approximation, IsDescribedWithItsResolution) {
  EXPECT_EQ(Describe({"spring", ""}), "spring");
  EXPECT_EQ(Describe({"mindlin", "exact"}), "mindlin by exact");
  EXPECT_EQ(Describe({"jenkins", "iwan", {.steps = 21}}), "jenkins by iwan, 21 elements");
  EXPECT_EQ(Describe({"dahl", "table", {.steps = 64}}), "dahl by table, 64 intervals");
  EXPECT_EQ(Describe({"dahl", "dopri5", {.tolerance = 1e-4}}), "dahl by dopri5, tolerance 0.0001");
}

TEST(Approximation, EvaluatesAsAskedFor) {
  // α = 0 under the name of Jenkins' model: a corner at Tc/σ = 0.75.
  const std::vector<double> drive = {0.5, 1.0, 0.5};
  std::vector<double> force(3);
  Prepare({"jenkins", "exact"}, {4, 0.6, 3})({.displacement = drive}, force);
  EXPECT_THAT(force, ElementsAre(2, 3, 1));
  Prepare({"spring", ""}, {4, 0.6, 3})({.displacement = drive}, force);
  EXPECT_THAT(force, ElementsAre(2, 4, 2));
  Prepare({"coulomb", ""}, {4, 0.6, 3})({.displacement = drive}, force);
  EXPECT_THAT(force, ElementsAre(3, 3, -3));
}

TEST(Approximation, RefusesUnknownNames) {
  EXPECT_THROW(Prepare({"stribeck", "exact"}, {1, 0.5, 1}), InvalidArgument);
  EXPECT_THROW(Prepare({"mindlin", "leapfrog"}, {1, 0.5, 1}), InvalidArgument);
  EXPECT_THROW(Prepare({"mindlin", ""}, {1, 0.5, 1}), InvalidArgument);
  EXPECT_THROW(Describe({"mindlin", "leapfrog"}), InvalidArgument);
}

TEST(AllApproximations, NameTheModelsFromTheSimplestToTheExactOneThenItsMethods) {
  EXPECT_EQ(ExactModel({1, 1.0 / 3, 1}), "mindlin");
  EXPECT_EQ(ExactModel({1, 0.0, 1}), "jenkins");
  EXPECT_EQ(ExactModel({1, 1.0, 1}), "mindlin-dahl");
  for (const double alpha : {0.0, 1.0 / 3, 1.0}) {
    const BranchLaw law{1, alpha, 1};
    std::vector<std::string> models = {"spring",          "coulomb", "jenkins",
                                       "simplified-dahl", "dahl",    "mindlin"};
    if (alpha == 1) models.emplace_back("mindlin-dahl");
    const std::vector<Approximation> all = AllApproximations(law);
    std::set<std::string> names;
    std::set<std::string> methods;
    for (std::size_t i = 0; i < all.size(); ++i) {
      EXPECT_EQ(all[i].model, i < models.size() ? models[i] : ExactModel(law));
      EXPECT_TRUE(names.insert(Describe(all[i])).second) << Describe(all[i]);
      methods.insert(all[i].method);
    }
    EXPECT_EQ(methods.size(), Methods().size() + 1);  // and "" of the limit laws
  }
}

}  // namespace
}  // namespace mindahl::tradeoff::approximation_test
