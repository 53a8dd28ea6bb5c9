

#include "../support/histories.h"
#include "mindahl/identification/model_selection.h"
#include "mindahl/models/excitation.h"
#include "support/prelude.h"

namespace mindahl::identification::simpler_laws_test {
namespace {

using models::BranchLaw;

constexpr BranchLaw kMindlin{4e7, 1.0 / 3, 40};

loop::Record Loop(std::string_view model, const BranchLaw& law, double lambda, double noise,
                  std::uint64_t seed = 1, double cycles = 3) {
  loop::Record record;
  record.displacement =
      models::MakeExcitation(
          {.amplitude = lambda * GrossSlipDisplacement(kMindlin), .cycles = cycles})
          .displacement;
  record.force = testing::Respond(testing::Model(model), law, record.displacement);
  Generator generator(seed);
  for (double& force : record.force) force += noise * testing::Normal(generator);
  return record;
}

const LawScore& Find(const SimplerLaws& laws, std::string_view model,
                     bool exponent_is_one = false) {
  return *std::ranges::find_if(laws.scores, [&](const LawScore& score) {
    return score.model == model && score.exponent_is_one == exponent_is_one;
  });
}

TEST(SimplerLaws, AreDistinguishedIfNoiseIsSmall) {
  const SimplerLaws laws = CompareSimplerLaws(Loop("mindlin", kMindlin, 1.2, 0.1));
  for (const char* model : {"spring", "coulomb", "jenkins"}) {
    EXPECT_TRUE(Find(laws, model).told_apart) << model;
  }
  EXPECT_TRUE(Find(laws, "dahl").told_apart) << "the record has a virgin branch";
  EXPECT_TRUE(Find(laws, "dahl", true).told_apart);
  EXPECT_FALSE(Find(laws, "mindlin").told_apart);
  EXPECT_FALSE(laws.scores[laws.best].told_apart);
  EXPECT_EQ(laws.scores[laws.best].misfit, 0);
  EXPECT_EQ(laws.scores[laws.best].delta_aicc, 0);
  EXPECT_TRUE(laws.describes_record);
}

TEST(SimplerLaws, SayWhereNoneDescribesTheRecord) {
  // A force as large as the loop's that is the same at either end of the motion: no law has it.
  loop::Record record = Loop("mindlin", kMindlin, 1.2, 0.1);
  const double amplitude = *std::ranges::max_element(record.displacement);
  for (std::size_t i = 0; i < record.force.size(); ++i) {
    const double share = record.displacement[i] / amplitude;
    record.force[i] += 30 * share * share;
  }
  EXPECT_FALSE(CompareSimplerLaws(record).describes_record);
}

TEST(SimplerLaws, AreNotWhereTheNoiseHidesThem) {
  // As much noise as force: Jenkins' element, 5 % of T* rms from the loop, is lost in it, 2 ln Λ
  // being 601·0.05² = 1.5 and chance. ΔAICc of 4 is then one in four at the most.
  constexpr int kRecords = 20;
  int told_apart = 0;
  for (std::uint64_t seed = 1; seed <= kRecords; ++seed) {
    const SimplerLaws laws = CompareSimplerLaws(Loop("mindlin", kMindlin, 1.2, 40, seed));
    if (Find(laws, "jenkins").told_apart) ++told_apart;
  }
  EXPECT_LE(told_apart, 11);  // beyond it P < 1e-3 of Binomial(20, 1/4)
}

TEST(SimplerLaws, RarelyRejectTheLawThatIsTrue) {
  // Mindlin's against the Masing law with free α, which nests it: ΔAICc of 4 is 2 ln Λ of 6 or so,
  // which chance exceeds once in 70.
  int told_apart = 0;
  constexpr int kRecords = 40;
  for (int seed = 1; seed <= kRecords; ++seed) {
    const SimplerLaws laws = CompareSimplerLaws(
        Loop("mindlin", kMindlin, 1.2, 1.0, static_cast<std::uint64_t>(seed), 2));
    if (Find(laws, "mindlin").told_apart) ++told_apart;
  }
  EXPECT_LE(told_apart, 4);  // beyond it P < 1e-3 of Binomial(40, 1/70)
}

}  // namespace
}  // namespace mindahl::identification::simpler_laws_test
