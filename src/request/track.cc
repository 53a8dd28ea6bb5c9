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
#include "mindahl/contact/cattaneo_mindlin.h"
#include "mindahl/core/error.h"
#include "mindahl/core/interruption.h"
#include "mindahl/core/version.h"
#include "mindahl/report/units.h"
#include "report/template.h"
#include "request/json.h"

namespace mindahl::request {

using campaign::Evolution;

namespace {

Json QuantitiesJson(const std::vector<Evolution>& evolutions) {
  Json quantities = Json::object();
  for (const Evolution& evolution : evolutions) {
    const campaign::CourseDescription& course = evolution.description;
    Json steps = Json::array();
    for (const campaign::Step& step : course.steps) {
      steps.push_back({{"cycle", step.cycle},
                       {"before", step.before},
                       {"after", step.after},
                       {"p_value", step.p_value}});
    }
    Json trends = Json::array();
    for (const campaign::Trend& trend : course.trends) {
      trends.push_back({{"first_cycle", trend.first_cycle},
                        {"last_cycle", trend.last_cycle},
                        {"from", trend.from},
                        {"to", trend.to},
                        {"p_value", trend.p_value}});
    }
    quantities[std::string(evolution.quantity->name)] = {{"unit", evolution.unit},
                                                         {"first", course.first},
                                                         {"last", course.last},
                                                         {"steps", steps},
                                                         {"trends", trends}};
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

/// Returns the compliance G* [1/Pa], where it or the materials are known.
std::optional<double> ComplianceOf(const contact::KnownContact& known) {
  if (known.tangential_compliance) return known.tangential_compliance->value;
  const contact::KnownBody& one = known.body_1;
  const contact::KnownBody& two = known.body_2;
  if (!one.youngs_modulus || !one.poisson_ratio || !two.youngs_modulus || !two.poisson_ratio) {
    return std::nullopt;
  }
  return contact::TangentialCompliance(
      {.youngs_modulus = one.youngs_modulus->value, .poisson_ratio = one.poisson_ratio->value},
      {.youngs_modulus = two.youngs_modulus->value, .poisson_ratio = two.poisson_ratio->value});
}

std::vector<io::PlotPanel> PanelsOf(const TrackedTest& test,
                                    const std::vector<Evolution>& evolutions) {
  std::vector<io::PlotPanel> panels = campaign::EvolutionPanels(evolutions);
  if (test.log.size() > 1) panels.push_back(campaign::FrettingLog(test.log, test.is_torsional));
  return panels;
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

std::string ToPage(const TrackedTest& test, const std::vector<Evolution>& evolutions,
                   const report::Provenance& provenance) {
  const std::vector<std::string> changes = campaign::ChangeStatements(evolutions);
  Json ends = Json::array();
  for (const Evolution& evolution : evolutions) {
    ends.push_back({{"name", evolution.quantity->name},
                    {"first", report::Quantity(evolution.description.first, evolution.unit)},
                    {"last", report::Quantity(evolution.description.last, evolution.unit)}});
  }
  Json figures = Json::array();
  for (io::PlotPanel& panel : PanelsOf(test, evolutions)) {
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
                             : report::VerdictData(changes.empty() ? "good" : "poor",
                                                   changes.empty() ? "steady" : "changed",
                                                   campaign::Headline(evolutions))},
       {"changes", is_failed ? Json() : Json(changes)},
       {"cycles", test.cycles},
       {"samples", test.samples},
       {"fits", test.fits},
       {"dissipated", report::Quantity(test.energy.total(), "J")},
       {"energy_counts", campaign::InWords(test.energy.counts())},
       {"unused_samples", test.unused_samples},
       {"ends", std::move(ends)},
       {"evolutions", std::move(figures)},
       {"flags", std::move(flags)},
       {"provenance", report::ProvenanceData(provenance)}});
}

io::Plot ToPlot(const TrackedTest& test, const std::vector<Evolution>& evolutions) {
  constexpr int kPanelHeight = 230;  // [px]
  io::Plot plot{.title = report::NameOf(test.files), .panels = PanelsOf(test, evolutions)};
  if (plot.panels.empty()) {
    throw InvalidArgument("there is no time history to draw: no quantity is known for two cycles");
  }
  plot.panels.front().title = campaign::Headline(evolutions);
  plot.height = kPanelHeight * static_cast<int>(plot.panels.size() + 1);
  return plot;
}

std::string ToText(const TrackedTest& test, const std::vector<Evolution>& evolutions) {
  std::string text = campaign::Headline(evolutions) + "\n";
  text += fmt::format("{} cycles of {} samples, {} fits{}{}, {:.6g} J dissipated in all{}\n",
                      test.cycles, test.samples, test.fits, test.output.empty() ? "" : " in ",
                      test.output, test.energy.total(), campaign::InWords(test.energy.counts()));
  if (test.resumed > 0) text += fmt::format("{} of them existed already\n", test.resumed);
  if (test.unused_samples > 0) {
    text += fmt::format("{} samples at the ends belong to no whole cycle\n", test.unused_samples);
  }
  if (test.flagged > 0) {
    text += fmt::format("\n{} {} a flag:\n", test.flagged,
                        test.flagged == 1 ? "cycle has" : "cycles have");
    for (const campaign::CycleFlag& flag : campaign::CycleFlags()) {
      const auto found = test.flags.find(std::string(flag.name));
      if (found == test.flags.end()) continue;
      text += fmt::format("  {:<18}{:>8}   {}\n", flag.name, found->second, flag.meaning);
    }
  }
  if (evolutions.empty()) return text;
  text += fmt::format("\n  {:<30}{:>14}{:>14}\n", "", "first", "last");
  for (const Evolution& evolution : evolutions) {
    const campaign::CourseDescription& course = evolution.description;
    text += fmt::format("  {:<30}{:>14.5g}{:>14.5g}\n",
                        report::WithUnit(evolution.quantity->name, evolution.unit), course.first,
                        course.last);
  }
  const std::vector<std::string> changes = campaign::ChangeStatements(evolutions);
  if (changes.empty()) return text + "\nNo step of 2 % and no trend of 1 % is beyond chance.\n";
  return text + fmt::format("\nChanges beyond chance:\n  {}\n", fmt::join(changes, "\n  "));
}

std::string ToJson(const TrackedTest& test, const std::vector<Evolution>& evolutions) {
  return Dump({{"schema", "mindahl.track/1"},
               {"version", Version()},
               {"input",
                {{"files", test.files},
                 {"samples", test.samples},
                 {"cycles", test.cycles},
                 {"unused_samples", test.unused_samples},
                 {"broken_rows", test.broken_rows}}},
               {"reversals", {{"gate", test.reversal_gate}, {"certain", test.is_gate_certain}}},
               {"output", test.output.empty() ? Json() : Json(test.output)},
               {"fits", test.fits},
               {"flagged", test.flagged},
               {"flags", FlagsJson(test)},
               {"accumulated_energy", test.energy.total()},
               {"energy_counts", EnergyCountsJson(test.energy.counts())},
               {"headline", campaign::Headline(evolutions)},
               {"quantities", QuantitiesJson(evolutions)}});
}

void Validate(const TrackRequest& request) {
  MakeCycleFitOptions(request.fit);
  Validate(request.fit.contact);
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
  const contact::KnownContact& known = request_.fit.contact.known;
  if (known.normal_load) fit_.normal_loads = {known.normal_load->value};
  reading_ = campaign::ChooseReading(head, fit_);
  chosen_terms_ = ChooseTermsOfCycles(request_.fit, head, fit_);
  campaign::TrackOptions options{
      .fit = fit_,
      .compliance = test_.is_torsional ? std::nullopt : ComplianceOf(known),
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
  io::RecordStream stream(file, request_.fit.columns);
  for (const std::string& note : stream.layout().notes) {
    if (events_.note) events_.note(note);
  }
  BeginSource(stream.layout(), file);
  io::Samples piece;
  if (tracker_) {
    stream.Next(piece);
  } else {
    piece = campaign::ReadHead(stream);
    BeginFits(piece, file);
  }
  while (piece.size() > 0) {
    bytes_read_ = bytes_before_ + stream.bytes();
    test_.samples += piece.size();
    times_.Shift(piece.time);
    tracker_->Add(piece, piece.lines);
    AskWhetherToGoOn();
    if (events_.piece_is_read) events_.piece_is_read();
    if (!stream.Next(piece)) break;
  }
  EndSource();
  bytes_before_ += stream.bytes();
  const io::LeftOutRows left_out = stream.left_out();
  const bool skips = request_.fit.columns.skip_broken_rows;
  if (skips) test_.broken_rows += left_out.count;
  if (left_out.count > 0 && !skips && events_.note) {
    events_.note(
        fmt::format("{}: {} rows have no number in a column that is used and are left out, the "
                    "first in line {}",
                    file, left_out.count, left_out.first_line));
  }
  if (left_out.count > 0 && skips && events_.warn) {
    events_.warn(fmt::format("{} broken rows of {} were skipped, the first: {}", left_out.count,
                             file, left_out.fault));
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
  test_.log = tracker_->log();
  test_.reversal_gate = *fit_.preparation.reversal_gate;
  test_.is_gate_certain = reading_.gate.certain;
  campaign::RequireCycles(test_.cycles, request_.average, reading_, test_.reversal_gate,
                          fmt::format("{}", fmt::join(names_, ", ")));
}

}  // namespace mindahl::request
