#include "mindahl/request/plan.h"

#include <nlohmann/json.hpp>

#include "support/histories.h"
#include "support/prelude.h"
#include "support/text.h"

// These tests concern the loops that a plan expects.
namespace mindahl::request::plan_test {
namespace {

constexpr double kNoise = 2e-8;  // [m]

/// A loop of 40 N whose displacement is read with a noise of kNoise.
io::RecordFile NoisyRecord() {
  constexpr std::uint64_t kSeed = 3;
  testing::Generator generator(kSeed);
  loop::Record record;
  for (int i = 0; i <= 600; ++i) {
    record.displacement.push_back(3e-6 * std::sin(2 * std::numbers::pi * i / 200));
  }
  record.force =
      testing::Respond(testing::Model("mindlin-dahl"), {4e7, 1.0 / 3, 40.0}, record.displacement);
  for (double& reading : record.displacement) reading += kNoise * testing::Normal(generator);
  for (double& force : record.force) force += 0.2 * testing::Normal(generator);
  io::RecordFile file;
  file.record = std::move(record);
  return file;
}

double ExpectedDisplacementNoise(double given) {
  PlanRequest request;
  request.record = &NoisyRecord;
  request.record_name = "loop.csv";
  request.displacement_noise = given;
  request.amplitudes = {3e-6};
  request.initial_state = models::InitialState::kSteady;
  return MakePlan(request, [](std::string_view) {}).expected.displacement_noise;
}

TEST(MakePlan, TakesTheDisplacementNoiseOfItsRecordUnlessOneIsGiven) {
  // The estimate from 600 third differences, neighbours correlated, scatters by less than a tenth.
  EXPECT_NEAR(ExpectedDisplacementNoise(0.0), kNoise, 0.3 * kNoise);
  EXPECT_EQ(ExpectedDisplacementNoise(5e-8), 5e-8);
}

/// One steady loop of a contact that is known, with noise of 0.2 N.
PlanRequest Known(double alpha = 1.0 / 3) {
  PlanRequest request;
  request.law.sigma = 4e7;
  request.law.alpha = alpha;
  request.law.slip_force = 40.0;
  request.force_noise = 0.2;
  request.amplitudes = {2e-6};
  request.initial_state = models::InitialState::kSteady;
  request.samples_per_cycle = 60;
  return request;
}

Plan Made(const PlanRequest& request) {
  return MakePlan(request, [](std::string_view) {});
}

TEST(MakePlan, CountsAmplitudesInDisplacementsAtSlip) {
  constexpr double kRounding = 1e-18;
  EXPECT_NEAR(Made(Known()).slip, 1.5e-6, kRounding);  // Tc/(σ(1 − α))
  PlanRequest behind = Known();
  behind.rig_stiffness = 8e7;  // the rig deflects by Tc/k
  EXPECT_NEAR(Made(behind).slip, 1.5e-6 + 0.5e-6, kRounding);
  behind.law.alpha = 1.0;  // slip is only approached: three elastic limits
  EXPECT_NEAR(Made(behind).slip, 3e-6 + 0.5e-6, kRounding);
  behind.rig_stiffness.reset();
  EXPECT_NEAR(Made(behind).slip, 3e-6, kRounding);
}

TEST(MakePlan, LooksAtThirteenAmplitudesAboutSlipOrAtThoseAsked) {
  PlanRequest request = Known();
  EXPECT_EQ(Made(request).columns.at(0).loops.size(), 1U);
  request.amplitudes.clear();
  request.initial_state.reset();
  const Plan plan = Made(request);
  ASSERT_EQ(plan.columns.size(), 2U);
  EXPECT_EQ(plan.columns[0].initial_state, "virgin");
  EXPECT_EQ(plan.columns[1].initial_state, "steady");
  for (const PlannedLoops& column : plan.columns) {
    ASSERT_EQ(column.loops.size(), 13U);
    EXPECT_NEAR(column.loops.front().protocol.amplitude, 0.15e-6, 1e-18);
    EXPECT_NEAR(column.loops[6].protocol.amplitude, 1.5e-6, 1e-18);
    EXPECT_NEAR(column.loops.back().protocol.amplitude, 15e-6, 1e-18);
  }
  EXPECT_EQ(plan.columns[0].loops[6].protocol.initial_state, models::InitialState::kVirgin);
}

TEST(MakePlan, ExpectsTheErrorsOfItsProtocol) {
  PlanRequest request = Known();
  request.rig_stiffness = 8e7;
  request.with = {"viscous"};
  request.autocorrelation = 0.3;
  request.displacement_noise = 2e-9;
  request.cycles = 2;
  const Plan plan = Made(request);
  identification::Expectation expected;
  expected.law = {4e7, 1.0 / 3, 40.0};
  expected.rig.stiffness = 8e7;
  expected.force_noise = 0.2;
  expected.displacement_noise = 2e-9;
  expected.autocorrelation = 0.3;
  identification::FitOptions options;
  options.terms = {"viscous"};
  const identification::ExpectedFit fit =
      identification::ExpectFit(expected,
                                {.amplitude = 2e-6,
                                 .cycles = 2,
                                 .samples_per_cycle = 60,
                                 .initial_state = models::InitialState::kSteady},
                                options);
  const auto json = nlohmann::json::parse(ToJson(plan));
  const auto& loop = json["loops"][0];
  EXPECT_EQ(loop["initial_state"], "steady");
  EXPECT_EQ(loop["amplitude"], 2e-6);
  EXPECT_EQ(loop["peak_force"], fit.peak_force);
  for (const char* name : {"sigma", "alpha", "slip_force", "viscous"}) {
    EXPECT_EQ(loop["parameters"][name]["value"], fit.Find(name)->value) << name;
    EXPECT_EQ(loop["parameters"][name]["standard_error"], *fit.Find(name)->standard_error) << name;
  }
  EXPECT_EQ(json["expected"]["rig_stiffness"], 8e7);
  EXPECT_EQ(json["expected"]["force_noise"], 0.2);
  EXPECT_EQ(json["expected"]["displacement_noise"], 2e-9);
  EXPECT_EQ(json["expected"]["gross_slip_displacement"], plan.slip);
  EXPECT_EQ(json["protocol"]["cycles"], 2.0);
  EXPECT_EQ(json["protocol"]["samples_per_cycle"], 60);
}

TEST(MakePlan, OfALoadSeriesIsOfTheLawAtTheMeanLoad) {
  PlanRequest request = Known();
  request.load_ratios = {0.5, 1.0, 3.0};
  request.load_exponent = 0.4;
  const identification::ExpectedFit fit = Made(request).columns[0].loops[0];
  constexpr double kRounding = 1e-9;
  EXPECT_NEAR(fit.Find("slip_force")->value, 1.5 * 40, 60 * kRounding);  // the mean load is 1.5
  EXPECT_NEAR(fit.Find("sigma")->value / (4e7 * std::pow(1.5, 0.4)), 1.0, kRounding);
  EXPECT_NEAR(fit.Find("load_exponent")->value, 0.4, kRounding);
  request.load_ratios.clear();
  EXPECT_THROW(Made(request), InputError);
}

/// A plan set by hand: of a virgin and a steady contact two amplitudes each.
Plan MadeByHand() {
  Plan plan;
  plan.slip = 0.5;
  plan.request.cycles = 3.5;
  plan.request.samples_per_cycle = 60;
  plan.expected.law = {2.5, 0.75, 1.5};
  plan.expected.force_noise = 0.125;
  plan.expected.displacement_noise = 0.0625;
  const auto parameter = [](const char* name, const char* unit, double value,
                            std::optional<double> error) {
    identification::ParameterEstimate estimate;
    estimate.name = name;
    estimate.unit = unit;
    estimate.value = value;
    estimate.standard_error = error;
    estimate.status = identification::ParameterStatus::kFree;
    return estimate;
  };
  for (const char* state : {"virgin", "steady"}) {
    PlannedLoops& column = plan.columns.emplace_back();
    column.initial_state = state;
    const bool is_virgin = column.initial_state == "virgin";
    for (const double amplitude : {1.25, 2.25}) {
      identification::ExpectedFit& fit = column.loops.emplace_back();
      fit.protocol.amplitude = amplitude;
      fit.peak_force = amplitude + 8;
      // σ known to its value; α by as much as it is; Tc not at all in the steady loop.
      fit.parameters = {
          parameter("sigma", "N/m", 2.5, amplitude < 2 ? 2.5 : std::nextafter(2.5, 0.0)),
          parameter("alpha", "-", 0.75, 0.25),
          parameter("slip_force", "N", 1.5,
                    is_virgin ? std::optional(0.0375) : std::optional<double>())};
      fit.law_evidence = is_virgin ? std::nextafter(10.0, 11.0) : 10.0;
    }
  }
  return plan;
}

TEST(PlanJson, HasEveryNumberUnderItsName) {
  Plan plan = MadeByHand();
  plan.columns[0].loops.pop_back();
  plan.columns[1].loops.pop_back();
  plan.request.wanted = {{"alpha", {.value = 0.5}},
                         {"sigma", {.value = 0.25, .is_relative = true}}};
  plan.columns[0].reached = plan.columns[0].loops[0];
  plan.columns[1].fewest = {.amplitude = 7.5, .cycles = 9.0};
  auto json = nlohmann::json::parse(ToJson(plan));
  json.erase("version");
  EXPECT_EQ(json, nlohmann::json::parse(R"({
    "schema": "mindahl.plan/1",
    "expected": {"sigma": 2.5, "alpha": 0.75, "slip_force": 1.5, "rig_stiffness": null,
      "force_noise": 0.125, "displacement_noise": 0.0625, "autocorrelation": 0,
      "load_exponent": null, "gross_slip_displacement": 0.5},
    "protocol": {"cycles": 3.5, "samples_per_cycle": 60, "load_ratios": []},
    "loops": [
      {"initial_state": "virgin", "amplitude": 1.25, "peak_force": 9.25, "parameters": {
        "sigma": {"value": 2.5, "unit": "N/m", "standard_error": 2.5},
        "alpha": {"value": 0.75, "unit": "-", "standard_error": 0.25},
        "slip_force": {"value": 1.5, "unit": "N", "standard_error": 0.0375}},
       "law_evidence": 10.000000000000002, "law_decided": true},
      {"initial_state": "steady", "amplitude": 1.25, "peak_force": 9.25, "parameters": {
        "sigma": {"value": 2.5, "unit": "N/m", "standard_error": 2.5},
        "alpha": {"value": 0.75, "unit": "-", "standard_error": 0.25},
        "slip_force": {"value": 1.5, "unit": "N", "standard_error": null}},
       "law_evidence": 10, "law_decided": false}],
    "wanted": {"alpha": {"standard_error": 0.5, "relative": false},
               "sigma": {"standard_error": 0.25, "relative": true}},
    "reached": [
      {"initial_state": "virgin", "least_amplitude": 1.25, "fewest_cycles": null,
       "amplitude_of_fewest_cycles": null},
      {"initial_state": "steady", "least_amplitude": null, "fewest_cycles": 9,
       "amplitude_of_fewest_cycles": 7.5}]})"));
  plan.request.load_ratios = {0.5, 2.0};
  plan.expected.load_exponent = 0.375;
  plan.expected.rig.stiffness = 8.5;
  plan.expected.autocorrelation = 0.25;
  json = nlohmann::json::parse(ToJson(plan));
  EXPECT_EQ(json["expected"]["load_exponent"], 0.375);
  EXPECT_EQ(json["expected"]["rig_stiffness"], 8.5);
  EXPECT_EQ(json["expected"]["autocorrelation"], 0.25);
  EXPECT_EQ(json["protocol"]["load_ratios"], (std::vector<double>{0.5, 2.0}));
}

TEST(MakePlan, RefusesWhatItCannotPlan) {
  const auto refusal = [](const auto& change) -> std::string {
    PlanRequest request = Known();
    change(request);
    return MessageOf<std::exception>([&] { Made(request); });
  };
  EXPECT_THAT(refusal([](PlanRequest& r) { r.with = {"inertia"}; }),
              HasSubstr("--with: 'inertia' cannot be planned for"));
  EXPECT_THAT(refusal([](PlanRequest& r) { r.with = {"rig_stiffness"}; }),
              StartsWith("--with rig_stiffness needs --rig-stiffness"));
  EXPECT_EQ(refusal([](PlanRequest& r) {
              r.with = {"rig_stiffness"};
              r.rig_stiffness = 8e7;
            }),
            "");
  EXPECT_THAT(refusal([](PlanRequest& r) { r.force_noise.reset(); }),
              StartsWith("--force-noise missing"));
  EXPECT_THAT(refusal([](PlanRequest& r) { r.displacement_noise = -1; }),
              HasSubstr("--displacement-noise [m]"));
  EXPECT_THAT(refusal([](PlanRequest& r) {
                r.wanted = {{"sigm", {.value = 1}}};
              }),
              HasSubstr("--want: 'sigm' is no parameter"));
  EXPECT_THAT(refusal([](PlanRequest& r) { r.record = &NoisyRecord; }),
              StartsWith("--record excludes --sigma"));
}

TEST(MakePlan, TakesTheLawOfItsRecordAndSaysWhatIsNotKnown) {
  PlanRequest request;
  request.record = &NoisyRecord;
  request.record_name = "loop.csv";
  request.force_noise = 0.75;
  request.amplitudes = {3e-6};
  request.initial_state = models::InitialState::kSteady;
  request.law.alpha = 0.25;
  std::vector<std::string> said;
  const Plan plan = MakePlan(request, [&](std::string_view text) { said.emplace_back(text); });
  EXPECT_EQ(plan.expected.law.shape_exponent, 0.25);
  EXPECT_NEAR(plan.expected.law.slip_force, 40.0, 1.0);  // at another α, a little off
  EXPECT_EQ(plan.expected.force_noise, 0.75);
  // 500 samples of a line, known in no part: σ and Tc are guesses, and Mindlin's α is taken.
  PlanRequest open = request;
  open.law.alpha.reset();
  open.force_noise.reset();
  open.record = [] {
    io::RecordFile file = NoisyRecord();
    testing::Generator generator(5);
    for (std::size_t i = 0; i < file.record.size(); ++i) {
      file.record.displacement[i] *= 0.02;
      file.record.force[i] = 4e7 * file.record.displacement[i] + 0.2 * testing::Normal(generator);
    }
    return file;
  };
  said.clear();
  const Plan guessed = MakePlan(open, [&](std::string_view text) { said.emplace_back(text); });
  ASSERT_FALSE(said.empty());
  EXPECT_THAT(said.front(), StartsWith("loop.csv: "));
  EXPECT_THAT(said, Contains(HasSubstr("alpha is not identified: Mindlin's 1/3 is assumed")));
  EXPECT_EQ(guessed.expected.law.shape_exponent, 1.0 / 3);
}

}  // namespace
}  // namespace mindahl::request::plan_test
