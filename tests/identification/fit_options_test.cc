#include "identification/sample_loop.h"
#include "mindahl/identification/fit.h"
#include "recovery/recovered.h"
#include "support/prelude.h"

// What Fit accepts, what it refuses with which words, and what each option does.
namespace mindahl::identification::fit_options_test {
namespace {

TEST(FitOptions, EachOptionThatBreaksARuleIsNamedWithItsValueAndTheRule) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const std::pair<FitOptions, const char*> cases[] = {
      {{.model = nullptr}, "there is no model to be fitted"},
      {{.preparation = {.force_sense = 2}}, "force sign [-] = 2 is invalid: must be +1 or -1"},
      {{.force_noise = 0}, "force_noise [N] = 0 is invalid: must be finite and > 0"},
      {{.preparation = {.reversal_gate = -1}},
       "reversal gate [m] = -1 is invalid: must be finite and >= 0"},

      {{.preparation = {.displacement_noise = -1e-9}},
       "displacement noise [m] = -1e-09 is invalid: must be finite and >= 0"},
      {{.max_iterations = 0}, "maximum iterations [-] = 0 is invalid: must be >= 1"},
      {{.fixed = {{"stiffness", 1}}},
       "fixed parameter 'stiffness' is unknown: must be one of sigma, alpha, slip_force, "
       "rig_stiffness, "
       "load_exponent, asymmetry, plateau_slope, viscous, speed_exponent, inertia, slip_slope, "
       "slip_curvature, slip_speed, slip_speed_exponent, slip_trend, drag_fraction, "
       "drag_exponent, plateau_curvature, ripple_period, "
       "ripple_cosine_up, ripple_sine_up, ripple_cosine_down, ripple_sine_down, lag, backlash, "
       "force_offset, displacement_offset, force_drift"},
      {{.fixed = {{"sigma", 0}}}, "fixed sigma [N/m] = 0 is invalid: must be finite and > 0"},
      {{.fixed = {{"alpha", -0.1}}}, "fixed alpha [-] = -0.1 is invalid: must be finite and >= 0"},
      {{.start = {{"slip_force", -3}}},
       "start of slip_force [N] = -3 is invalid: must be finite and > 0"},
      {{.fixed = {{"force_offset", kNan}}},
       "fixed force_offset [N] = nan is invalid: must be finite"},
      {{.bounds = {{"alpha", {1, 0.5}}}},
       "bounds 1:0.5 of alpha are invalid: the first must be smaller"},
      {{.bounds = {{"sigma", {-1, 5}}}},
       "bound of sigma [N/m] = -1 is invalid: must be finite and > 0"},
      {{.model = &Model("mindlin"), .fixed = {{"alpha", 0.5}}},
       "alpha cannot be fixed at 0.5: the model 'mindlin' prescribes alpha = 0.3333333333333333; "
       "use mindlin-dahl"},
      {{.initial_state = InitialState::kSteady, .fixed = {{"displacement_offset", 0}}},
       "displacement_offset cannot be fixed: that of a steady contact is the centre of its loop; "
       "fix it for a virgin contact"},
      {{.start = {{"alpha", 0.75}}, .bounds = {{"alpha", {0.1, 0.5}}}},
       "start of alpha [-] = 0.75 is invalid: must lie within its bounds 0.1 … 0.5"},
  };
  for (const auto& [options, message] : cases) EXPECT_EQ(RefusalOf({Loop()}, options), message);
  EXPECT_THAT(RefusalOf({Loop()}, {.preparation = {.held_out = {std::vector{true, false}}}}),
              HasSubstr("held-out mask"));
  EXPECT_THAT(RefusalOf({Loop()}, {.start = {{"force_offset_2", 1}}}),
              StartsWith("parameter with a start 'force_offset_2' is unknown: must be "
                         "one of sigma, "));
}

TEST(FitOptions, EachRecordThatCannotBeFittedIsRefusedWithTheReason) {
  EXPECT_EQ(RefusalOf({}, {}), "there is no record: a fit needs at least one");
  EXPECT_THAT(RefusalOf({MakeRecord({2, 2, 2}, {1, 2, 3})}, {}),
              StartsWith("half range of the displacement [m] = 0 is invalid"));
  EXPECT_THAT(RefusalOf({MakeRecord({1, 2, 3}, {4, 4, 4})}, {}),
              StartsWith("half range of the force [N] = 0 is invalid"));
  EXPECT_EQ(RefusalOf({MakeRecord({0, 1}, {0, 1})}, {}),
            "2 samples are too few for 3 free parameters: record more or fix some");
  EXPECT_EQ(RefusalOf({MakeRecord({0, 1, 0}, {0, 1, -1})}, {}),
            "3 samples are too few for 5 free parameters: record more or fix some");
  EXPECT_EQ(RefusalOf({MakeRecord({0, 1, 0, 1, 0, 0.5}, {0, 1, -1, 1, -1, 0})},
                      {.preparation = {.cycles = CountRange{3, 9}}}),
            "2 samples are too few for 5 free parameters; of 6 that were read 4 are left out: "
            "record more or fix some");
  EXPECT_THAT(RefusalOf({MakeRecord({0, 1, 0}, {0, 1})}, {}), HasSubstr("force"));
  Record broken = Loop();
  broken.force[17] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(RefusalOf({broken}, {}), "force [N] of sample 17 = nan is invalid: must be finite");
  broken = Loop();
  broken.displacement[3] = std::numeric_limits<double>::infinity();
  EXPECT_EQ(RefusalOf({broken}, {}),
            "displacement [m] of sample 3 = inf is invalid: must be finite");
}

TEST(FitOptions, NumbersWhoseSquaresOverflowOrVanishAreRefused) {
  for (const double scale : {1e250, 1e-250}) {
    EXPECT_THAT(RefusalOf({testing::Scaled(Loop(), scale, 1)}, {}),
                HasSubstr("half range of the displacement [m]"));
    EXPECT_THAT(RefusalOf({testing::Scaled(Loop(), 1, scale)}, {}),
                HasSubstr("must lie between 1e-100 and 1e100"));
  }
  // Just inside, the answer is as good as ever.
  const BranchLaw scaled = {kLaw.tangential_stiffness * 1e150, kLaw.shape_exponent,
                            kLaw.slip_force * 1e75};
  EXPECT_TRUE(Recovers(FitOne(testing::Scaled(Loop(), 1e-75, 1e75)), scaled, kNoiseFree));
}

TEST(FitOptions, FixedParametersKeepTheirValueAndFreeTheRest) {
  const FitResult fit =
      FitOne(Loop(), {.fixed = {{"alpha", kLaw.shape_exponent}, {"force_offset", 0.0}}});
  EXPECT_TRUE(Recovers(fit, kLaw, kNoiseFree));
  const ParameterEstimate& alpha = *fit.Find("alpha");
  EXPECT_EQ(alpha.value, kLaw.shape_exponent);
  EXPECT_EQ(alpha.status, ParameterStatus::kFixed);
  EXPECT_FALSE(alpha.standard_error || alpha.lower95 || alpha.upper95);
  EXPECT_EQ(fit.Find("sigma")->status, ParameterStatus::kFree);
  EXPECT_EQ(fit.Find("force_offset")->value, 0.0);
  const std::size_t row = fit.parameters.size();
  EXPECT_TRUE(std::isnan(fit.correlation[1]) && std::isnan(fit.correlation[row])) << "of alpha";
  EXPECT_EQ(fit.correlation[2], fit.correlation[2 * row]) << "of sigma and slip_force";
  EXPECT_EQ(fit.correlation[0], 1.0);
}

TEST(FitOptions, FixingEveryParameterEvaluatesTheModelThere) {
  const FitResult fit = FitOne(Loop(), {.initial_state = InitialState::kVirgin,
                                        .fixed = {{"sigma", kLaw.tangential_stiffness},
                                                  {"alpha", kLaw.shape_exponent},
                                                  {"slip_force", kLaw.slip_force},
                                                  {"force_offset", 7.0},
                                                  {"displacement_offset", 0.0}}});
  EXPECT_TRUE(fit.converged);
  // The record has no offset: every residual is the 7 N.
  EXPECT_NEAR(fit.residuals.rms, 7.0, 1e-9);
  for (const double residual : fit.records[0].residual) EXPECT_NEAR(residual, 7.0, 1e-9);
}

TEST(FitOptions, FixedUnloadedDisplacementMeansAVirginContact) {
  const FitResult fit = FitOne(Loop(), {.fixed = {{"displacement_offset", 0.0}}});
  EXPECT_EQ(fit.initial_state, InitialState::kVirgin);
  EXPECT_EQ(fit.Find("displacement_offset")->value, 0.0);
  EXPECT_TRUE(Recovers(fit, kLaw, kNoiseFree));
}

TEST(FitOptions, BoundThatExcludesTheTruthHoldsAndIsReported) {
  const double rounding = 1e-8;  // the bound is a scaled number
  const auto alpha_within = [](Interval bounds) {
    return *FitOne(Loop(), {.bounds = {{"alpha", bounds}}}).Find("alpha");
  };
  const ParameterEstimate lower = alpha_within({0.5, 2.0});
  EXPECT_EQ(lower.status, ParameterStatus::kAtLowerBound);
  EXPECT_NEAR(lower.value, 0.5, rounding);
  EXPECT_FALSE(lower.standard_error);
  EXPECT_TRUE(lower.is_at_given_bound());
  const ParameterEstimate upper = alpha_within({0.0, 0.3});
  EXPECT_EQ(upper.status, ParameterStatus::kAtUpperBound);
  EXPECT_NEAR(upper.value, 0.3, rounding);
  EXPECT_EQ(alpha_within({0.0, 0.5}).status, ParameterStatus::kFree);
  EXPECT_FALSE(alpha_within({0.0, 0.5}).is_at_given_bound());
}

TEST(FitOptions, NarrowBoundsAboutTheTruthKeepTheFit) {
  for (const char* const name : {"sigma", "alpha", "slip_force"}) {
    const double truth = FitOne(Loop()).Find(name)->value;
    FitOptions options;
    options.bounds[name] = {0.9995 * truth, 1.0005 * truth};
    const FitResult fit = FitOne(Loop(), options);
    EXPECT_EQ(fit.initial_state, InitialState::kVirgin) << name;
    EXPECT_TRUE(Recovers(fit, kLaw, kNoiseFree)) << name;
  }
}

TEST(FitOptions, BoundOfAnOffsetHasSignOfFile) {
  // The fit turns an opposite force round: its lower bound is the file's upper one.
  const Record opposite = testing::Scaled(Loop(), 1, -1);
  const FitResult fit = FitOne(opposite, {.bounds = {{"force_offset", {3.0, 9.0}}}});
  EXPECT_EQ(fit.force_sense, -1);
  const ParameterEstimate& offset = *fit.Find("force_offset");
  EXPECT_EQ(offset.status, ParameterStatus::kAtLowerBound);
  EXPECT_NEAR(offset.value, 3.0, 1e-7);
}

TEST(FitOptions, TooFewIterationsAreAResultThatHasNotConverged) {
  const FitResult fit = FitOne(Loop(), {.max_iterations = 1});
  EXPECT_FALSE(fit.converged);
  EXPECT_THAT(fit.solver.message, HasSubstr("iterations"));
  EXPECT_FALSE(fit.parameters.empty());
}

TEST(FitOptions, WrongForceSignFailsWithoutCrash) {
  const FitResult fit = FitOne(Loop(), {.preparation = {.force_sense = -1}});
  EXPECT_FALSE(fit.converged);
  EXPECT_TRUE(fit.parameters.empty());
  EXPECT_THAT(fit.solver.message, HasSubstr("no loop"));
}

}  // namespace
}  // namespace mindahl::identification::fit_options_test
