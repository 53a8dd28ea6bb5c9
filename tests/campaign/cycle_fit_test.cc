#include "mindahl/campaign/cycle_fit.h"

#include "campaign/test_record.h"
#include "mindahl/campaign/cycle_splitter.h"
#include "support/prelude.h"

namespace mindahl::campaign::cycle_fit_test {
namespace {

std::vector<Cycle> CyclesOf(const loop::Record& record) {
  CycleSplitter splitter(0.0);
  std::vector<Cycle> cycles;
  splitter.Add(record, LinesOf(record), cycles);
  return cycles;
}

/// One of noise, which is that of the tests unless it is given.
Cycle FirstCycle(double noise = testing::kCycleNoise) {
  return CyclesOf(TestRecord(2, 1, noise)).front();
}

bool HasFlag(const CycleFit& fit, const std::string& flag) {
  return std::ranges::find(fit.flags, flag) != fit.flags.end();
}

TEST(CycleFitter, FindsTheTruthOfACleanCycle) {
  constexpr double kExact = 1e-8;
  CycleFitter fitter({});
  for (const Cycle& cycle : CyclesOf(TestRecord(4, 1, 0.0))) {
    const CycleFit fit = fitter.Fit(cycle);
    EXPECT_EQ(fit.number, cycle.number);
    EXPECT_EQ(fit.first_line, cycle.first_line);
    EXPECT_EQ(fit.samples, cycle.record.size());
    EXPECT_EQ(fit["start_time"], cycle.record.time.front());
    EXPECT_TRUE(fit.flags.empty()) << fit.flags.front();
    EXPECT_NEAR(*fit["sigma"], kCycleLaw.tangential_stiffness,
                kExact * kCycleLaw.tangential_stiffness);
    EXPECT_NEAR(*fit["alpha"], kCycleLaw.shape_exponent, kExact);
    EXPECT_NEAR(*fit["slip_force"], kCycleLaw.slip_force, kExact * kCycleLaw.slip_force);
    EXPECT_NEAR(*fit["amplitude"], kCycleReach, kExact * kCycleReach);
    EXPECT_FALSE(fit["normal_load"]);
    EXPECT_FALSE(fit["friction_coefficient"]);
  }
}

TEST(CycleFitter, KnowsThatACycleBeginsAtATurn) {
  // Cycles of two amplitudes in turn: every other one begins within the range of its samples.
  const models::BranchLaw law = testing::kCycleLaw;
  loop::Record record;
  for (int i = 0; i < 600; ++i) {
    const double reach = i / 100 % 2 == 0 ? 5.5e-6 : 6.5e-6;
    record.displacement.push_back(reach * std::sin(2 * std::numbers::pi * i / 100));
  }
  record.force = Respond(Model("mindlin-dahl"), law, record.displacement);
  const std::vector<Cycle> cycles = CyclesOf(record);
  ASSERT_GE(cycles.size(), 4U);
  for (const Cycle& cycle : cycles) {
    const CycleFit fit = CycleFitter({}).Fit(cycle);
    EXPECT_NEAR(*fit["sigma"], law.tangential_stiffness, 1e-3 * law.tangential_stiffness);
    EXPECT_NEAR(*fit["alpha"], law.shape_exponent, 1e-3);
  }
}

TEST(CycleFitter, HasTheEnergyOfAllCyclesFittedTogetherWhateverTheirAmplitudes) {
  loop::Record record;
  for (int i = 0; i < 800; ++i) {
    const double reach = i / 100 % 2 == 0 ? 2.5e-6 : 5e-6;
    record.displacement.push_back(reach * std::sin(2 * std::numbers::pi * i / 100));
  }
  record.force = Respond(Model("mindlin-dahl"), kCycleLaw, record.displacement);
  for (const std::size_t first : {0U, 100U}) {  // the narrower before the wider, and after it
    CycleSplitter splitter(0.0, 2);
    std::vector<Cycle> pairs;
    loop::Record rest;
    for (const auto column : {&loop::Record::displacement, &loop::Record::force}) {
      (rest.*column).assign((record.*column).begin() + first, (record.*column).end());
    }
    splitter.Add(rest, LinesOf(rest), pairs);
    ASSERT_GE(pairs.size(), 2U);
    for (const Cycle& pair : pairs) {
      const CycleFit fit = CycleFitter({}).Fit(pair);
      const std::vector<double>& x = pair.record.displacement;
      const std::vector<double>& force = pair.record.force;
      double energy = 0.0;
      for (std::size_t i = 1; i < x.size(); ++i) {
        energy += (force[i] + force[i - 1]) / 2 * (x[i] - x[i - 1]);
      }
      EXPECT_NEAR(*fit["energy"], energy / 2, 1e-3 * energy) << first;
      EXPECT_FALSE(HasFlag(fit, "not_closed")) << first;
    }
  }
}

TEST(CycleFitter, HasNoFrictionCoefficientUnderALoadOfTheOtherSign) {
  Cycle cycle = FirstCycle(0.0);
  cycle.record.normal_load.assign(cycle.record.size(), -50.0);
  const CycleFit fit = CycleFitter({}).Fit(cycle);
  EXPECT_EQ(fit["normal_load"], -50.0);
  EXPECT_TRUE(fit["slip_force"]);
  EXPECT_FALSE(fit["friction_coefficient"]);
}

TEST(CycleFitter, HasTheMinimumAndTheErrorsOfAFitAlone) {
  constexpr double kSolverTolerance = 1e-2;  // standard errors, as of Fitter::Continue()
  const identification::FitOptions options{.initial_state = models::InitialState::kSteady,
                                           .preparation = {.begins_at_turn = true}};
  CycleFitter fitter(options);
  for (const Cycle& cycle : CyclesOf(TestRecord(60))) {
    const CycleFit fit = fitter.Fit(cycle);
    const identification::FitResult alone =
        identification::Fit({&cycle.record, 1}, options, identification::Depth::kErrors);
    for (const std::string name : {"sigma", "alpha", "slip_force", "force_offset"}) {
      const identification::ParameterEstimate& expected = *alone.Find(name);
      const double error = *expected.standard_error;
      EXPECT_NEAR(*fit[name], expected.value, kSolverTolerance * error) << name;
      EXPECT_NEAR(*fit[name + "_error"], error, kSolverTolerance * error) << name;
    }
    // Steady to the last sample, the cycle is closed for whoever sees it alone.
    EXPECT_EQ(*fit["energy"], alone.records.front().facts.energy_per_cycle);
    EXPECT_EQ(fit["half_gap"], alone.records.front().facts.half_gap);
  }
}

TEST(CycleFitter, HasErrorsThatTellTheScatter) {
  constexpr int kCycles = 400;
  CycleFitter fitter({});
  double sum = 0.0;
  double squares = 0.0;
  double variance = 0.0;
  int count = 0;
  for (const Cycle& cycle : CyclesOf(TestRecord(kCycles + 1))) {
    const CycleFit fit = fitter.Fit(cycle);
    sum += *fit["slip_force"];
    squares += *fit["slip_force"] * *fit["slip_force"];
    variance += *fit["slip_force_error"] * *fit["slip_force_error"];
    ++count;
  }
  ASSERT_EQ(count, kCycles);
  const double mean = sum / count;
  const double scatter = std::sqrt(squares / count - mean * mean);
  // The scatter of 400 is known to 1/√800 = 3.5 %, three times that.
  EXPECT_NEAR(scatter / std::sqrt(variance / count), 1.0, 0.106);
  EXPECT_NEAR(mean, kCycleLaw.slip_force, 4 * scatter / std::sqrt(count));
}

TEST(CycleFitter, ReportsFrictionCoefficientIfLoadIsKnown) {
  constexpr double kLoad = 120.0;
  const CycleFit given = CycleFitter({.normal_loads = {kLoad}}).Fit(FirstCycle());
  EXPECT_EQ(*given["normal_load"], kLoad);
  EXPECT_EQ(*given["friction_coefficient"], *given["slip_force"] / kLoad);
  EXPECT_EQ(*given["energy_friction_coefficient"],
            *given["energy"] / (4 * kLoad * *given["sliding_amplitude"]));
}

/// Cycles to a share of the reach.
std::vector<Cycle> Partial(double share, std::size_t cycles, double noise, std::uint64_t seed = 7) {
  loop::Record record = TestRecord(cycles, 1, 0.0);
  for (double& x : record.displacement) x *= share;
  record.force = testing::Respond(testing::Model("mindlin-dahl"), kCycleLaw, record.displacement);
  testing::Generator generator(seed);
  for (double& force : record.force) force += noise * testing::Normal(generator);
  return CyclesOf(record);
}

TEST(CycleFitter, SaysWhatACycleLeavesOpen) {
  const CycleFit fit = CycleFitter({.normal_loads = {80.0}}).Fit(Partial(0.1, 2, 0.05).front());
  EXPECT_TRUE(HasFlag(fit, "slip_force_open"));
  EXPECT_EQ(fit["normal_load"], 80.0);
  EXPECT_FALSE(fit["friction_coefficient"]);
}

// Far from slip the parabola of the likelihood is wrong about Tc, and one loop in sixty has a
// minimum at α = 0 and the force that it reached: no cycle may pass for one that knows Tc.
TEST(CycleFitter, KnowsNoSlipForceFarFromSlip) {
  CycleFitter fitter({});
  for (const std::uint64_t seed : {4, 5, 7, 8}) {
    for (const Cycle& cycle : Partial(0.12, 40, testing::kCycleNoise, seed)) {
      const CycleFit fit = fitter.Fit(cycle);
      EXPECT_TRUE(HasFlag(fit, "slip_force_open"))
          << "seed " << seed << ", cycle " << cycle.number << ": " << *fit["slip_force"];
    }
  }
}

TEST(CycleFitter, FlagsWhatIsWrongWithACycle) {
  const std::vector<std::pair<std::string, std::function<void(loop::Record&)>>> wrongs = {
      {"not_closed",
       [](loop::Record& record) {
         const std::size_t half = record.size() / 2;
         for (std::size_t i = half; i < record.size(); ++i) {
           record.displacement[i] += 0.1 * (record.displacement[half] - record.displacement[i]);
         }
       }},
      {"glitches", [](loop::Record& record) { record.force[40] = 1e4; }},
      {"rows_missing",
       [](loop::Record& record) {
         const auto third = static_cast<std::ptrdiff_t>(record.size() / 3);
         record.time.clear();
         for (std::size_t i = 0; i < record.size(); ++i) {
           record.time.push_back(static_cast<double>(i));
         }
         for (auto* column : {&record.displacement, &record.force, &record.time}) {
           column->erase(column->begin() + third / 2, column->begin() + 3 * third / 2);
         }
       }},
      {"no_loop", [](loop::Record& record) {
         for (std::size_t i = 0; i < record.size(); ++i) {
           record.force[i] = 1e7 * record.displacement[i];
         }
       }}};
  for (const auto& [flag, change] : wrongs) {
    Cycle cycle = FirstCycle();
    EXPECT_FALSE(HasFlag(CycleFitter({}).Fit(cycle), flag));
    change(cycle.record);
    EXPECT_TRUE(HasFlag(CycleFitter({}).Fit(cycle), flag)) << flag;
  }
}

// Two cycles share the sample at which they turn, which lies between neighbours in the record.
TEST(CycleFitter, LeavesOutAGlitchAtEitherEnd) {
  const Cycle clean = FirstCycle();
  const CycleFit expected = CycleFitter({}).Fit(clean);
  const std::size_t last = clean.record.size() - 1;
  for (const std::size_t place : {std::size_t{0}, std::size_t{1}, last - 1, last}) {
    for (const double off : {-40.0, 40.0}) {
      Cycle cycle = clean;
      cycle.record.force[place] += off;
      const CycleFit fit = CycleFitter({}).Fit(cycle);
      EXPECT_THAT(fit.flags, ElementsAre("glitches")) << place;
      EXPECT_NEAR(*fit["slip_force"], *expected["slip_force"], *expected["slip_force_error"]);
      EXPECT_NEAR(*fit["sigma"], *expected["sigma"], *expected["sigma_error"]);
      EXPECT_NEAR(*fit["half_gap"], *expected["half_gap"], 0.01 * *expected["half_gap"]);
    }
  }
}

TEST(RequireFit, RefusesOptionsThatNoCycleCanBeFittedWith) {
  loop::Record head = TestRecord(4);
  EXPECT_NO_THROW(RequireFit(head, {}));
  EXPECT_THROW(RequireFit(head, {.fixed = {{"sigma", -1.0}}}), InvalidArgument);
  EXPECT_THROW(RequireFit(head, {.start = {{"stiffness", 1.0}}}), InvalidArgument);
  std::ranges::fill(head.force, 0.0);  // the contact is closed later
  EXPECT_NO_THROW(RequireFit(head, {}));
}

TEST(CycleFitter, GoesOnAfterACycleThatCannotBeFitted) {
  CycleFitter fitter({});
  std::vector<Cycle> cycles = CyclesOf(TestRecord(4));
  const CycleFit before = fitter.Fit(cycles[0]);
  Cycle still = cycles[1];
  std::ranges::fill(still.record.displacement, 0.0);
  EXPECT_TRUE(HasFlag(fitter.Fit(still), "not_converged"));
  const CycleFit after = fitter.Fit(cycles[2]);
  EXPECT_TRUE(after.flags.empty());
  EXPECT_NEAR(*after["slip_force"], *before["slip_force"], 6 * *before["slip_force_error"]);
}

TEST(CycleFitter, FitsCyclesTogetherWithSmallerErrors) {
  const loop::Record record = TestRecord(10);
  CycleSplitter splitter(0.0, 9);
  std::vector<Cycle> nine;
  splitter.Add(record, LinesOf(record), nine);
  ASSERT_EQ(nine.size(), 1U);
  const CycleFit together = CycleFitter({}).Fit(nine.front());
  const CycleFit one = CycleFitter({}).Fit(CyclesOf(record).front());
  // √9; autocorrelation is estimated from 120 residuals, to 1/√120, and counts twice.
  EXPECT_NEAR(*one["slip_force_error"] / *together["slip_force_error"], 3.0, 0.8);
}

TEST(CycleFitter, NamesEachFlagOnce) {
  for (const CycleFlag& flag : kCycleFlags) {
    EXPECT_EQ(std::ranges::count(kCycleFlags, flag.name, &CycleFlag::name), 1) << flag.name;
    EXPECT_FALSE(flag.meaning.empty());
  }
}

TEST(CycleFitter, HasEveryFactOfItsCycle) {
  Cycle cycle = FirstCycle();
  for (std::size_t i = 0; i < cycle.record.size(); ++i) {
    cycle.record.normal_load.push_back(i % 2 == 0 ? 119.5 : 120.5);
  }
  cycle.number = 9;
  const CycleFit fit = CycleFitter({}).Fit(cycle);
  // Measured by hand: half the range, the extreme forces, ∮T dδ by trapezia.
  const std::vector<double>& x = cycle.record.displacement;
  const std::vector<double>& force = cycle.record.force;
  const auto [low, high] = std::ranges::minmax(x);
  EXPECT_NEAR(*fit["amplitude"], (high - low) / 2, 1e-12 * kCycleReach);
  const auto [least, most] = std::ranges::minmax(force);
  EXPECT_NEAR(*fit["peak_force"], (most - least) / 2, 2 * testing::kCycleNoise);
  double energy = 0.0;
  for (std::size_t i = 1; i < x.size(); ++i) {
    energy += (force[i] + force[i - 1]) / 2 * (x[i] - x[i - 1]);
  }
  EXPECT_NEAR(*fit["energy"], energy, 0.01 * energy);
  // In the middle of a stroke, X from its turn: Masing's 2f(X/2) − Tc, f = Tc(1 − (1 − δ/δc)^1.5).
  const double gross_slip = 1.5 * kCycleLaw.slip_force / kCycleLaw.tangential_stiffness;
  const double half_gap =
      kCycleLaw.slip_force * (1 - 2 * std::pow(1 - kCycleReach / 2 / gross_slip, 1.5));
  EXPECT_NEAR(*fit["half_gap"], half_gap, 3 * testing::kCycleNoise);
  EXPECT_NEAR(*fit["energy_ratio"], *fit["energy"] / (4 * *fit["amplitude"] * *fit["peak_force"]),
              1e-9);
  EXPECT_NEAR(*fit["rms"], testing::kCycleNoise, 0.25 * testing::kCycleNoise);
  EXPECT_NEAR(*fit["normal_load"], 120 - 0.5 / static_cast<double>(x.size()), 1e-9);
  EXPECT_NEAR(*fit["friction_coefficient"], *fit["slip_force"] / *fit["normal_load"], 1e-12);
  EXPECT_NEAR(*fit["energy_friction_coefficient"],
              *fit["energy"] / (4 * *fit["normal_load"] * *fit["sliding_amplitude"]), 1e-12);
  EXPECT_LT(*fit["sliding_amplitude"], *fit["amplitude"]);
  EXPECT_GT(*fit["sliding_amplitude"], 0.0);
  EXPECT_EQ(fit["start_time"], cycle.record.time.front());
  EXPECT_EQ(fit.number, 9U);
}

TEST(CycleFitter, TurnsWithTheSignOfItsForce) {
  Cycle cycle = FirstCycle();
  const CycleFit fit = CycleFitter({}).Fit(cycle);
  for (double& force : cycle.record.force) force = -force;
  const CycleFit turned = CycleFitter({}).Fit(cycle);
  constexpr double kDigits = 1e-6;
  EXPECT_NEAR(*turned["sigma"] / *fit["sigma"], 1.0, kDigits);
  EXPECT_NEAR(*turned["slip_force"] / *fit["slip_force"], 1.0, kDigits);
  EXPECT_NEAR(*turned["half_gap"] / *fit["half_gap"], 1.0, kDigits);
  EXPECT_NEAR(*turned["energy"] / *fit["energy"], 1.0, kDigits);
  EXPECT_TRUE(turned.flags.empty());
}

// ---

/// A fit whose numbers are given in the order of the columns.
CycleFit Filled(const std::function<double()>& next) {
  CycleFit fit;
  fit.number = 17;
  fit.first_line = 3402;
  fit.samples = 201;
  fit.cycles = 5;
  for (std::optional<double>& number : fit.numbers) number = next();
  fit.flags = {"glitches", "alpha_open"};
  return fit;
}

/// Numbers that have no round number of decimals.
CycleFit Filled() {
  double next = 0.1;
  return Filled([&] { return next /= 3; });
}

std::string WithoutEnd(const std::string& row) { return row.substr(0, row.size() - 1); }

TEST(CycleTable, ReadsBackEveryDigitItWrote) {
  const std::string row = CycleTableRow(Filled(), 1.0 / 3.0);
  const CycleFit fit = ReadCycleTableRow(WithoutEnd(row));
  EXPECT_EQ(CycleTableRow(fit, 1.0 / 3.0), row);
  EXPECT_EQ(fit["force_offset_error"], Filled()["force_offset_error"]);
  EXPECT_EQ(fit.flags, Filled().flags);
}

TEST(CycleTable, LeavesUnknownCellsEmpty) {
  CycleFit fit;
  fit.number = 3;
  const std::string row = CycleTableRow(fit, 0.0);
  EXPECT_TRUE(row.starts_with("3,0,0,1,,,")) << row;
  EXPECT_TRUE(row.ends_with(",0,\n")) << row;
  EXPECT_EQ(CycleTableRow(ReadCycleTableRow(WithoutEnd(row)), 0.0), row);
}

TEST(CycleTable, RefusesMalformedRow) {
  EXPECT_THROW(ReadCycleTableRow("1,2,3"), InputError);
  std::string row = WithoutEnd(CycleTableRow(Filled(), 1.0));
  row.replace(row.find("201"), 3, "2x1");
  EXPECT_THROW(ReadCycleTableRow(row), InputError);
}

TEST(CycleTable, HasEachNumberInItsColumn) {
  EXPECT_EQ(CycleTableHeader(false),
            "cycle,first_line,samples,cycles,start_time [s],amplitude [m],peak_force [N],"
            "sliding_amplitude [m],half_gap [N],energy [J],energy_ratio,"
            "energy_friction_coefficient,normal_load [N],sigma [N/m],"
            "sigma_error [N/m],alpha,alpha_error,slip_force [N],slip_force_error [N],"
            "force_offset [N],force_offset_error [N],rms [N],friction_coefficient,"
            "contact_radius [m],accumulated_energy [J],flags\n");
  EXPECT_EQ(CycleTableHeader(true),
            "cycle,first_line,samples,cycles,start_time [s],amplitude [rad],peak_force [N m],"
            "sliding_amplitude [rad],half_gap [N m],energy [J],energy_ratio,"
            "energy_friction_coefficient,normal_load [N m],"
            "sigma [N m/rad],sigma_error [N m/rad],alpha,alpha_error,slip_force [N m],"
            "slip_force_error [N m],force_offset [N m],force_offset_error [N m],rms [N m],"
            "friction_coefficient,accumulated_energy [J],flags\n");
  double next = 0.5;
  CycleFit fit = Filled([&] { return next += 1; });
  EXPECT_EQ(CycleTableRow(fit, 21.5),
            "17,3402,201,5,1.5,2.5,3.5,4.5,5.5,6.5,7.5,8.5,9.5,10.5,11.5,12.5,13.5,14.5,15.5,"
            "16.5,17.5,18.5,19.5,20.5,21.5,glitches alpha_open\n");
  EXPECT_EQ(CycleTableRow(fit, 21.5, /*is_torsional=*/true),
            "17,3402,201,5,1.5,2.5,3.5,4.5,5.5,6.5,7.5,8.5,9.5,10.5,11.5,12.5,13.5,14.5,15.5,"
            "16.5,17.5,18.5,19.5,21.5,glitches alpha_open\n");
}

}  // namespace
}  // namespace mindahl::campaign::cycle_fit_test
