#include "mindahl/tradeoff/approximation.h"

#include <set>

#include "support/prelude.h"

namespace mindahl::tradeoff::approximation_test {
namespace {

using namespace models;
using namespace methods;

TEST(Approximation, IsDescribedInTheSingularAndThePlural) {
  EXPECT_EQ(Describe({"spring", ""}), "spring");
  EXPECT_EQ(Describe({"mindlin", "exact"}), "mindlin by exact");
  EXPECT_EQ(Describe({"mindlin", "rk4", {.steps = 1}}), "mindlin by rk4, 1 substep a sample");
  EXPECT_EQ(Describe({"mindlin", "rk4", {.steps = 4}}), "mindlin by rk4, 4 substeps a sample");
  EXPECT_EQ(Describe({"jenkins", "iwan", {.steps = 1}}), "jenkins by iwan, 1 element");
  EXPECT_EQ(Describe({"jenkins", "iwan", {.steps = 21}}), "jenkins by iwan, 21 elements");
  EXPECT_EQ(Describe({"dahl", "table", {.steps = 1}}), "dahl by table, 1 interval");
  EXPECT_EQ(Describe({"dahl", "dopri5", {.tolerance = 1e-4}}), "dahl by dopri5, tolerance 0.0001");
  EXPECT_EQ(Describe({"dahl", "dopri5", {.steps = 3, .tolerance = 1e-4}}),
            "dahl by dopri5, tolerance 0.0001, 3 substeps a sample at least");
}

TEST(Approximation, TakesAlphaFromTheModelThatPrescribesIt) {
  const BranchLaw law{4, 0.6, 3};
  EXPECT_EQ(LawOf({"mindlin", "exact"}, law).shape_exponent, 1.0 / 3);
  EXPECT_EQ(LawOf({"jenkins", "exact"}, law).shape_exponent, 0.0);
  EXPECT_EQ(LawOf({"mindlin-dahl", "exact"}, law).shape_exponent, 0.6);
  EXPECT_EQ(LawOf({"spring", ""}, law).shape_exponent, 0.6);
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

std::vector<std::string> Models(const std::vector<Approximation>& ladder) {
  std::vector<std::string> models;
  for (const Approximation& approximation : ladder) models.push_back(approximation.model);
  return models;
}

TEST(Ladder, NamesTheModelsFromTheSimplestToTheExactOneOnce) {
  EXPECT_THAT(Models(ModelLadder({1, 1.0 / 3, 1})),
              ElementsAre("spring", "coulomb", "jenkins", "simplified-dahl", "dahl", "mindlin"));
  EXPECT_THAT(Models(ModelLadder({1, 0.5, 1})),
              ElementsAre("spring", "coulomb", "jenkins", "simplified-dahl", "dahl", "mindlin",
                          "mindlin-dahl"));
  EXPECT_EQ(ExactModel({1, 1.0 / 3, 1}), "mindlin");
  EXPECT_EQ(ExactModel({1, 0.0, 1}), "jenkins");
  EXPECT_EQ(ExactModel({1, 1.0, 1}), "mindlin-dahl");
}

TEST(Ladder, HoldsEveryMethodAndEachWayOnce) {
  for (const double alpha : {0.0, 1.0 / 3, 1.0}) {
    const BranchLaw law{1, alpha, 1};
    const std::vector<Approximation> all = AllApproximations(law);
    std::set<std::string> names;
    std::set<std::string> methods;
    for (const Approximation& approximation : all) {
      EXPECT_TRUE(names.insert(Describe(approximation)).second) << Describe(approximation);
      methods.insert(approximation.method);
    }
    EXPECT_EQ(methods.size(), Methods().size() + 1);  // and "" of the limit laws
    EXPECT_EQ(all.size(), ModelLadder(law).size() + MethodLadder(law).size() - 1);
    const std::vector<Approximation> models = ModelLadder(law);
    for (std::size_t i = 0; i < models.size(); ++i) EXPECT_EQ(all[i].model, models[i].model);
  }
}

}  // namespace
}  // namespace mindahl::tradeoff::approximation_test
