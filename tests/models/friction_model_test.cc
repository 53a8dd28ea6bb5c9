#include "mindahl/models/friction_model.h"

#include "support/prelude.h"

namespace mindahl::models::friction_model_test {
namespace {

TEST(FrictionModels, AreFoundByTheNamesOfTheCommandLine) {
  for (const std::string_view name :
       {"mindlin-dahl", "mindlin", "jenkins", "dahl", "simplified-dahl"}) {
    const FrictionModel* model = FindFrictionModel(name);
    ASSERT_NE(model, nullptr) << name;
    EXPECT_EQ(model->name, name);
  }
  EXPECT_EQ(FindFrictionModel("Mindlin"), nullptr);
  EXPECT_EQ(FindFrictionModel(""), nullptr);
}

TEST(FrictionModels, PrescribeTheShapeExponentWhereTheNameDoes) {
  EXPECT_EQ(FindFrictionModel("mindlin")->shape_exponent, 1.0 / 3.0);
  EXPECT_EQ(FindFrictionModel("jenkins")->shape_exponent, 0.0);
  EXPECT_FALSE(FindFrictionModel("mindlin-dahl")->shape_exponent.has_value());
  EXPECT_FALSE(FindFrictionModel("dahl")->shape_exponent.has_value());
}

TEST(FrictionModels, ScaleDerivativesAreThoseOfTheScale) {
  // v is linear in force and peak: differences are exact but for rounding.
  constexpr double kStep = 0x1p-10;
  constexpr double kRounding = 1e-12;
  for (const FrictionModel& model : FrictionModels()) {
    for (const double force : {-0.7, -0.1, 0.3}) {
      for (const double peak : {0.2, 0.8}) {
        const BranchScale scale = model.scale(force, peak, false);
        EXPECT_NEAR((model.scale(force + kStep, peak, false).remaining - scale.remaining) / kStep,
                    scale.remaining_per_force, kRounding)
            << model.name;
        const double per_peak =
            (model.scale(force, peak + kStep, false).remaining - scale.remaining) / kStep;
        EXPECT_NEAR(per_peak, scale.remaining_per_peak, kRounding) << model.name;
        EXPECT_EQ(model.scaled_by_peak, per_peak != 0.0) << model.name;
      }
    }
  }
}

TEST(FrictionModels, SteadyPeakDerivativesAreThoseOfThePeak) {
  // Fourth-order central differences: h⁴ of a fifth derivative and ε/h, both about 1e-12.
  constexpr double kStep = 1e-3;
  constexpr double kDifference = 2e-10;
  const auto difference = [](auto function) {
    return (8 * (function(kStep) - function(-kStep)) -
            (function(2 * kStep) - function(-2 * kStep))) /
           (12 * kStep);
  };
  for (const FrictionModel& model : FrictionModels()) {
    for (const double alpha : {0.2, 1.0 / 3.0, 0.9, 1.0, 1.1, 2.5, 8.0}) {
      for (const double y : {0.01, 0.1, 0.3, 0.6}) {
        const SteadyPeak peak = model.steady_peak(y, alpha);
        EXPECT_NEAR(peak.per_log_stiffness, difference([&](double h) {
                      return model.steady_peak(y * std::exp(h), alpha).force;
                    }),
                    kDifference)
            << model.name << ' ' << alpha << ' ' << y;
        EXPECT_NEAR(peak.per_shape,
                    difference([&](double h) { return model.steady_peak(y, alpha + h).force; }),
                    kDifference)
            << model.name << ' ' << alpha << ' ' << y;
      }
    }
  }
}

}  // namespace
}  // namespace mindahl::models::friction_model_test
