

#include "mindahl/campaign/test_summary.h"
#include "mindahl/models/friction_model.h"
#include "support/prelude.h"

namespace mindahl::campaign::shared_alpha_test {
namespace {

CycleFit Cycle(double alpha, double error, std::vector<std::string> flags = {}) {
  CycleFit fit;
  fit.alpha = {alpha, error};
  fit.flags = std::move(flags);
  return fit;
}

TEST(SharedAlpha, PoolsCyclesThatIdentifyAlpha) {
  PooledValue alpha;
  EXPECT_THROW(RequireSharedAlpha(alpha), InputError);
  PoolAlpha(Cycle(0.3, 0.01), alpha);
  PoolAlpha(Cycle(0.4, 0.01, {"glitches"}), alpha);
  PoolAlpha(Cycle(9.0, 0.01, {"alpha_open"}), alpha);
  PoolAlpha(Cycle(9.0, 0.01, {"not_converged"}), alpha);
  PoolAlpha(Cycle(9.0, 0.0), alpha);
  PoolAlpha(CycleFit{}, alpha);
  EXPECT_EQ(alpha.count(), 2U);
  EXPECT_DOUBLE_EQ(alpha.mean(), 0.35);
  EXPECT_NO_THROW(RequireSharedAlpha(alpha));
  EXPECT_THAT(SharedAlphaInWords(alpha), HasSubstr("shared alpha 0.35 ± 0.05, from 2 cycles"));
}

std::string Refusal(const identification::FitOptions& fit, const std::vector<std::string>& files) {
  try {
    RequireThatAlphaCanBeShared(fit, files);
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

TEST(SharedAlpha, RequiresFittedAlphaAndRepeatableInput) {
  identification::FitOptions fit;
  EXPECT_EQ(Refusal(fit, {}), "");
  EXPECT_THAT(Refusal(fit, {"/dev/null"}), HasSubstr("/dev/null can be read only once"));
  fit.fixed["alpha"] = 0.3;
  EXPECT_THAT(Refusal(fit, {}), HasSubstr("--fix holds it"));
  fit = {};
  fit.model = models::FindFrictionModel("mindlin");
  EXPECT_THAT(Refusal(fit, {}), HasSubstr("--model prescribes it"));
}

}  // namespace
}  // namespace mindahl::campaign::shared_alpha_test
