#include "mindahl/request/fit_request.h"

#include <tuple>

#include "support/prelude.h"

namespace mindahl::request::fit_request_test {
namespace {

TEST(FitRequest, KnowsTheMeanOfSeveralNormalLoads) {
  ContactOptions options;
  const std::vector<contact::UncertainValue> loads = {{20.0, 3.0}, {40.0, 4.0}};
  SetNormalLoads(options, loads);
  EXPECT_EQ(options.known.normal_load->value, 30.0);
  EXPECT_EQ(options.known.normal_load->standard_error, 2.5);  // √(3² + 4²)/2
  SetNormalLoads(options, {});
  EXPECT_FALSE(IsAnythingGiven(options));
}

TEST(FitRecords, NeedsARecord) { EXPECT_THROW(FitRecords({}, {}), InputError); }

TEST(FitRequest, BecomesOptionsWithItsLoadsTermsAndColumns) {
  FitRequest request;
  request.fit.model = models::FindFrictionModel("dahl");
  request.fit.start["sigma"] = 3e7;
  request.fit.priors["sigma"] = {2e7, 1e6};
  request.fit.fixed["lag"] = 0.0625;
  request.fit.terms = {"rig_stiffness"};
  request.fit.covariates = {"2"};
  request.terms = {"viscous", "pressure"};
  request.contact.normal_loads = {{30.0, 1.0}, {40.0, 2.0}};
  const identification::FitOptions fit = MakeFitOptions(request);
  EXPECT_EQ(fit.model->name, "dahl");
  EXPECT_EQ(fit.start, request.fit.start);
  EXPECT_EQ(fit.priors.at("sigma").value, 2e7);
  EXPECT_EQ(fit.priors.at("sigma").standard_uncertainty, 1e6);
  EXPECT_EQ(fit.fixed, request.fit.fixed);
  EXPECT_THAT(fit.terms, ElementsAre("rig_stiffness", "viscous"));
  EXPECT_THAT(fit.covariates, ElementsAre("2", "pressure"));
  EXPECT_THAT(fit.normal_loads, ElementsAre(30.0, 40.0));
}

std::string RefusalOf(const FitRequest& request) {
  return MessageOf<std::exception>([&] { MakeFitOptions(request); });
}

using Change = std::function<void(FitRequest&)>;

TEST(FitRequest, RefusesAStartOfWhatIsNotFitted) {
  const Change as_it_is = [](FitRequest&) {};
  for (const auto& [name, change, is_fitted] : std::vector<std::tuple<std::string, Change, bool>>{
           {"alpha", as_it_is, true},
           {"alpha", [](FitRequest& r) { r.fit.fixed["alpha"] = 0.25; }, false},
           {"alpha", [](FitRequest& r) { r.fit.model = models::FindFrictionModel("mindlin"); },
            false},
           {"force_offset", as_it_is, true},
           {"displacement_offset", as_it_is, true},
           {"viscous", as_it_is, false},
           {"viscous", [](FitRequest& r) { r.terms = {"viscous"}; }, true},
           {"rig_stiffness", as_it_is, false}}) {
    FitRequest request;
    request.fit.start[name] = 0.25;
    change(request);
    EXPECT_EQ(RefusalOf(request),
              is_fitted ? ""
                        : fmt::format("--start: {} is not fitted, so this has no effect: leave it "
                                      "out, or add --terms NAME",
                                      name));
  }
}

TEST(FitRequest, TakesTermsByTheirNamesAndColumnsByTheirs) {
  const auto with = [](const std::vector<std::string>& terms) {
    return FitRequest{.terms = terms};
  };
  EXPECT_THAT(MakeFitOptions(with({})).terms, IsEmpty());
  EXPECT_THAT(MakeFitOptions(with({"viscous", "slip_position"})).terms,
              ElementsAre("viscous", "slip_slope", "plateau_slope"));
  EXPECT_THAT(MakeFitOptions(with({"lag", "oil pressure"})).covariates,
              ElementsAre("oil pressure"));
}

TEST(FitRequest, FixesATermTogetherWithWhatItNeeds) {
  const auto terms = [](const char* name, double value) {
    FitRequest request;
    request.fit.fixed[name] = value;
    const identification::FitOptions made = MakeFitOptions(request);
    EXPECT_EQ(made.fixed.at(name), value);
    return made.terms;
  };
  EXPECT_THAT(terms("viscous", 3.0), IsEmpty());
  EXPECT_THAT(terms("speed_exponent", 0.5), ElementsAre("viscous"));
  EXPECT_THAT(terms("slip_speed_exponent", 0.5), ElementsAre("slip_speed"));
  EXPECT_THAT(terms("ripple_period", 1e-3), SizeIs(4));
}

TEST(FitRequest, RefusesForADisplacementWhatNeedsAForce) {
  const std::vector<std::pair<const char*, Change>> refused = {
      {"rig_stiffness has no place", [](FitRequest& r) { r.fit.terms = {"rig_stiffness"}; }},
      {"covariate has no place", [](FitRequest& r) { r.fit.covariates = {"p"}; }},
      {"--terms auto cannot", [](FitRequest& r) { r.chooses_terms = true; }},
      {"lag has no place", [](FitRequest& r) { r.terms = {"lag"}; }},
      {"--compare cannot", [](FitRequest& r) { r.compare = true; }},
      {"noise of the force", [](FitRequest& r) { r.fit.force_noise = 0.5; }},
      {"displacement noise [m]",
       [](FitRequest& r) { r.fit.preparation.displacement_noise = 0.0; }}};
  for (const auto& [words, change] : refused) {
    FitRequest request;
    change(request);
    EXPECT_EQ(RefusalOf(request), "") << words;
    request.fit.preparation.excitation = loop::Channel::kForce;
    EXPECT_THAT(RefusalOf(request), HasSubstr(words));
  }
  FitRequest drift;
  drift.fit.preparation.excitation = loop::Channel::kForce;
  drift.terms = {"displacement_drift"};
  EXPECT_THAT(MakeFitOptions(drift).terms, ElementsAre("displacement_drift"));
}

TEST(FitRequest, OfACycleRefusesWhatIsOfATest) {
  const std::vector<std::pair<const char*, Change>> refused = {
      {"--noise-in displacement",
       [](FitRequest& r) { r.fit.preparation.excitation = loop::Channel::kForce; }},
      {"--terms asymmetry", [](FitRequest& r) { r.terms = {"asymmetry"}; }},
      {"'pressure' is no term", [](FitRequest& r) { r.terms = {"pressure"}; }},
      {"--covariate", [](FitRequest& r) { r.fit.covariates = {"pressure"}; }},
      {"--compare", [](FitRequest& r) { r.compare = true; }}};
  for (const auto& [words, change] : refused) {
    FitRequest request;
    change(request);
    EXPECT_THAT([&] { MakeCycleFitOptions(request); },
                ::testing::ThrowsMessage<InputError>(HasSubstr(words)));
  }
}

// --- what is established

TEST(Established, IsWhatConvergedAndWhereStrictIsKnownByAModelThatDescribesIt) {
  using identification::AdequacyVerdict;
  using identification::Identifiability;
  struct Row {
    AdequacyVerdict verdict;
    Identifiability identifiability;
    bool doubtful, adequate;  // whether it is established so strictly
  };
  for (const Row& row :
       {Row{AdequacyVerdict::kAdequate, Identifiability::kIdentifiable, true, true},
        {AdequacyVerdict::kAdequate, Identifiability::kBoundedBelow, false, false},
        {AdequacyVerdict::kDoubtful, Identifiability::kIdentifiable, true, false},
        {AdequacyVerdict::kDoubtful, Identifiability::kEffective, true, false},
        {AdequacyVerdict::kDoubtful, Identifiability::kBoundedBelow, false, false},
        {AdequacyVerdict::kInadequate, Identifiability::kIdentifiable, false, false}}) {
    identification::FitResult fit;
    fit.converged = true;
    fit.adequacy.verdict = row.verdict;
    identification::ParameterEstimate& sigma = fit.parameters.emplace_back();
    sigma.status = identification::ParameterStatus::kFree;
    sigma.identifiability = row.identifiability;
    EXPECT_EQ(WhyNotEstablished(fit, Strictness::kNone), "");
    EXPECT_EQ(WhyNotEstablished(fit, Strictness::kDoubtful).empty(), row.doubtful);
    EXPECT_EQ(WhyNotEstablished(fit, Strictness::kAdequate).empty(), row.adequate);
    sigma.status = identification::ParameterStatus::kFixed;
    EXPECT_EQ(WhyNotEstablished(fit, Strictness::kAdequate).empty(),
              row.verdict == AdequacyVerdict::kAdequate)
        << "one that is held";
    fit.converged = false;
    EXPECT_NE(WhyNotEstablished(fit, Strictness::kNone), "");
  }
}

// --- the contact

TEST(ResolveLaw, OfAContactIsMindlinsOfIt) {
  LawRequest request;
  request.contact.known = {.friction_coefficient = contact::UncertainValue{0.25, 0.0625},
                           .normal_load = contact::UncertainValue{80.0, 0.0},
                           .contact_radius = contact::UncertainValue{2e-3, 0.0},
                           .tangential_compliance = contact::UncertainValue{4e-11, 0.0}};
  EXPECT_EQ(ResolveLaw(request).shape_exponent, 1.0 / 3);
  EXPECT_DOUBLE_EQ(ResolveLaw(request).tangential_stiffness, 4e8);
  EXPECT_DOUBLE_EQ(ResolveLaw(request).slip_force, 20.0);
}

TEST(ResolveLaw, TakesAContactOrItsParametersAndNamesWhatIsMissing) {
  const auto refusal = [](const LawRequest& request) {
    return MessageOf<std::exception>([&] { ResolveLaw(request); });
  };
  LawRequest request;
  EXPECT_THAT(refusal(request), StartsWith("--sigma missing"));
  request.sigma = 4e7;
  EXPECT_THAT(refusal(request), StartsWith("--slip-force missing"));
  request.slip_force = 40.0;
  EXPECT_EQ(refusal(request), "");
  EXPECT_EQ(ResolveLaw(request).shape_exponent, 1.0 / 3);
  request.alpha = 0.75;
  const models::BranchLaw law = ResolveLaw(request);
  EXPECT_EQ(law.tangential_stiffness, 4e7);
  EXPECT_EQ(law.shape_exponent, 0.75);
  EXPECT_EQ(law.slip_force, 40.0);
  EXPECT_EQ(ResolveLaw(request, "mindlin-dahl", std::nullopt).shape_exponent, 0.75);
  EXPECT_EQ(ResolveLaw(request, "x", 0.75).shape_exponent, 0.75);
  EXPECT_THROW(ResolveLaw(request, "jenkins", 0.0), InputError);
  request.contact.known.normal_load = 10.0;
  EXPECT_THAT(refusal(request), HasSubstr("--sigma and --slip-force exclude"));
  request.sigma.reset();
  request.slip_force.reset();
  EXPECT_THAT(refusal(request),
              StartsWith("a contact needs --friction, --normal-load and either --contact-radius"));
}

}  // namespace
}  // namespace mindahl::request::fit_request_test
