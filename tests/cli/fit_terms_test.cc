#include "cli/command_line.h"
#include "support/imposed_force.h"
#include "support/variable_load.h"

// fit: what the model may have beside σ, α and Tc, which samples count and how much, the choice
// between models, and what the report says of each.
namespace mindahl::cli::fit_terms_test {
namespace {

// Noise-free loops of 17 digits: the fit promises 1e-8; the terms here are correlated with σ and α
// by up to 0.99, which costs two digits.
constexpr double kNoiseFree = 1e-6;

struct Sample {
  double time = 0.0;
  double displacement = 0.0;
  double force = 0.0;
  double normal_load = 100.0;
};

class FitTerms : public CommandTest {
 protected:
  /// Cycles of 200 samples to 1.3 δc.
  static std::vector<Sample> Simulate(const std::string& cycles = "2") {
    std::vector<Sample> loop;
    for (const auto& row : testing::Numbers(
             Done("simulate" + kMindlinOptions + ("--lambda 1.3 --cycles " + cycles)).out)) {
      loop.push_back({row[0], row[1], row[2]});
    }
    return loop;
  }

  std::string FileOf(const std::vector<Sample>& loop, const std::string& name = "loop.csv") {
    std::string text = "time [s],displacement [m],force [N],normal [N]\n";
    for (const Sample& sample : loop) {
      text += fmt::format("{},{},{},{}\n", sample.time, sample.displacement, sample.force,
                          sample.normal_load);
    }
    return Write(name, text);
  }

  json Fit(const std::vector<Sample>& loop, const Words& options = {}) {
    return JsonOf(("fit " + FileOf(loop)) + options);
  }
};

// The rig, a spring in series, deflects by T/k.
TEST_F(FitTerms, KnownRigIsTakenOffTheDisplacement) {
  std::vector<Sample> loop = Simulate();
  for (Sample& sample : loop) sample.displacement += sample.force / 8e7;
  const json fit = Fit(loop, "--rig-stiffness 8e7");
  ExpectMindlin(fit, kNoiseFree);
  const json& rig = fit["parameters"]["rig_stiffness"];
  EXPECT_EQ(rig["value"], 8e7);
  EXPECT_EQ(rig["unit"], "N/m");
  EXPECT_EQ(rig["status"], "fixed");
}

TEST_F(FitTerms, FilesUnderSeveralLoadsAreOneContact) {
  constexpr double kExponent = 0.5;
  Words words = "fit --normal-load 50,100±1%,150";
  for (const double load : {50.0, 100.0, 150.0}) {
    const double ratio = load / 100;
    std::vector<Sample> loop = Simulate();
    // σ ∝ N^p and Tc ∝ N: the same loop over N along N^{1−p} the way.
    for (Sample& sample : loop) {
      sample.displacement *= std::pow(ratio, 1 - kExponent);
      sample.force *= ratio;
    }
    words.push_back(FileOf(loop, fmt::format("{}.csv", load)));
  }
  const json fit = JsonOf(words);
  ExpectMindlin(fit, kNoiseFree);
  EXPECT_NEAR(Value(fit, "load_exponent"), kExponent, kNoiseFree);
  const json& friction = fit["contact"]["friction_coefficient"];
  const double expected = kMindlin.slip_force / 100;
  EXPECT_NEAR(friction["value"].get<double>(), expected, kNoiseFree);
  // 1 N of one of three loads.
  constexpr double kNormalQuantile = 1.959963984540054;
  EXPECT_NEAR(std::log(friction["ci95"][1].get<double>() / expected), kNormalQuantile / 300,
              kNoiseFree);
}

TEST_F(FitTerms, SamplesOutsideTheLoadWindowDoNotCount) {
  std::vector<Sample> loop = Simulate();
  for (std::size_t i = 220; i < 260; ++i) {
    loop[i].normal_load = 50.0;
    loop[i].force *= 0.5;
  }
  const json fit = Fit(loop, "--select load=95:105");
  ExpectMindlin(fit, kNoiseFree);
  EXPECT_EQ(fit["input"]["left_out"][0]["samples"], 40);
  EXPECT_EQ(fit["input"]["samples"], loop.size());
  EXPECT_EQ(fit["contact"]["normal_load"]["value"], 100.0);
}

TEST_F(FitTerms, SamplesAndCyclesOutsideTheRangeDoNotCount) {
  std::vector<Sample> loop = Simulate("3");
  // Spoilt before the second cycle, which begins at three quarters, and from sample 500 on.
  for (std::size_t i = 0; i < 150; ++i) loop[i].force *= 0.8;
  for (std::size_t i = 499; i < loop.size(); ++i) loop[i].force *= 0.9;
  const json fit = Fit(loop, "--select cycles=2:4 --select samples=1:499");
  ExpectMindlin(fit, kNoiseFree);
  const json& left_out = fit["input"]["left_out"];
  EXPECT_EQ(left_out[0]["samples"], 150);
  EXPECT_EQ(left_out[1]["samples"], loop.size() - 499);
}

TEST_F(FitTerms, SlipForcesOfBothDirectionsAreFitted) {
  std::vector<Sample> loop = Simulate();
  testing::History displacement;
  for (const Sample& sample : loop) displacement.push_back(sample.displacement);
  const std::vector<double> force =
      testing::Respond(testing::Model("mindlin"), kMindlin, displacement, {.asymmetry = 0.2});
  for (std::size_t i = 0; i < loop.size(); ++i) loop[i].force = force[i];
  const json fit = Fit(loop, "--terms asymmetry");
  ExpectMindlin(fit, kNoiseFree);
  EXPECT_NEAR(Value(fit, "asymmetry"), 0.2, kNoiseFree);
  for (const auto& [name, share] :
       {std::pair("slip_force_positive", 1.2), {"slip_force_negative", 0.8}}) {
    EXPECT_NEAR(fit["contact"][name]["value"].get<double>() / (share * kMindlin.slip_force), 1,
                kNoiseFree);
  }
  EXPECT_FALSE(Fit(Simulate())["contact"].contains("slip_force_positive"));
  // From the second cycle on the contact has slipped, and only the zero of the force tells.
  const json known =
      Fit({loop.begin() + 200, loop.end()}, "--terms asymmetry --fix force_offset=0");
  EXPECT_EQ(known["initial_state"], "steady");
  EXPECT_NEAR(Value(known, "asymmetry"), 0.2, kNoiseFree);
}

TEST_F(FitTerms, ForceOfAColumnIsFittedOrTakenOff) {
  constexpr double kPerNewton = 0.3;
  std::vector<Sample> loop = Simulate();
  for (std::size_t i = 0; i < loop.size(); ++i) {
    loop[i].normal_load = 100 + 10 * std::sin(0.021 * static_cast<double>(i));
    loop[i].force += kPerNewton * loop[i].normal_load;
  }
  for (const auto& [option, name] : {std::pair("normal", "covariate_normal"),
                                     {"4=fit", "covariate_4"},
                                     {"normal=0.3", "covariate_normal"}}) {
    const json fit = Fit(loop, {"--covariate", option});
    ExpectMindlin(fit, kNoiseFree);
    EXPECT_NEAR(Value(fit, name), kPerNewton, kNoiseFree * kMindlin.slip_force) << option;
    EXPECT_EQ(fit["parameters"][name]["unit"], "N/N");
  }
}

// --noise-in displacement: loops whose force is imposed.

class NoiseInDisplacement : public CommandTest {
 protected:
  /// Three cycles under a force to 0.9 Tc.
  std::string Loop(double noise) {
    testing::History force = testing::Sine(3, 200);
    for (double& each : force) each *= 0.9 * kMindlin.slip_force;
    testing::History displacement =
        testing::DisplacementUnder(testing::Model("mindlin"), kMindlin, force);
    testing::Generator generator(5);
    if (noise > 0) displacement = testing::WithNoise(generator, std::move(displacement), noise);
    std::string rows = "displacement [m],force [N]\n";
    for (std::size_t i = 0; i < force.size(); ++i) {
      rows += fmt::format("{},{}\n", displacement[i], force[i]);
    }
    return "fit " + Write("loop.csv", rows) + " --noise-in displacement ";
  }
};

TEST_F(NoiseInDisplacement, RecoversTheContact) { ExpectMindlin(JsonOf(Loop(0.0)), 1e-8); }

TEST_F(NoiseInDisplacement, GivesResidualsInMetres) {
  constexpr double kNoise = 1e-8;  // [m], 0.9 % of X
  const Words fit = Loop(kNoise) + "--residuals " + Path("residuals.csv");
  // n squares tell a deviation to 1/√(2n) = 3 %; five of those.
  EXPECT_NEAR(JsonOf(fit)["residuals"]["rms"].get<double>() / kNoise, 1, 0.15);
  EXPECT_THAT(FileContent(Path("residuals.csv")),
              StartsWith("displacement [m],force [N],fitted_displacement [m],residual [m]\n"));
  EXPECT_THAT(Done(fit).out, HasSubstr(" nm rms, like noise"));
}

// One file under several constant loads.

constexpr double kFriction = 0.4;
constexpr double kAmplitude = 6e-7;  // slips grossly at 20 N, partly at 50 and 100 N
constexpr std::size_t kCycle = 100;  // samples
double Staircase(double cycle) { return cycle < 5 ? 20.0 : cycle < 10 ? 50.0 : 100.0; }

class LoadStepsOfFit : public CommandTest {
 protected:
  /// Fifteen cycles: the exact response of elements in parallel, so that the contact keeps what it
  /// has of each load.
  std::string Series() {
    testing::LoadedContact contact(
        {.friction_coefficient = kFriction, .reference_load = 50, .reference_stiffness = 4e7},
        Staircase(0));
    std::string rows = "displacement [m],force [N],normal load [N]\n";
    for (std::size_t i = 0; i <= 15 * kCycle; ++i) {
      const double cycle = static_cast<double>(i) / static_cast<double>(kCycle);
      const double displacement = kAmplitude * std::sin(2 * std::numbers::pi * cycle);
      rows += fmt::format("{},{},{}\n", displacement, contact.Move(displacement, Staircase(cycle)),
                          Staircase(cycle));
    }
    return Write("series.csv", rows);
  }
};

TEST_F(LoadStepsOfFit, AreFollowedInOneRecord) {
  const json fit = JsonOf("fit " + Series());
  EXPECT_NEAR(Value(fit, "alpha"), 1.0 / 3, kNoiseFree);
  EXPECT_NEAR(fit["contact"]["friction_coefficient"]["value"].get<double>(), kFriction, kNoiseFree);
  EXPECT_EQ(fit["input"]["files"].size(), 1U);
  EXPECT_FALSE(fit["parameters"].contains("load_exponent"));
}

}  // namespace
}  // namespace mindahl::cli::fit_terms_test
