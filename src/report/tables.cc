#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <string_view>
#include <vector>

#include "mindahl/io/csv_table.h"
#include "mindahl/report/report.h"
#include "mindahl/report/units.h"
#include "report/names.h"
#include "report/statements.h"

namespace mindahl::report {

std::string ResidualsCsv(const Report& report) {
  RequireFitted(report, "a table of residuals");
  std::vector<double> file;
  std::vector<double> time;
  std::vector<double> displacement;
  std::vector<double> force;
  const bool is_of_force = report.fit.response == loop::Channel::kForce;
  std::vector<double> fitted;
  std::vector<double> residual;
  const auto append = [](std::vector<double>& to, const std::vector<double>& from) {
    to.insert(to.end(), from.begin(), from.end());
  };
  for (std::size_t r = 0; r < report.records.size(); ++r) {
    const loop::Record& record = report.records[r].record;
    file.insert(file.end(), record.size(), static_cast<double>(r + 1));
    append(time, record.time);
    append(displacement, record.displacement);
    append(force, record.force);
    const identification::RecordFit& fit = report.fit.records[r];
    append(fitted, is_of_force ? fit.fitted_force : fit.fitted_displacement);
    append(residual, report.fit.records[r].residual);
  }
  const bool timed = std::ranges::none_of(
      report.records, [](const io::RecordFile& input) { return input.record.time.empty(); });
  std::vector<io::CsvColumn> columns;
  if (report.records.size() > 1) columns.push_back({"file", file});
  if (timed) columns.push_back({"time [s]", time});
  columns.push_back({WithUnit("displacement", report.units.displacement), displacement});
  columns.push_back({WithUnit("force", report.units.force), force});
  columns.push_back(
      {WithUnit(is_of_force ? "fitted_force" : "fitted_displacement", report.units.response),
       fitted});
  columns.push_back({WithUnit("residual", report.units.response), residual});
  return io::CsvText(columns);
}

using identification::BackboneEstimate;
using identification::BackbonePoint;
using identification::BandValue;

namespace {

std::string WithBand(const BandValue& value, std::string_view unit) {
  const ScaledUnit scaled = UnitFor(unit, value.value);
  return fmt::format("{} ({:.4g} … {:.4g})", Quantity(value.value, unit, 4),
                     value.lower95 / scaled.factor, value.upper95 / scaled.factor);
}

/// Returns "sigma = 40 N/µm, alpha = 0.333" of what the fit knows.
std::string FittedLawText(const identification::FitResult& fit, const Units& units) {
  std::vector<std::string> known;
  const auto add = [&](std::string_view name, double value, std::string_view unit, int digits) {
    if (!fit.Find(name)->is_known()) return;
    known.push_back(fmt::format("{} = {}", name, Quantity(value, unit, digits)));
  };
  add("sigma", fit.law.tangential_stiffness, units.stiffness, 4);
  add("alpha", fit.law.shape_exponent, "-", 3);
  add("slip_force", fit.law.slip_force, units.force, 4);
  return known.empty() ? "nothing of it is identified" : fmt::format("{}", fmt::join(known, ", "));
}

bool LeavesBand(const BackbonePoint& point) {
  return point.law < point.force.lower95 || point.law > point.force.upper95;
}

bool IsDenied(const identification::FitResult& fit) {
  using identification::MemoryVerdict;
  return fit.memory && (fit.memory->verdict == MemoryVerdict::kDahl ||
                        fit.memory->verdict == MemoryVerdict::kNeither);
}

}  // namespace

std::string BackboneCsv(const BackboneEstimate& backbone, const Units& units) {
  const auto column = [&](auto get) {
    std::vector<double> values;
    values.reserve(backbone.points.size());
    for (const BackbonePoint& point : backbone.points) values.push_back(get(point));
    return values;
  };
  const auto displacement = column([](const BackbonePoint& at) { return at.displacement; });
  const auto force = column([](const BackbonePoint& at) { return at.force.value; });
  const auto lower = column([](const BackbonePoint& at) { return at.force.lower95; });
  const auto upper = column([](const BackbonePoint& at) { return at.force.upper95; });
  const auto law = column([](const BackbonePoint& at) { return at.law; });
  return io::CsvText({{WithUnit("displacement", units.displacement), displacement},
                      {WithUnit("force", units.force), force},
                      {WithUnit("lower95", units.force), lower},
                      {WithUnit("upper95", units.force), upper},
                      {WithUnit("law", units.force), law}});
}

std::string BackboneText(const BackboneEstimate& backbone, const identification::FitResult& fit,
                         const Units& units) {
  const BackbonePoint& last = backbone.points.back();
  std::string text = fmt::format(
      "\nbackbone without a law ({} band):\n"
      "  stiffness over the first hundredth {}\n"
      "  force at {}: {}\n"
      "  what does not slip there: {}\n"
      "  {} beside it: {}\n",
      ConfidenceWords(fit), WithBand(backbone.first_stiffness, units.stiffness),
      Quantity(last.displacement, units.displacement, 4), WithBand(last.force, units.force),
      WithBand(backbone.elastic, units.stiffness), fit.model->name, FittedLawText(fit, units));
  const auto left = std::ranges::count_if(backbone.points, LeavesBand);
  text += left == 0 ? std::string("  the law keeps to the band\n")
                    : fmt::format("  the law leaves the band at {} of {} displacements\n", left,
                                  backbone.points.size());
  if (backbone.reaches_plateau) {
    text += "  it levels off within the record\n";
  } else if (fit.PeakForce() < fit.law.slip_force) {
    text += "  it does not level off within the record: slip_force is the law's extrapolation\n";
  } else {
    text += "  it goes on rising where the law slips\n";
  }
  if (IsDenied(fit)) {
    text +=
        "  but the record is not of Masing's memory (above): its branches are no copies of one\n"
        "  backbone, and the band says nothing of that\n";
  }
  if (fit.adequacy.verdict == identification::AdequacyVerdict::kInadequate) {
    text += "  but the fit, whose past and offsets this takes, is inadequate (above)\n";
  }
  return text;
}

}  // namespace mindahl::report
