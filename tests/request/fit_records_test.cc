// These tests concern the records that are refused before a fit, and the options taken from files.

#include "io/temporary_directory.h"
#include "mindahl/report/report.h"
#include "mindahl/request/fit_request.h"
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

TEST(NextStep, IsNoneWhereACauseWithoutATermSeemsToDescribeTheRecordAsWell) {
  const auto curved = [](double x) { return x + 0.02 * x * x / 2e-6; };
  const report::Report made = FitLoops({{2e7, 1.0 / 3, 60.0}}, {}, curved);
  ASSERT_NE(made.fit.adequacy.verdict, identification::AdequacyVerdict::kAdequate);
  EXPECT_TRUE(std::ranges::any_of(made.fit.adequacy.causes, [](const auto& cause) {
    return cause.code == "displacement_sensor" && cause.explains > 0.8;
  }));
  EXPECT_FALSE(made.next);
}

TEST(NextStep, IsAForceOfTheVelocityThatTheIntervalOfTcHasInIt) {
  Generator generator(4);
  io::RecordFile file =
      SineFile("mindlin-dahl", {4e7, 1.0 / 3, 40.0}, 4e-6, testing::Sine(3, 200), 0.1, generator);
  for (std::size_t i = 0; i < file.record.size(); ++i) {
    const double phase = 2 * std::numbers::pi * static_cast<double>(i) / 200;
    file.record.force[i] += 2 * std::cos(phase);
    file.record.time.push_back(0.005 * static_cast<double>(i));
  }
  const report::Report made = FitRecords({}, {file});
  EXPECT_GT(*made.fit.Find("slip_force")->lower95, 40.3) << "with the force of the velocity";
  ASSERT_TRUE(made.next);
  EXPECT_THAT(made.next->options,
              AnyOf(StartsWith("--terms viscous"), StartsWith("--terms speed_exponent")));
}

TEST(NextStep, IsAFitOfTheDisplacementThatACoarseEncoderReads) {
  constexpr double kAmplitude = 2.4e-6;  // 0.8 of gross slip
  Generator generator(4);
  io::RecordFile file = SineFile("mindlin-dahl", {4e7, 1.0 / 3, 80.0}, kAmplitude,
                                 testing::Sine(1.5, 400), 0.1, generator);
  constexpr double kStep = kAmplitude / 5;
  for (double& x : file.record.displacement) {
    x = kStep * std::round(x / kStep + 0.15 * testing::Normal(generator));  // one count flickers
  }
  const report::Report made = FitRecords({}, {file});
  ASSERT_TRUE(made.next);
  EXPECT_EQ(made.next->options, "--noise-in displacement --model mindlin-dahl");
  EXPECT_TRUE(made.next->is_over_amplitude);
  FitRequest followed;
  followed.fit.preparation.excitation = loop::Channel::kForce;
  const identification::FitResult fit = FitRecords(followed, {file}).fit;
  EXPECT_EQ(fit.adequacy.verdict, identification::AdequacyVerdict::kAdequate);
  EXPECT_DOUBLE_EQ(made.next->misfit_after, fit.adequacy.misfit / fit.MisfitScale());
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
