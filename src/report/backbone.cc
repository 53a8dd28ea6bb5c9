#include "mindahl/report/backbone.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <string_view>
#include <vector>

#include "mindahl/io/csv_writer.h"
#include "mindahl/report/quantity.h"
#include "report/names.h"

namespace mindahl::report {

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
  const auto named = [](std::string_view name, std::string_view unit) {
    return fmt::format("{} [{}]", name, unit);
  };
  return io::CsvText({{named("displacement", units.displacement), displacement},
                      {named("force", units.force), force},
                      {named("lower95", units.force), lower},
                      {named("upper95", units.force), upper},
                      {named("law", units.force), law}});
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
