// These tests concern the records that are refused before a fit, and the options taken from files.

#include "io/temporary_directory.h"
#include "mindahl/report/report.h"
#include "mindahl/request/fit_request.h"
#include "recovery/recovered.h"
#include "support/histories.h"
#include "support/prelude.h"

namespace mindahl::request::fit_records_test {
namespace {

/// A loop in 2.5 cycles of 40 samples, in a file whose rows begin with the third line.
io::RecordFile LoopFile() {
  io::RecordFile file;
  for (const double sine : testing::Sine(2.5, 40)) {
    file.record.displacement.push_back(2e-6 * sine);
    file.lines.push_back(file.lines.size() + 3);
  }
  file.record.force = testing::Respond(testing::Model("mindlin-dahl"), {4e7, 1.0 / 3, 40.0},
                                       file.record.displacement);
  Generator generator(4);
  for (double& force : file.record.force) force += 0.1 * testing::Normal(generator);
  file.displacement.index = 2;
  file.force.index = 4;
  return file;
}

std::string RefusalOf(std::vector<io::RecordFile> files, const FitRequest& request = {}) {
  for (std::size_t k = 0; k < files.size(); ++k) {
    files[k].name = std::string(1, static_cast<char>('a' + k)) + ".csv";
  }
  return MessageOf<InputError>([&] { FitRecords(request, files); });
}

TEST(FitRecords, RefusesADisplacementAndAForceThatNeverChange) {
  io::RecordFile still = LoopFile();
  still.record.displacement.assign(101, 0.5);
  still.is_torsional = true;
  EXPECT_THAT(RefusalOf({still}),
              StartsWith("a.csv:3:2: the displacement never changes, it is 0.5 rad in every row"));
  still.is_torsional = false;
  EXPECT_THAT(RefusalOf({LoopFile(), still}), StartsWith("b.csv:3:2: the displacement never"));
  io::RecordFile slack = LoopFile();
  slack.record.force.assign(101, -7.0);
  EXPECT_THAT(RefusalOf({LoopFile(), slack}),
              StartsWith("b.csv:3:4: the force never changes, it is -7 N"));
}

/// A file of a contact that a sine moves, with noise of the force.
io::RecordFile SineFile(const char* model, const models::BranchLaw& law, double amplitude,
                        const testing::History& sine, double noise, Generator& generator) {
  io::RecordFile file;
  for (const double x : sine) {
    file.record.displacement.push_back(amplitude * x);
    file.lines.push_back(file.lines.size() + 2);
  }
  file.record.force = testing::Respond(testing::Model(model), law, file.record.displacement);
  for (double& force : file.record.force) force += noise * testing::Normal(generator);
  return file;
}

/// Sine cycles of a contact at which a force is added, in files a.csv, b.csv, …
report::Report FitLoops(const std::vector<models::BranchLaw>& laws, const FitRequest& request,
                        const std::function<double(double)>& distort = std::identity()) {
  std::vector<io::RecordFile> files;
  for (const models::BranchLaw& law : laws) {
    Generator generator(4);
    io::RecordFile& file = files.emplace_back(
        SineFile("mindlin-dahl", law, 2e-6, testing::Sine(3, 100), 0.1, generator));
    for (double& x : file.record.displacement) x = distort(x);
    file.name = std::string(1, static_cast<char>('a' + files.size() - 1)) + ".csv";
  }
  return FitRecords(request, std::move(files));
}

/// A loop of Dahl's own law has no asymmetry by its own law, and one of 0.7 by Masing's.
TEST(FitRecords, ChoosesTheLawWithoutAnAsymmetryBesideWhichLawsAreNotCompared) {
  Generator generator(4);
  const io::RecordFile file =
      SineFile("dahl", {4.8e7, 1.5, 15.0}, 6e-7, testing::Sine(4, 120), 0.04, generator);
  FitRequest request;
  request.fit.terms = {"asymmetry"};
  const identification::FitResult fit = FitRecords(request, {file}).fit;
  EXPECT_EQ(fit.model->name, "dahl");
  EXPECT_EQ(fit.adequacy.verdict, identification::AdequacyVerdict::kAdequate);
  EXPECT_NEAR(fit.Find("asymmetry")->value, 0.0, 0.01);
}

/// A sample of a sine of amplitude 1, and of a force over its largest magnitude.
struct Sample {
  double position;
  double velocity;  // 1 in the middle
  double time;      // in cycles
  double force;
};

/// A record that Mindlin's contact alone does not describe, and the step that is advised for it.
struct Advice {
  const char* reason;
  double amplitude;  // over gross slip
  double noise;      // over the largest force
  std::function<double(const Sample&)> force;
  const char* options;                                     // "" of no step
  std::function<double(const Sample&)> pressure = {};      // a column of its own
  std::function<bool(const Sample&)> is_missing = {};      // a row
  std::function<double(const Sample&)> read_wrongly = {};  // in place of the position
  std::uint64_t seed = 4;                                  // of the noise
};

io::RecordFile FileFor(const Advice& advice) {
  constexpr std::size_t kSamples = 120;
  Generator generator(advice.seed);
  const double amplitude = 1.5e-6 * advice.amplitude;
  const io::RecordFile contact = SineFile("mindlin-dahl", {4e7, 1.0 / 3, 40.0}, amplitude,
                                          testing::Sine(4, kSamples), 0.0, generator);
  const double largest = testing::Largest(contact.record.force);
  io::RecordFile file;
  loop::Record& record = file.record;
  if (advice.pressure) record.covariates = {{.name = "pressure", .unit = "bar", .values = {}}};
  for (std::size_t i = 0; i < contact.record.size(); ++i) {
    const double cycles = static_cast<double>(i) / kSamples;
    const Sample sample{contact.record.displacement[i] / amplitude,
                        std::cos(2 * std::numbers::pi * cycles), cycles,
                        contact.record.force[i] / largest};
    const double noise = advice.noise * testing::Normal(generator);
    if (advice.is_missing && advice.is_missing(sample)) continue;
    file.lines.push_back(i + 2);
    record.time.push_back(cycles);
    record.displacement.push_back(
        amplitude * (advice.read_wrongly ? advice.read_wrongly(sample) : sample.position));
    record.force.push_back(largest * (advice.force(sample) + noise));
    if (advice.pressure) record.covariates[0].values.push_back(advice.pressure(sample));
  }
  return file;
}

TEST(NextStep, IsTheFirstThatGainsAndLeavesTheSlipForceUnlessAnotherCauseExplainsMore) {
  const auto of_contact = [](const Sample& at) { return at.force; };
  const auto viscous = [](const Sample& at) { return at.force + 0.2 * at.velocity; };
  const auto drag = [](const Sample& at) {
    return at.force + 0.6 * at.velocity * std::abs(at.velocity);
  };
  const auto direction = [](const Sample& at) { return at.velocity < 0 ? -1.0 : 1.0; };
  const auto with_a_part = [&](double part) {
    return [=](const Sample& at) { return (1 - part) * at.force + part * direction(at); };
  };
  const Advice table[] = {
      {"a spring would take Tc out of its interval, and the cause is not clearly another", 1.0,
       0.003, drag, "--terms viscous"},
      {"with a viscous force Tc is known no more",
       0.4,
       0.04,
       viscous,
       "--terms lag",
       {},
       {},
       {},
       7},
      {"a column may take less than half of Tc", 2.5, 0.005, with_a_part(0.3),
       "--covariate pressure", direction},
      {"but not more", 1.0, 0.005, with_a_part(0.7), "--terms slip_position_quadratic", direction},
      {"the sensor of the displacement explains more than a term",
       5.0,
       0.003,
       of_contact,
       "",
       {},
       {},
       [](const Sample& at) { return at.position + 0.03 * at.position * at.position; }},
      {"the sensor of the displacement explains as much as a term that leaves but noise",
       4.0,
       0.04,
       [](const Sample& at) { return at.force + 0.1 * at.position * at.position; },
       "",
       {},
       {},
       {},
       3},
      {"rows are missing", 1.2, 0.003, viscous, "", {}, [](const Sample& at) {
         return at.time > 1.3 && at.time < 1.8;
       }}};
  for (const Advice& advice : table) {
    SCOPED_TRACE(advice.reason);
    const report::Report made = FitRecords({}, {FileFor(advice)});
    EXPECT_NE(made.fit.adequacy.verdict, identification::AdequacyVerdict::kAdequate);
    EXPECT_EQ(made.next ? made.next->options : "", advice.options);
  }
}

TEST(NextStep, IsNoneWhereTheForceIsAtItsLimitOrTheOtherLawFitsBetter) {
  io::RecordFile cut = FileFor({"", 2.5, 0.003, [](const Sample& at) { return at.force; }, ""});
  for (double& force : cut.record.force) force = std::min(force, 32.0);
  const report::Report at_limit = FitRecords({}, {cut});
  EXPECT_NE(at_limit.fit.FindFinding("force_at_limit"), nullptr);
  EXPECT_FALSE(at_limit.next);
  Generator generator(4);
  testing::History growing = testing::Sine(4, 120);
  for (std::size_t i = 0; i < growing.size(); ++i) growing[i] *= 0.5 + static_cast<double>(i) / 960;
  const io::RecordFile file = SineFile("dahl", {4e7, 1.0, 40.0}, 1.2e-6, growing, 0.1, generator);
  FitRequest request;
  request.fit.model = &testing::Model("mindlin-dahl");
  const report::Report of_other = FitRecords(request, {file});
  EXPECT_NE(of_other.fit.FindFinding("other_law", "better"), nullptr);
  EXPECT_FALSE(of_other.next);
}

TEST(Law, IsMasingsAndNotPreferredWhereEachFitsBetterThanTheSolutionOfTheOther) {
  // A cycle and a half of Dahl's own law from a middle of a growing sine, with a viscous force.
  Generator generator(4);
  testing::History growing = testing::Sine(3.5, 40);
  for (std::size_t i = 0; i <= 140; ++i) growing[i] *= 0.5 + static_cast<double>(i) / 280;
  io::RecordFile file = SineFile("dahl", {4e7, 0.6, 40.0}, 1.35e-6, growing, 0.0, generator);
  io::KeepSamples(file, 75, 136);
  std::vector<double>& force = file.record.force;
  const double largest = testing::Largest(force);
  for (std::size_t i = 0; i < force.size(); ++i) {
    force[i] += 0.05 * largest * std::cos(2 * std::numbers::pi * static_cast<double>(i + 75) / 40);
  }
  const identification::FitResult fit = FitRecords({}, {file}).fit;
  EXPECT_EQ(fit.model->name, "mindlin-dahl");
  ASSERT_TRUE(fit.law_choice);
  EXPECT_FALSE(fit.law_choice->decided());
  EXPECT_EQ(fit.law_choice->preferred, nullptr);
  EXPECT_EQ(fit.FindFinding("other_law", "better"), nullptr);
}

/// Cycles of a contact from rest with a force of the velocity [N], the largest of which is given.
io::RecordFile ViscousFile(const char* model, double alpha, double amplitude, double viscous) {
  Generator generator(4);
  io::RecordFile file =
      SineFile(model, {4e7, alpha, 40.0}, amplitude, testing::Sine(3, 200), 0.1, generator);
  for (std::size_t i = 0; i < file.record.size(); ++i) {
    const double phase = 2 * std::numbers::pi * static_cast<double>(i) / 200;
    file.record.force[i] += viscous * std::cos(phase);
    file.record.time.push_back(0.005 * static_cast<double>(i));
  }
  return file;
}

TEST(NextStep, IsAForceOfTheVelocityThatTheIntervalOfTcHasInIt) {
  const io::RecordFile file = ViscousFile("mindlin-dahl", 1.0 / 3, 4e-6, 2.0);
  const report::Report made = FitRecords({}, {file});
  EXPECT_GT(*made.fit.Find("slip_force")->lower95, 40.3) << "with the force of the velocity";
  ASSERT_TRUE(made.next);
  EXPECT_THAT(made.next->options,
              AnyOf(StartsWith("--terms viscous"), StartsWith("--terms speed_exponent")));
}

TEST(Law, IsDahlsOfARecordThatBeginsUnderAForceOfATerm) {
  FitRequest request;
  request.terms = {"viscous"};
  const identification::FitResult fit =
      FitRecords(request, {ViscousFile("dahl", 1.0, 6e-6, 6.0)}).fit;
  EXPECT_EQ(fit.model->name, "dahl");
  EXPECT_EQ(fit.adequacy.verdict, identification::AdequacyVerdict::kAdequate);
  EXPECT_TRUE(testing::Covers(*fit.Find("sigma"), 4e7));
}

TEST(Law, IsDahlsWhereItDescribesTheRecordWithTermsThatAreChosen) {
  FitRequest request;
  request.chooses_terms = true;
  const report::Report made = FitRecords(request, {ViscousFile("dahl", 1.0, 6e-6, 6.0)});
  EXPECT_EQ(made.fit.model->name, "dahl");
  ASSERT_TRUE(made.terms);
  EXPECT_THAT(made.terms->added, ElementsAre("viscous"));
  EXPECT_EQ(made.fit.adequacy.verdict, identification::AdequacyVerdict::kAdequate);
  EXPECT_TRUE(testing::Covers(*made.fit.Find("sigma"), 4e7));
}

TEST(Law, IsDahlsWhereMasingsRequiresMoreTerms) {
  Generator generator(4);
  io::RecordFile file =
      SineFile("dahl", {4e7, 1.0, 40.0}, 25e-6, testing::Sine(3, 800), 0.27, generator);
  for (std::size_t i = 0; i < file.record.size(); ++i) {
    file.record.force[i] += 1e5 * file.record.displacement[i];
    file.record.time.push_back(0.005 * static_cast<double>(i));
  }
  FitRequest request;
  request.chooses_terms = true;
  const report::Report made = FitRecords(request, {file});
  EXPECT_EQ(made.fit.model->name, "dahl");
  EXPECT_THAT(made.terms->added, ElementsAre("plateau_slope"));
  request.fit.model = models::FindFrictionModel("mindlin-dahl");
  EXPECT_GT(FitRecords(request, {file}).terms->added.size(), 1U);
}

TEST(NextStep, MayDecideTheLaw) {
  const report::Report made = FitRecords({}, {ViscousFile("dahl", 1.0, 6e-6, 6.0)});
  EXPECT_EQ(made.fit.model->name, "mindlin-dahl");
  ASSERT_TRUE(made.next);
  EXPECT_EQ(made.next->options, "--terms viscous");
  FitRequest followed;
  followed.terms = {"viscous"};
  const identification::FitResult fit =
      FitRecords(followed, {ViscousFile("dahl", 1.0, 6e-6, 6.0)}).fit;
  EXPECT_DOUBLE_EQ(made.next->misfit_after, *fit.adequacy.misfit_over_half_gap);
}

TEST(NextStep, IsNoneBesideAValueThatTheRecordContradictsOrWithoutALoop) {
  Generator generator(4);
  const io::RecordFile file =
      SineFile("mindlin-dahl", {4e7, 1.0 / 3, 40.0}, 4e-6, testing::Sine(3, 200), 0.1, generator);
  FitRequest request;
  request.fit.fixed["alpha"] = 0.4;
  const report::Report held = FitRecords(request, {file});
  ASSERT_NE(held.fit.FindFinding("prior_contradicted", "held"), nullptr);
  EXPECT_FALSE(held.next);
  io::RecordFile unmoved = file;
  for (double& force : unmoved.record.force) force = testing::Normal(generator);
  const report::Report made = FitRecords({}, {unmoved});
  ASSERT_NE(made.fit.FindFinding("model_inadequate", "no_loop"), nullptr);
  EXPECT_FALSE(made.next);
}

TEST(NextStep, GoesOnFromTermsThatAreNamed) {
  const io::RecordFile file = ViscousFile("mindlin-dahl", 1.0 / 3, 4e-6, 2.0);
  FitRequest request;
  request.terms = {"lag"};
  const report::Report made = FitRecords(request, {file});
  ASSERT_TRUE(made.next);
  EXPECT_THAT(made.next->options, StartsWith("--terms viscous"));
  request.terms.emplace_back("viscous");
  const identification::FitResult followed = FitRecords(request, {file}).fit;
  EXPECT_DOUBLE_EQ(made.next->misfit_after, *followed.adequacy.misfit_over_half_gap);
}

TEST(NextStep, LiesWithinTheIntervals) {
  // A rig as stiff as twice the contact changes its shape by more than a step to first order says.
  constexpr models::BranchLaw kContact{4e7, 0.7, 40.0};
  Generator generator(4);
  io::RecordFile file =
      SineFile("mindlin-dahl", kContact, 5e-6, testing::Sine(5, 200), 0.0, generator);
  for (std::size_t i = 0; i < file.record.size(); ++i) {
    file.record.displacement[i] += file.record.force[i] / 8e7;
    file.record.force[i] += 0.2 * testing::Normal(generator);
  }
  const report::Report made = FitRecords({}, {file});
  ASSERT_TRUE(made.next);
  EXPECT_THAT(made.next->options, StartsWith("--rig-stiffness fit"));
  EXPECT_TRUE(testing::Covers(*made.fit.Find("sigma"), kContact.tangential_stiffness));
  EXPECT_TRUE(testing::Covers(*made.fit.Find("alpha"), kContact.shape_exponent));
}

/// A loop of 0.8 of gross slip as an encoder of five steps in the amplitude reads it.
io::RecordFile EncoderFile() {
  constexpr double kAmplitude = 2.4e-6;
  Generator generator(4);
  io::RecordFile file = SineFile("mindlin-dahl", {4e7, 1.0 / 3, 80.0}, kAmplitude,
                                 testing::Sine(1.5, 400), 0.1, generator);
  constexpr double kStep = kAmplitude / 5;
  for (double& x : file.record.displacement) {
    x = kStep * std::round(x / kStep + 0.15 * testing::Normal(generator));  // one count flickers
  }
  return file;
}

TEST(NextStep, IsAFitOfTheDisplacementThatACoarseEncoderReads) {
  const io::RecordFile file = EncoderFile();
  const report::Report made = FitRecords({}, {file});
  ASSERT_TRUE(made.next);
  EXPECT_EQ(made.next->options, "--noise-in displacement");
  EXPECT_TRUE(made.next->is_over_amplitude);
  FitRequest followed;
  followed.fit.preparation.excitation = loop::Channel::kForce;
  const identification::FitResult fit = FitRecords(followed, {file}).fit;
  EXPECT_EQ(fit.adequacy.verdict, identification::AdequacyVerdict::kAdequate);
  EXPECT_DOUBLE_EQ(made.next->misfit_after, fit.adequacy.misfit / fit.MisfitScale());
}

TEST(NextStep, IsNoFitOfTheDisplacementOfARecordThatIsCut) {
  io::RecordFile rests = EncoderFile();
  rests.record.displacement.insert(rests.record.displacement.begin(), 300, 0.0);
  rests.record.force.insert(rests.record.force.begin(), 300, 0.0);
  rests.lines.resize(rests.record.size());
  FitRequest request;
  request.trim = true;
  const report::Report made = FitRecords(request, {rests});
  EXPECT_THAT(made.left_out, SizeIs(1));
  EXPECT_FALSE(made.next);
}

TEST(NextStep, IsNoFitOfTheDisplacementThatLeavesMoreThanSteps) {
  // Under cycles of one amplitude Masing's law is fitted to Dahl's, but for the first loading.
  for (const double amplitude : {0.9e-6, 1.5e-6}) {
    Generator generator(4);
    io::RecordFile file =
        SineFile("dahl", {4e7, 1.0, 40.0}, amplitude, testing::Sine(4, 120), 0.25, generator);
    file.record.displacement = testing::Quantised(file.record.displacement, amplitude / 14);
    const report::Report made = FitRecords({}, {file});
    EXPECT_NE(made.fit.adequacy.verdict, identification::AdequacyVerdict::kAdequate);
    EXPECT_FALSE(made.next) << amplitude;
  }
}

TEST(NextStep, IsNoneOfAnEncoderOfFewStepsWhereTheLoopSlides) {
  // The force says nothing of the displacement there, and no term describes steps.
  constexpr double kAmplitude = 1.5e-6;
  Generator generator(4);
  io::RecordFile file = SineFile("mindlin-dahl", {4.8e7, 1.0 / 3, 15.0}, kAmplitude,
                                 testing::Sine(4, 120), 0.04, generator);
  file.record.displacement = testing::Quantised(file.record.displacement, kAmplitude / 3.5);
  const report::Report made = FitRecords({}, {file});
  EXPECT_NE(made.fit.adequacy.verdict, identification::AdequacyVerdict::kAdequate);
  EXPECT_FALSE(made.next);
}

TEST(FitRecords, SaysWhereSlipForcesAreNotInProportionToTheLoads) {
  FitRequest request;
  request.contact.normal_loads = {{50, 0}, {100, 0}, {200, 0}};
  // The amplitude is twice and more of their gross-slip displacements.
  const std::vector<models::BranchLaw> laws = {
      {3e7, 1.0 / 3, 10.0}, {3.8e7, 1.0 / 3, 16.5}, {4.8e7, 1.0 / 3, 27.5}};
  const report::Report made = FitLoops(laws, request);
  const identification::Finding* found = made.fit.FindFinding("load_varies", "not_proportional");
  ASSERT_NE(found, nullptr);
  EXPECT_NEAR(*found->Number("least"), 0.1375, 0.003);
  EXPECT_NEAR(*found->Number("most"), 0.2, 0.004);
  EXPECT_FALSE(made.next);
  EXPECT_THAT(made.fit.adequacy.causes, IsEmpty());
}

TEST(FitRecords, SaysNothingOfProportionWhereALoopDoesNotSlideOrTheLoadsAreWithinAFewPercent) {
  FitRequest request;
  request.contact.normal_loads = {{50, 0}, {100, 0}, {200, 0}};
  const auto curved = [](double x) { return x + 0.02 * x * x / 2e-6; };
  for (const auto& [least, middle, most] : {std::tuple(10.0, 16.5, 90.0), {5.0, 10.2, 20.0}}) {
    const report::Report made = FitLoops(
        {{3e7, 1.0 / 3, least}, {3.8e7, 1.0 / 3, middle}, {4.8e7, 1.0 / 3, most}}, request, curved);
    EXPECT_NE(made.fit.adequacy.verdict, identification::AdequacyVerdict::kAdequate);
    EXPECT_EQ(made.fit.FindFinding("load_varies", "not_proportional"), nullptr) << middle;
  }
}

TEST(FitRecords, RefusesAForceBesideATorque) {
  io::RecordFile torque = LoopFile();
  torque.is_torsional = true;
  EXPECT_EQ(RefusalOf({torque, LoopFile()}),
            "of a.csv and b.csv one holds a force, one a torque: fit them apart");
}

TEST(FitRecords, RefusesLoadsThatAreNeitherOneNorOneAFile) {
  FitRequest request;
  request.contact.normal_loads = {{50.0, 0.0}, {60.0, 0.0}};
  EXPECT_THAT(RefusalOf({LoopFile()}, request), StartsWith("--normal-load: 2 loads for 1 record:"));
  EXPECT_THAT(RefusalOf({LoopFile(), LoopFile(), LoopFile()}, request),
              StartsWith("--normal-load: 2 loads for 3 records:"));
}

TEST(FitRecords, TakesTheMeanOfTheLoadsInTheWindowForTheContact) {
  io::RecordFile file = LoopFile();
  for (std::size_t i = 0; i <= 100; ++i) {
    file.record.normal_load.push_back(i == 7 ? 300.0 : i == 50 ? 1.0 : i % 2 == 0 ? 79.9 : 80.3);
  }
  FitRequest request;
  request.fit.preparation.load_window = {70, 90};
  const report::Report report = FitRecords(request, {file});
  // 50 even samples of 79.9 and 49 odd ones of 80.3 are within it.
  const double mean = (50 * 79.9 + 49 * 80.3) / 99;
  ASSERT_TRUE(report.known.normal_load);
  EXPECT_NEAR(report.known.normal_load->value, mean, 1e-9);
}

// ---
// --trim on: a fit of a record without what is no part of its test, and what is said of it.

using loop::Record;
using models::InitialState;

constexpr std::size_t kCycle = 100;                    // samples
constexpr models::BranchLaw kLaw{4e7, 1.0 / 3, 40.0};  // δc = 1.5 µm
constexpr double kReach = 2e-6;                        // [m]
constexpr double kNoise = 0.2;                         // [N]

Record Cycles(double cycles, Generator& generator) {
  Record record;
  record.displacement = testing::Sine(cycles, kCycle);
  for (double& displacement : record.displacement) displacement *= kReach;
  record.force = testing::Respond(testing::Model("mindlin-dahl"), kLaw, record.displacement);
  for (double& force : record.force) force += kNoise * testing::Normal(generator);
  return record;
}

/// Under a load [N] that ramps up over three cycles, and its force with it.
Record UnderARampingLoad(double cycles, Generator& generator) {
  Record record = Cycles(cycles, generator);
  for (std::size_t i = 0; i < record.size(); ++i) {
    const double cycle = static_cast<double>(i) / static_cast<double>(kCycle);
    const double share = std::min(1.0, 0.4 + 0.2 * cycle);
    record.normal_load.push_back(100 * share);
    record.force[i] *= share;  // no contact's law: what --trim is to keep away from the fit
  }
  return record;
}

/// Fits the record as the program does.
report::Report ReportOf(const Record& record) {
  FitRequest request;
  io::RecordFile file;
  file.record = record;
  file.displacement.unit = "m";
  file.force.unit = "N";
  request.trim = true;
  return FitRecords(request, {file});
}

TEST(TrimmedFit, IsUnderTheLoadThatARampEndsWith) {
  Generator generator(8);
  const Record record = UnderARampingLoad(20, generator);
  const report::Report report = ReportOf(record);
  EXPECT_EQ(report.fit.normal_load, 100.0);
  EXPECT_EQ(report.fit.FindFinding("load_varies", "followed"), nullptr);
  EXPECT_NEAR(report.fit.law.slip_force / kLaw.slip_force, 1, 0.005);
  // The ramp ends after three cycles, a turn is a quarter past each half, and the second counts.
  EXPECT_EQ(report.records.front().record.size(), record.size() - (3 * kCycle + 3 * kCycle / 4));
}

TEST(TrimmedFit, TakesContactsAsSteadyIfAllWereCycledBefore) {
  Generator generator(8);
  io::RecordFile ramped;
  ramped.record = UnderARampingLoad(12, generator);
  io::RecordFile whole;
  whole.record = Cycles(9, generator);
  whole.record.normal_load.assign(whole.record.size(), 100.0);
  FitRequest request;
  request.trim = true;
  EXPECT_EQ(FitRecords(request, {ramped}).options.initial_state, InitialState::kSteady);
  EXPECT_EQ(FitRecords(request, {whole, ramped}).options.initial_state, std::nullopt);
  request.fit.initial_state = InitialState::kVirgin;
  EXPECT_EQ(FitRecords(request, {ramped}).options.initial_state, InitialState::kVirgin);
}

TEST(TrimmedFit, HasSignGapAndScaleOfTheTestAndNamesTheRowsOfATravel) {
  Generator generator(9);
  Record record = Cycles(6, generator);
  // An approach of 100 mm under a force of the other sign, and the same way back.
  for (std::size_t i = 0; i < 150; ++i) {
    const double far = -0.1 * (1 - static_cast<double>(i) / 150);
    record.displacement.insert(record.displacement.begin() + static_cast<std::ptrdiff_t>(i), far);
    record.force.insert(record.force.begin() + static_cast<std::ptrdiff_t>(i), -60.0);
    record.displacement.push_back(-0.1 * static_cast<double>(i) / 150);
    record.force.push_back(60.0);
  }
  const report::Report report = ReportOf(record);
  EXPECT_EQ(report.fit.force_sense, 1);
  EXPECT_NEAR(report.fit.records[0].facts.amplitude / kReach, 1, 0.001);
  EXPECT_NEAR(report.fit.law.slip_force / kLaw.slip_force, 1, 0.01);
  EXPECT_NEAR(report.fit.law.tangential_stiffness / kLaw.tangential_stiffness, 1, 0.02);
  ASSERT_EQ(report.left_out.size(), 2U);
  EXPECT_EQ(report.left_out[0].why, "travel");
  EXPECT_EQ(report.left_out[0].first, 1U);
  EXPECT_GE(report.left_out[0].last, 150U);
  EXPECT_EQ(report.left_out[1].last, record.size());
}

}  // namespace
}  // namespace mindahl::request::fit_records_test
