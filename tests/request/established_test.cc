
#include "mindahl/request/fit_request.h"
#include "support/prelude.h"

namespace mindahl::request::established_test {
namespace {

using namespace identification;

FitResult KnownFit() {
  FitResult fit;
  fit.converged = true;
  ParameterEstimate& sigma = fit.parameters.emplace_back();
  sigma.status = ParameterStatus::kFree;
  sigma.identifiability = Identifiability::kIdentifiable;
  return fit;
}

TEST(Established, IsAFitThatConverged) {
  FitResult fit = KnownFit();
  EXPECT_TRUE(Established(fit, Strictness::kNone));
  fit.converged = false;
  EXPECT_FALSE(Established(fit, Strictness::kNone));
}

TEST(Established, StrictlyEveryFreeParameterIsIdentifiable) {
  FitResult fit = KnownFit();
  EXPECT_TRUE(Established(fit, Strictness::kAdequate));
  fit.parameters[0].identifiability = Identifiability::kBoundedBelow;
  EXPECT_FALSE(Established(fit, Strictness::kAdequate));
  EXPECT_TRUE(Established(fit, Strictness::kNone));
  fit.parameters[0].status = ParameterStatus::kFixed;
  EXPECT_TRUE(Established(fit, Strictness::kAdequate));
}

TEST(Established, StrictlyTheModelIsAdequate) {
  FitResult fit = KnownFit();
  fit.adequacy.verdict = AdequacyVerdict::kDoubtful;
  EXPECT_FALSE(Established(fit, Strictness::kAdequate));
  EXPECT_TRUE(Established(fit, Strictness::kDoubtful));
  fit.adequacy.verdict = AdequacyVerdict::kInadequate;
  EXPECT_FALSE(Established(fit, Strictness::kAdequate));
  EXPECT_FALSE(Established(fit, Strictness::kDoubtful));
  EXPECT_TRUE(Established(fit, Strictness::kNone));
}

TEST(Established, DoubtfulTakesEffectiveParametersAndNoOpenOnes) {
  FitResult fit = KnownFit();
  fit.adequacy.verdict = AdequacyVerdict::kDoubtful;
  fit.parameters[0].identifiability = Identifiability::kEffective;
  EXPECT_TRUE(Established(fit, Strictness::kDoubtful));
  fit.parameters[0].identifiability = Identifiability::kBoundedBelow;
  EXPECT_FALSE(Established(fit, Strictness::kDoubtful));
}

}  // namespace
}  // namespace mindahl::request::established_test
