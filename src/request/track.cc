#include "mindahl/request/track.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <span>
#include <string_view>
#include <utility>

#include "mindahl/campaign/cycle_fit.h"
#include "mindahl/campaign/evolution.h"
#include "mindahl/campaign/test_summary.h"
#include "mindahl/core/error.h"
#include "mindahl/core/version.h"
#include "mindahl/report/units.h"
#include "report/statements.h"
#include "report/template.h"
#include "request/json.h"

namespace mindahl::request {

using campaign::CourseDescription;
using campaign::TrackedQuantity;

namespace {

std::string UnitOf(const TrackedTest& test, std::string_view unit) {
  return report::UnitIn(test.is_torsional ? report::kUnitsOfTorque : report::kUnitsOfForce, unit);
}

Json QuantitiesJson(const TrackedTest& test, const std::vector<CourseDescription>& courses) {
  const std::span<const TrackedQuantity> tracked = campaign::TrackedQuantities();
  Json quantities = Json::object();
  for (std::size_t k = 0; k < tracked.size(); ++k) {
    const CourseDescription& course = courses[k];
    if (course.stretches.empty()) continue;
    Json stretches = Json::array();
    for (const campaign::Stretch& stretch : course.stretches) {
      stretches.push_back({{"first_cycle", stretch.first_cycle},
                           {"last_cycle", stretch.last_cycle},
                           {"at_start", stretch.at_start},
                           {"at_end", stretch.at_end},
                           {"slope", stretch.slope},
                           {"slope_p_value", stretch.slope_p_value},
                           {"trends", stretch.trends},
                           {"time_constant", NumberOrNull(stretch.time_constant)}});
    }
    Json changes = Json::array();
    for (const campaign::Change& change : course.changes) {
      changes.push_back({{"kind", campaign::NameOf(change.kind)},
                         {"cycle", change.cycle},
                         {"ci95", {change.lower95, change.upper95}},
                         {"before", change.before},
                         {"after", change.after},
                         {"p_value", change.p_value}});
    }
    quantities[std::string(tracked[k].name)] = {
        {"unit", UnitOf(test, tracked[k].unit)}, {"stretches", stretches}, {"changes", changes}};
  }
  return quantities;
}

Json FlagsJson(const TrackedTest& test) {
  Json flags = Json::object();
  for (const campaign::CycleFlag& flag : campaign::CycleFlags()) {
    const auto found = test.flags.find(std::string(flag.name));
    flags[std::string(flag.name)] = found == test.flags.end() ? 0 : found->second;
  }
  return flags;
}

Json EnergyCountsJson(const campaign::EnergyCounts& counts) {
  return {
      {"measured", counts.measured}, {"replaced", counts.replaced}, {"left_out", counts.left_out}};
}

/// Returns the time histories that a figure shows: of friction coefficient and slip force, which
/// say the same, the first where it is known.
std::vector<campaign::Evolution> EvolutionsOf(const TrackedTest& test,
                                              const std::vector<CourseDescription>& described) {
  const std::span<const TrackedQuantity> tracked = campaign::TrackedQuantities();
  std::vector<campaign::Evolution> evolutions;
  const auto is_known = [&](std::string_view name) {
    const auto found = std::ranges::find(tracked, name, &TrackedQuantity::name);
    const auto k = static_cast<std::size_t>(found - tracked.begin());
    return !described[k].stretches.empty();
  };
  for (std::size_t k = 0; k < tracked.size(); ++k) {
    const TrackedQuantity& quantity = tracked[k];
    if (!quantity.is_drawn || described[k].stretches.empty()) continue;
    if (quantity.name == "slip_force" && is_known("friction_coefficient")) continue;
    evolutions.push_back(
        {.name = std::string(quantity.name),
         .unit = std::string(UnitOf(test, quantity.unit)),
         .has_errors = quantity.has_standard_error && test.courses.have_errors()[k],
         .course = test.courses.courses()[k],
         .description = described[k]});
  }
  return evolutions;
}

}  // namespace

void TrackedTest::Add(const campaign::CycleFit& fit) {
  ++fits;
  flagged += fit.flags.empty() ? 0 : 1;
  for (const std::string& flag : fit.flags) ++flags[flag];
  courses.Add(fit);
}

bool TrackedTest::established() const {
  const auto failed = flags.find("not_converged");
  return failed == flags.end() || failed->second != fits;
}

std::vector<std::string> Changes(const TrackedTest& test,
                                 const std::vector<CourseDescription>& described) {
  const std::span<const TrackedQuantity> tracked = campaign::TrackedQuantities();
  std::vector<std::string> changes;
  for (std::size_t k = 0; k < tracked.size(); ++k) {
    const std::string name = report::WithUnit(tracked[k].name, UnitOf(test, tracked[k].unit));
    for (const std::string& line : campaign::ChangeStatements(described[k])) {
      changes.push_back(fmt::format("{}: {}", name, line));
    }
  }
  return changes;
}

std::string ToPage(const TrackedTest& test, const std::vector<CourseDescription>& described,
                   const report::Provenance& provenance) {
  const std::vector<campaign::Evolution> evolutions = EvolutionsOf(test, described);
  const std::vector<std::string> changes = Changes(test, described);
  Json ends = Json::array();
  for (const campaign::Evolution& evolution : evolutions) {
    const auto& stretches = evolution.description.stretches;
    if (stretches.empty()) continue;
    ends.push_back({{"name", evolution.name},
                    {"first", report::Quantity(stretches.front().at_start, evolution.unit)},
                    {"last", report::Quantity(stretches.back().at_end, evolution.unit)}});
  }
  Json figures = Json::array();
  for (io::PlotPanel& panel : campaign::EvolutionPanels(evolutions)) {
    const std::string id = fmt::format("evolution-{}", figures.size() + 1);
    std::string quantity = panel.y_label;
    figures.push_back({{"id", id},
                       {"quantity", std::move(quantity)},
                       {"figure", report::FigureData(std::move(panel), id)}});
  }
  Json flags = Json::array();
  for (const campaign::CycleFlag& flag : campaign::CycleFlags()) {
    const auto found = test.flags.find(std::string(flag.name));
    if (found == test.flags.end()) continue;
    flags.push_back({{"name", flag.name}, {"cycles", found->second}, {"meaning", flag.meaning}});
  }
  const bool is_failed = !test.established();
  return report::RenderPage(
      "track",
      {{"title", fmt::format("{}: {} cycles", report::NameOf(test.files), test.cycles)},
       {"verdict", is_failed ? report::VerdictData("bad", "failed", "no fit of a cycle converged")
                   : changes.empty()
                       ? report::VerdictData("good", "steady", campaign::kNothingChanged)
                       : report::VerdictData("poor", "changed", "these changes are beyond chance")},
       {"changes", is_failed ? Json() : Json(changes)},
       {"cycles", test.cycles},
       {"samples", test.samples},
       {"fits", test.fits},
       {"dissipated", report::Quantity(test.energy.total(), "J")},
       {"energy_counts", campaign::InWords(test.energy.counts())},
       {"unused_samples", test.unused_samples},
       {"shared_alpha", test.shared_alpha ? campaign::SharedAlphaInWords(*test.shared_alpha) : ""},
       {"ends", std::move(ends)},
       {"evolutions", std::move(figures)},
       {"flags", std::move(flags)},
       {"provenance", report::ProvenanceData(provenance)}});
}

io::Plot ToPlot(const TrackedTest& test, const std::vector<CourseDescription>& described) {
  const std::string_view changes = Changes(test, described).empty()
                                       ? campaign::kNothingChanged
                                       : "dashed where it changed beyond chance";
  return campaign::EvolutionPlot(EvolutionsOf(test, described), report::NameOf(test.files),
                                 fmt::format("{} cycles: {}", test.cycles, changes));
}

std::string ToText(const TrackedTest& test, const std::vector<CourseDescription>& described) {
  const std::span<const TrackedQuantity> tracked = campaign::TrackedQuantities();
  std::string text =
      fmt::format("{} cycles of {} samples, {} fits{}{}\n", test.cycles, test.samples, test.fits,
                  test.output.empty() ? "" : " in ", test.output);
  if (test.resumed > 0) text += fmt::format("{} of them existed already\n", test.resumed);
  if (test.unused_samples > 0) {
    text += fmt::format("{} samples at the ends belong to no whole cycle\n", test.unused_samples);
  }
  text += fmt::format("{:.6g} J dissipated in all{}\n", test.energy.total(),
                      campaign::InWords(test.energy.counts()));
  if (test.shared_alpha) text += campaign::SharedAlphaInWords(*test.shared_alpha) + "\n";
  if (test.flagged > 0) {
    text += fmt::format("\n{} {} a flag:\n", test.flagged,
                        test.flagged == 1 ? "cycle has" : "cycles have");
    for (const campaign::CycleFlag& flag : campaign::CycleFlags()) {
      const auto found = test.flags.find(std::string(flag.name));
      if (found == test.flags.end()) continue;
      text += fmt::format("  {:<18}{:>8}   {}\n", flag.name, found->second, flag.meaning);
    }
  }
  std::string courses;
  std::string changes;
  std::string small_trends;
  for (std::size_t k = 0; k < tracked.size(); ++k) {
    const campaign::CourseDescription& course = described[k];
    if (course.stretches.empty()) continue;
    const std::string name = report::WithUnit(tracked[k].name, UnitOf(test, tracked[k].unit));
    courses += fmt::format("  {:<30}{:>14.5g}{:>14.5g}\n", name, course.stretches.front().at_start,
                           course.stretches.back().at_end);
    for (const std::string& line : campaign::ChangeStatements(course)) {
      changes += fmt::format("  {:<21} {}\n", tracked[k].name, line);
    }
    for (const std::string& line : campaign::SmallTrendStatements(course)) {
      small_trends += fmt::format("  {:<21} {}\n", tracked[k].name, line);
    }
  }
  if (!courses.empty()) {
    text +=
        fmt::format("\n  {:<30}{:>14}{:>14}\n{}", "over the test", "at first", "at last", courses);
    text += changes.empty() ? fmt::format("\nN{}.\n", campaign::kNothingChanged.substr(1))
                            : "\nChanges:\n" + changes;
    if (!small_trends.empty()) text += "\nBeyond chance, but less than 1 %:\n" + small_trends;
  }
  return text;
}

std::string ToJson(const TrackedTest& test, const std::vector<CourseDescription>& described) {
  Json json;
  json["schema"] = "mindahl.track/1";
  json["version"] = Version();
  json["input"] = {{"files", test.files},
                   {"samples", test.samples},
                   {"cycles", test.cycles},
                   {"unused_samples", test.unused_samples},
                   {"broken_rows", test.broken_rows}};
  json["reversals"] = {{"gate", test.reversal_gate}, {"certain", test.is_gate_certain}};
  json["output"] = test.output.empty() ? Json() : Json(test.output);
  json["fits"] = test.fits;
  json["flagged"] = test.flagged;
  json["flags"] = FlagsJson(test);
  json["accumulated_energy"] = test.energy.total();
  json["energy_counts"] = EnergyCountsJson(test.energy.counts());
  json["shared_alpha"] = nullptr;
  if (test.shared_alpha) {
    json["shared_alpha"] = {{"value", test.shared_alpha->mean()},
                            {"standard_error", test.shared_alpha->standard_error()},
                            {"cycles", test.shared_alpha->count()},
                            {"scatter", test.shared_alpha->scatter()},
                            {"p_value", test.shared_alpha->p_value()}};
  }
  json["quantities"] = QuantitiesJson(test, described);
  return Dump(json);
}

void Validate(const TrackRequest& request) {
  const identification::FitOptions fit = MakeCycleFitOptions(request.fit);
  if (request.normal_load) RequirePositive("--normal-load [N]", *request.normal_load);
  if (request.shares_alpha) campaign::RequireThatAlphaCanBeShared(fit, request.fit.files);
}

TrackRun::TrackRun(const TrackRequest& request, TrackEvents events)
    : request_(request), events_(std::move(events)), test_(request.average * request.every) {}

void TrackRun::BeginSource(const io::RecordFile& layout, const std::string& name) {
  names_.push_back(name);
  if (!layout_) {
    layout_ = layout;
    layout_->record = {};
    test_.is_torsional = layout.is_torsional;
  }
  if (request_.fit.join) io::RequireJoinable(*layout_, names_.front(), layout, name);
  if (layout.is_torsional == test_.is_torsional) return;
  throw InputError(fmt::format("{} holds a {} and {} a {}: track them apart", names_.front(),
                               test_.is_torsional ? "torque" : "force", name,
                               layout.is_torsional ? "torque" : "force"));
}

void TrackRun::BeginFits(const loop::RecordView& head, std::string_view source) {
  fit_ = MakeCycleFitOptions(request_.fit);
  if (request_.normal_load) fit_.normal_loads = {*request_.normal_load};
  reading_ = campaign::ChooseReading(head, fit_);
  chosen_terms_ = ChooseTermsOfCycles(request_.fit, head, fit_);
  if (test_.shared_alpha) fit_.fixed["alpha"] = test_.shared_alpha->mean();
  campaign::TrackOptions options{.fit = fit_,
                                 .together = request_.average,
                                 .every = request_.every,
                                 .threads = request_.threads};
  if (events_.begins) events_.begins(options);
  const auto doubt = campaign::DoubtAbout(reading_, source);
  if (doubt && events_.warn) events_.warn(*doubt);
  tracker_.emplace(std::move(options), events_.fits);
}

void TrackRun::EndSource() {
  if (request_.fit.join) {
    times_.NextFile();
  } else {
    test_.unused_samples += tracker_->NextFile();
    times_ = {};
  }
}

void TrackRun::ReadFile(const std::string& file) {
  io::RecordStream stream(file, request_.fit.columns, request_.broken_rows);
  for (const std::string& note : stream.layout().notes) {
    if (events_.note) events_.note(note);
  }
  BeginSource(stream.layout(), file);
  io::Samples piece;
  if (tracker_) {
    stream.Next(piece);
  } else {
    piece = campaign::ReadHead(stream);
    BeginFits(campaign::ViewOf(piece), file);
  }
  while (piece.size() > 0) {
    bytes_read_ = bytes_before_ + stream.bytes();
    test_.samples += piece.size();
    times_.Shift(piece.time);
    tracker_->Add(campaign::ViewOf(piece), piece.lines);
    if (events_.piece_is_read) events_.piece_is_read();
    if (!stream.Next(piece)) break;
  }
  EndSource();
  test_.broken_rows += stream.broken_rows();
  bytes_before_ += stream.bytes();
  if (stream.footer_lines() > 0 && events_.note) {
    events_.note(fmt::format("{}: {} lines below the data skipped, since they begin with a text",
                             file, stream.footer_lines()));
  }
  if (stream.broken_rows() > 0 && events_.warn) {
    events_.warn(fmt::format("{} broken rows of {} were skipped, the first: {}",
                             stream.broken_rows(), file, stream.first_broken_row()));
  }
}

void TrackRun::ReadRecord(const io::NamedRecord& record) {
  static constexpr std::size_t kMostOfHead = 1'000'000;
  BeginSource(record.file, record.name);
  const loop::Record& samples = record.file.record;
  if (!tracker_) {
    const auto first = [](const std::vector<double>& column) {
      return std::span(column).first(std::min(column.size(), kMostOfHead));
    };
    BeginFits({first(samples.displacement), first(samples.force), first(samples.time),
               first(samples.normal_load)},
              record.name);
  }
  test_.samples += samples.size();
  std::vector<double> time = samples.time;
  times_.Shift(time);
  tracker_->Add({samples.displacement, samples.force, time, samples.normal_load},
                record.file.lines);
  EndSource();
}

void TrackRun::PoolAlpha(std::span<const io::NamedRecord> records) {
  campaign::PooledValue alpha;
  TrackRun first_pass(request_, {.fits = [&alpha](std::span<const campaign::CycleFit> fits) {
                        for (const campaign::CycleFit& fit : fits) campaign::PoolAlpha(fit, alpha);
                      }});
  first_pass.Read(records);
  if (first_pass.cycles() == 0) return;  // as the second pass will say
  campaign::RequireSharedAlpha(alpha);
  test_.shared_alpha = alpha;
}

void TrackRun::Read(std::span<const io::NamedRecord> records) {
  if (records.empty()) {
    for (const std::string& file : request_.fit.files) ReadFile(file);
  }
  for (const io::NamedRecord& record : records) ReadRecord(record);
  if (!tracker_) throw InputError("nothing to track: give a record");
  if (request_.fit.join) test_.unused_samples += tracker_->NextFile();
  tracker_->Finish();
}

void TrackRun::Finish() {
  test_.files = names_;
  test_.cycles = tracker_->cycles();
  test_.reversal_gate = *fit_.preparation.reversal_gate;
  test_.is_gate_certain = reading_.gate.certain;
  campaign::RequireCycles(test_.cycles, request_.average, reading_, test_.reversal_gate,
                          fmt::format("{}", fmt::join(names_, ", ")));
}

struct SeparateTests::Document {
  Json tests = Json::array();
};

SeparateTests::SeparateTests(std::string output, bool has_document)
    : output_(std::move(output)),
      document_(has_document ? std::make_unique<Document>() : nullptr) {}

SeparateTests::~SeparateTests() = default;

void SeparateTests::Add(const std::string& file, const std::string& fault, const TrackedTest& test,
                        bool was_there) {
  ++tests_;
  fits_ += test.fits;
  flagged_ += test.flagged;
  energy_ += test.energy.total();
  if (was_there) kept_ += test.fits;
  if (!fault.empty()) faults_.push_back(fault);
  established_ = established_ && fault.empty() && test.established();
  if (document_ == nullptr) return;
  document_->tests.push_back({{"file", file},
                              {"fault", fault.empty() ? Json() : Json(fault)},
                              {"fits", test.fits},
                              {"flagged", test.flagged},
                              {"flags", FlagsJson(test)},
                              {"accumulated_energy", test.energy.total()},
                              {"energy_counts", EnergyCountsJson(test.energy.counts())},
                              {"quantities", QuantitiesJson(test, test.courses.Describe())}});
}

std::string SeparateTests::ToJson() const {
  return Dump({{"schema", "mindahl.track_separate/1"},
               {"version", Version()},
               {"output", output_},
               {"fits", fits_},
               {"flagged", flagged_},
               {"accumulated_energy", energy_},
               {"tests", document_->tests}});
}

std::string SeparateTests::ToText() const {
  std::string text = fmt::format("{} test{}, {} fit{} in {}\n", tests_, tests_ == 1 ? "" : "s",
                                 fits_, fits_ == 1 ? "" : "s", output_);
  if (kept_ > 0) text += fmt::format("{} of them existed already\n", kept_);
  text += fmt::format("{:.6g} J dissipated in all\n", energy_);
  if (flagged_ > 0) {
    text += fmt::format("{} {} a flag\n", flagged_, flagged_ == 1 ? "cycle has" : "cycles have");
  }
  if (!faults_.empty()) {
    text +=
        fmt::format("{} of the tests failed:\n  {}\n", faults_.size(), fmt::join(faults_, "\n  "));
  }
  return text;
}

}  // namespace mindahl::request
