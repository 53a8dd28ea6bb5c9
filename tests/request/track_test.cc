#include "mindahl/request/track.h"

#include <nlohmann/json.hpp>

#include "support/prelude.h"
#include "support/text.h"

namespace mindahl::request::track_test {
namespace {

TEST(TrackedTest, CountsACycleOnceThatHasTwoFlags) {
  TrackedTest test;
  campaign::CycleFit open;
  open.flags = {"sigma_open", "alpha_open"};
  test.Add(open);
  test.Add({});
  EXPECT_EQ(test.fits, 2U);
  EXPECT_EQ(test.flagged, 1U);
  EXPECT_EQ(test.flags.at("alpha_open"), 1U);
}

/// A fit of a row that stands for `cycles`, which lose an energy each.
campaign::CycleFit Losing(double energy, std::vector<std::string> flags = {}) {
  campaign::CycleFit fit;
  fit.samples = 101;
  fit.energy = energy;
  fit.flags = std::move(flags);
  return fit;
}

TrackedTest Lossy(std::vector<campaign::CycleFit> fits, std::size_t together) {
  TrackedTest test(together);
  for (campaign::CycleFit& fit : fits) {
    fit.number = 1 + test.fits * together;
    test.energy.Add(fit);
    test.Add(fit);
  }
  return test;
}

TEST(TrackedTest, StatesWhatItsCyclesLoseAndWhichOfThemCount) {
  // Two cycles a row: 2·(3 + 5), an open row by the median energy a sample of those before, and
  // again 2·7.
  TrackedTest test = Lossy(
      {Losing(3.0), Losing(5.0), Losing(100.0, {"not_closed"}), Losing(7.0, {"sigma_open"})}, 2);
  test.cycles = 8;
  test.samples = 812;
  test.unused_samples = 5;
  test.output = "t.csv";
  const auto json = nlohmann::json::parse(ToJson(test, test.courses.Describe(test.is_torsional)));
  EXPECT_NEAR(json["accumulated_energy"], 2 * (3.0 + 5 + 4 + 7), 1e-12);
  EXPECT_EQ(json["energy_counts"]["measured"], 3);
  EXPECT_EQ(json["energy_counts"]["replaced"], 1);
  EXPECT_EQ(json["energy_counts"]["left_out"], 0);
  EXPECT_EQ(json["fits"], 4);
  EXPECT_EQ(json["flagged"], 2);
  EXPECT_EQ(json["flags"]["not_closed"], 1);
  EXPECT_EQ(json["flags"]["not_converged"], 0);
  EXPECT_EQ(json["input"]["unused_samples"], 5);
  const std::string text = ToText(test, test.courses.Describe(test.is_torsional));
  EXPECT_THAT(text, HasSubstr("8 cycles of 812 samples, 4 fits in t.csv, 38 J dissipated in all, "
                              "counting 1 "));
  EXPECT_THAT(text, HasSubstr("5 samples at the ends belong to no whole cycle\n"));
  EXPECT_THAT(text, HasSubstr("2 cycles have a flag:"));
}

TEST(TrackedTest, IsEstablishedUnlessNoFitConverged) {
  EXPECT_TRUE(Lossy({Losing(1.0), Losing(1.0, {"not_converged"})}, 1).established());
  EXPECT_FALSE(
      Lossy({Losing(1.0, {"not_converged"}), Losing(1.0, {"not_converged"})}, 1).established());
}

/// A test whose σ falls by a tenth after its 60th cycle, each of which loses 2.5 mJ.
TrackedTest Stepping() {
  TrackedTest test;
  test.files = {"<script>.csv"};
  for (test.cycles = 1; test.cycles <= 100; ++test.cycles) {
    const double ripple = test.cycles % 2 == 0 ? 1e5 : -1e5;
    campaign::CycleFit fit = Losing(0.0025);
    fit.number = test.cycles;
    fit.sigma = {(test.cycles <= 60 ? 5e7 : 4.5e7) + ripple, 2e5};
    if (test.cycles <= 7) fit.flags = {"alpha_open"};
    test.energy.Add(fit);
    test.Add(fit);
  }
  test.cycles = test.fits;
  return test;
}

std::string PageOf(const TrackedTest& test) {
  return testing::Unbroken(ToPage(test, test.courses.Describe(test.is_torsional)));
}

TEST(TestPage, SaysWhatChangedAndEscapesItsFiles) {
  const std::string page = PageOf(Stepping());
  EXPECT_THAT(page, HasSubstr("<h1>&lt;script&gt;.csv: 100 cycles</h1>"));
  EXPECT_THAT(page, HasSubstr("<li>sigma: a step at cycle 61, 50.0 → 45.0 N/µm"));
  EXPECT_THAT(page, HasSubstr("<figure id=\"evolution-1\">"));
  EXPECT_THAT(page, HasSubstr("<th scope=\"row\">alpha_open</th><td class=\"number\">7</td>"));
  EXPECT_THAT(page, HasSubstr("250 mJ dissipated in all;"));
  EXPECT_THAT(page, HasSubstr("σ -9.6 %"));
  EXPECT_THAT(page, Not(HasSubstr("<script")));
}

TEST(TestPage, ReportsTheSourceOfEnergies) {
  TrackedTest test =
      Lossy({Losing(1.0, {"not_closed"}), Losing(3.0), Losing(9.0, {"not_closed"})}, 1);
  test.files = {"a.csv"};
  EXPECT_THAT(PageOf(test), HasSubstr("counting 1 unclosed cycles by the median of those before "
                                      "them and 1 as zero"));
}

TEST(TestPage, OfFitsThatAllFailedSaysSo) {
  TrackedTest test;
  test.files = {"a.csv"};
  campaign::CycleFit failed;
  failed.flags = {"not_converged"};
  test.Add(failed);
  const std::string page = PageOf(test);
  EXPECT_THAT(page, HasSubstr("<strong>failed</strong>: no fit of a cycle converged"));
  EXPECT_THAT(page, Not(HasSubstr("<figure")));
}

/// σ and Tc of a test, described by hand.
std::vector<campaign::Evolution> DescribedByHand() {
  const auto of = [](std::string_view name, std::string unit,
                     campaign::CourseDescription description) {
    return campaign::Evolution{.quantity = &*std::ranges::find(campaign::TrackedQuantities(), name,
                                                               &campaign::TrackedQuantity::name),
                               .unit = std::move(unit),
                               .course = {},
                               .description = std::move(description)};
  };
  return {of("slip_force", "N m", {.first = 40.5, .last = 40.25}),
          of("sigma", "N m/rad",
             {.first = 1.5,
              .last = 6.5,
              .steps = {{21, 8.5, 9.5, 0.375}},
              .trends = {{1, 20, 1.5, 2.5, 1e-5}}})};
}

TEST(TrackedTest, TextHasEveryNumberInItsLine) {
  TrackedTest test = Lossy({Losing(3.0), Losing(5.0, {"sigma_open"})}, 1);
  test.cycles = 60;
  test.samples = 812;
  test.resumed = 7;
  EXPECT_EQ(ToText(test, DescribedByHand()),
            "Tc 40.5 N m, unchanged; σ +333 %\n"
            "60 cycles of 812 samples, 2 fits, 8 J dissipated in all\n"
            "7 of them existed already\n"
            "\n1 cycle has a flag:\n"
            "  sigma_open               1   the cycle does not determine sigma\n"
            "\n                                         first          last\n"
            "  slip_force [N m]                        40.5         40.25\n"
            "  sigma [N m/rad]                          1.5           6.5\n"
            "\nChanges beyond chance:\n"
            "  sigma: cycles 1 to 20, 1.50 → 2.50 N m/rad (+67 %), p 1e-05\n"
            "  sigma: a step at cycle 21, 8.50 → 9.50 N m/rad (+12 %), p 0.4\n");
  EXPECT_THAT(ToText(test, {DescribedByHand()[0]}),
              HasSubstr("\n\nNo step of 2 % and no trend of 1 % is beyond chance.\n"));
}

TEST(TrackedTest, JsonHasEveryNumberUnderItsName) {
  TrackedTest test = Lossy({Losing(3.0), Losing(5.0, {"sigma_open"})}, 1);
  test.files = {"a.csv", "b.csv"};
  test.cycles = 60;
  test.samples = 812;
  test.unused_samples = 5;
  test.broken_rows = 4;
  test.reversal_gate = 0.25;
  test.is_gate_certain = false;
  test.output = "t.csv";
  auto json = nlohmann::json::parse(ToJson(test, DescribedByHand()));
  for (const char* key : {"version", "flags", "headline"}) json.erase(key);
  EXPECT_EQ(json, nlohmann::json::parse(R"({
    "schema": "mindahl.track/1",
    "input": {"files": ["a.csv", "b.csv"], "samples": 812, "cycles": 60, "unused_samples": 5,
              "broken_rows": 4},
    "reversals": {"gate": 0.25, "certain": false}, "output": "t.csv", "fits": 2, "flagged": 1,
    "accumulated_energy": 8, "energy_counts": {"measured": 2, "replaced": 0, "left_out": 0},
    "quantities": {
      "slip_force": {"unit": "N m", "first": 40.5, "last": 40.25, "steps": [],
                     "trends": []},
      "sigma": {"unit": "N m/rad", "first": 1.5, "last": 6.5,
                "steps": [{"cycle": 21, "before": 8.5, "after": 9.5, "p_value": 0.375}],
                "trends": [{"first_cycle": 1, "last_cycle": 20, "from": 1.5, "to": 2.5,
                            "p_value": 1e-5}]}}})"));
}

TEST(TrackedTest, FigureShowsTheFrictionCoefficientInPlaceOfTheSlipForce) {
  TrackedTest test;
  test.files = {"x/a.csv"};
  for (std::size_t k = 1; k <= 30; ++k) {
    campaign::CycleFit fit = Losing(1.0);
    fit.number = k;
    fit.slip_force = {40.0, 0.5};
    test.Add(fit);
  }
  test.cycles = 30;
  const auto labels = [&] {
    std::vector<std::string> all;
    for (const io::PlotPanel& panel :
         ToPlot(test, test.courses.Describe(test.is_torsional)).panels) {
      all.push_back(panel.y_label);
    }
    return all;
  };
  EXPECT_THAT(labels(), ElementsAre("slip_force [N]"));
  const io::Plot plot = ToPlot(test, test.courses.Describe(test.is_torsional));
  EXPECT_EQ(plot.title, "a.csv");
  EXPECT_EQ(plot.panels.front().title, "Tc 40 N, unchanged");
  TrackedTest loaded;
  loaded.files = {"a.csv"};
  for (std::size_t k = 1; k <= 30; ++k) {
    campaign::CycleFit fit = Losing(1.0);
    fit.number = k;
    fit.slip_force = {k <= 15 ? 40.0 : 20.0, 0.5};
    fit.friction_coefficient = k <= 15 ? 0.5 : 0.25;
    loaded.Add(fit);
  }
  loaded.cycles = 30;
  test = std::move(loaded);
  EXPECT_THAT(labels(), ElementsAre("friction_coefficient"));
  EXPECT_EQ(ToPlot(test, test.courses.Describe(test.is_torsional)).panels.front().title,
            "μ 0.500 → 0.250");
}

/// Jenkins' loop of 20 N, of cycles of 40 samples between ±1 µm at a load of 50 N.
io::NamedRecord LoopOf(const char* name, std::size_t cycles, bool is_torsional = false) {
  io::NamedRecord record{.name = name, .file = {}};
  record.file.is_torsional = is_torsional;
  double force = 0.0;
  double before = 0.0;
  for (std::size_t i = 0; i <= 40 * cycles; ++i) {
    const double x = 1e-6 * std::sin(2 * std::numbers::pi * static_cast<double>(i) / 40);
    force = std::clamp(force + 4e7 * (x - before), -20.0, 20.0);
    before = x;
    record.file.record.displacement.push_back(x);
    // A little of everything, so that a fit of it has errors.
    record.file.record.force.push_back(force + 0.01 * std::sin(1.7 * static_cast<double>(i * i)));
    record.file.lines.push_back(i + 2);
  }
  return record;
}

TEST(TrackRun, CountsTheSamplesAndCyclesOfItsRecords) {
  const std::vector<io::NamedRecord> records = {LoopOf("a", 5), LoopOf("b", 4)};
  TrackRequest request;
  std::size_t fits = 0;
  TrackRun run(request,
               {.fits = [&](std::span<const campaign::CycleFit> done) { fits += done.size(); }});
  run.Read(records);
  run.Finish();
  // A record begins in the middle of a stroke: its first and last half cycle are of no cycle.
  EXPECT_EQ(fits, 4U + 3U);
  EXPECT_EQ(run.test().cycles, 7U);
  EXPECT_EQ(run.test().samples, 201U + 161U);
  EXPECT_THAT(run.test().files, ElementsAre("a", "b"));
  EXPECT_FALSE(run.test().is_torsional);
  const std::vector<io::NamedRecord> mixed = {LoopOf("a", 5), LoopOf("b", 4, true)};
  TrackRun other(request, {.fits = [](std::span<const campaign::CycleFit>) {}});
  try {
    other.Read(mixed);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "a holds a force and b a torque: track them apart");
  }
}

TEST(TrackRun, TakesTheLoadThatIsGiven) {
  const std::vector<io::NamedRecord> records = {LoopOf("a", 5)};
  TrackRequest request;
  request.fit.contact.known.normal_load = contact::UncertainValue{80.0};
  std::vector<campaign::CycleFit> fits;
  TrackRun run(request, {.fits = [&](std::span<const campaign::CycleFit> done) {
                 fits.insert(fits.end(), done.begin(), done.end());
               }});
  run.Read(records);
  ASSERT_EQ(fits.size(), 4U);
  EXPECT_EQ(fits[0].normal_load, 80.0);
  EXPECT_FALSE(fits[0].contact_radius);
  ASSERT_TRUE(fits[0].friction_coefficient);
  EXPECT_NEAR(*fits[0].friction_coefficient, 0.25, 0.01);
  EXPECT_THROW(TrackRun(request, {}).Read({}), InputError);
  request.fit.contact.known.normal_load = contact::UncertainValue{0.0};
  EXPECT_THROW(Validate(request), InvalidArgument);
}

}  // namespace
}  // namespace mindahl::request::track_test
