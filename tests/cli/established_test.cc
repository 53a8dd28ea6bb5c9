#include "cli/established.h"

#include <gtest/gtest.h>

namespace mindahl::cli::established_test {
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
  EXPECT_TRUE(Established(fit, /*strict=*/false));
  fit.converged = false;
  EXPECT_FALSE(Established(fit, /*strict=*/false));
}

TEST(Established, StrictlyEveryFreeParameterIsIdentifiable) {
  FitResult fit = KnownFit();
  EXPECT_TRUE(Established(fit, /*strict=*/true));
  fit.parameters[0].identifiability = Identifiability::kBoundedBelow;
  EXPECT_FALSE(Established(fit, /*strict=*/true));
  EXPECT_TRUE(Established(fit, /*strict=*/false));
  fit.parameters[0].status = ParameterStatus::kFixed;
  EXPECT_TRUE(Established(fit, /*strict=*/true));
}

TEST(Established, StrictlyTheModelIsNotInadequate) {
  FitResult fit = KnownFit();
  fit.adequacy.verdict = AdequacyVerdict::kDoubtful;
  EXPECT_TRUE(Established(fit, /*strict=*/true));
  fit.adequacy.verdict = AdequacyVerdict::kInadequate;
  EXPECT_FALSE(Established(fit, /*strict=*/true));
  EXPECT_TRUE(Established(fit, /*strict=*/false));
}

}  // namespace
}  // namespace mindahl::cli::established_test
