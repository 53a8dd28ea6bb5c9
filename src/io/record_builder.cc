#include "io/record_builder.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "mindahl/core/error.h"

namespace mindahl::io {
namespace {

constexpr std::size_t kTimePlace = 2;

/// The unit that a time has without stating it: "millis", or that of a stamp since 1970.
std::string ImpliedTimeUnit(std::string_view word, double first) {
  if (word == "millis" || word == "msec") return "ms";
  if (word == "micros") return "us";
  if (word == "nanos") return "ns";
  constexpr std::array<std::pair<double, std::string_view>, 4> kScales = {
      {{1.0, "s"}, {1e3, "ms"}, {1e6, "us"}, {1e9, "ns"}}};
  constexpr double kFrom2001 = 1e9;  // [s] since 1970, to 2100
  constexpr double kTo2100 = 4.1e9;
  for (const auto& [scale, unit] : kScales) {
    if (first >= kFrom2001 * scale && first <= kTo2100 * scale) return std::string(unit);
  }
  return "";
}

/// Refuses numbers of a register whose highest bit is a sign: none lies in the upper half of those
/// below it, and there are some on both sides.
void RequireNoSignBit(const ColumnNames& names, std::size_t column, const RoleRules& rules) {
  const CsvTable& table = names.table();
  for (const double bit : {1024.0, 32768.0}) {
    double below = -1.0;
    double above = 0.0;
    bool is_register = true;
    for (const double value : table.columns[column].values) {
      if (std::isnan(value)) continue;
      is_register = is_register && value >= 0 && value < 2 * bit && value == std::floor(value);
      if (value < bit) below = std::max(below, value);
      if (value >= bit) above = std::max(above, value);
    }
    if (!is_register || below < 0 || above < bit || below >= bit / 2) continue;
    throw InputError(fmt::format(
        "{}: {} holds no value between {} and {}, as a register whose bit {} is the sign of the "
        "{}: "
        "write signed numbers, {} - value where the value is {} or more",
        names.Header(), names.Label(column), below, bit - 1, bit, rules.name, bit, bit));
  }
}

}  // namespace

RecordBuilder::RecordBuilder(const CsvTable& table, const RecordColumns& columns)
    : name_(table.file), last_time_(-std::numeric_limits<double>::infinity()) {
  if (columns.sample_rate) {
    if (!(*columns.sample_rate > 0) || !std::isfinite(*columns.sample_rate)) {
      throw InputError(
          fmt::format("--sample-rate {}: must be finite and > 0 Hz", *columns.sample_rate));
    }
    if (!columns.time.empty()) {
      throw InputError(fmt::format("{}: --time and --sample-rate exclude each other", name_));
    }
  }
  file_.notes = table.notes;
  const ColumnNames names(table);
  Roles roles = AssignRoles(names, columns, file_.notes);
  file_.is_torsional = roles.is_torsional;
  Add(names, Role::kDisplacement, std::move(roles.displacement), columns.displacement,
      file_.displacement);
  Add(names, Role::kForce, std::move(roles.force), columns.force, file_.force);
  if (!roles.time.terms.empty()) AddTime(names, roles.time, columns.time);
  if (!roles.normal_load.terms.empty()) {
    Add(names, Role::kNormalLoad, std::move(roles.normal_load), columns.normal_load,
        file_.normal_load.emplace());
  }
  if (file_.time) return;
  interval_ = columns.sample_rate ? 1.0 / *columns.sample_rate : table.interval;
  if (table.interval > 0 && !columns.sample_rate) {
    file_.notes.push_back(
        fmt::format("{}: has no time: its header states {} s between rows", name_, table.interval));
  }
}

void RecordBuilder::Add(const ColumnNames& names, Role role, Expression columns,
                        const std::string& text, ChosenColumn& described) {
  const RoleRules& rules = RulesOf(role, file_.is_torsional);
  const Unit unit = FindUnit(names, rules, columns, file_.notes);
  const std::size_t first = columns.terms.front().column;
  if (columns.is_plain() && (role == Role::kDisplacement || role == Role::kForce)) {
    RequireNoSignBit(names, first, rules);
  }
  described = {.name = columns.is_plain() ? names.table().columns[first].name : text,
               .index = first + 1,
               .unit = unit.symbol};
  for (Expression::Term& term : columns.terms) {
    auto place = std::ranges::find(wanted_, term.column);
    if (place == wanted_.end()) place = wanted_.insert(wanted_.end(), term.column);
    term.column = static_cast<std::size_t>(place - wanted_.begin());
  }
  const std::size_t place = role == Role::kNormalLoad ? 3 : static_cast<std::size_t>(role);
  channels_.push_back({place, std::move(columns), unit, rules.name});
}

void RecordBuilder::AddTime(const ColumnNames& names, const Expression& given,
                            const std::string& text) {
  Expression columns = given;
  const std::size_t first = columns.terms.front().column;
  const TableColumn& column = names.table().columns[first];
  const auto number =
      std::ranges::find_if(column.values, [](double value) { return !std::isnan(value); });
  const double start = number == column.values.end() ? 0.0 : *number;
  const auto note = [&](std::string_view what) {
    file_.notes.push_back(fmt::format("{}: time {} {}", name_, names.Label(first), what));
  };
  if (column.is_clock) {
    constexpr double kDay = 86'400.0;
    columns.unit = "s";
    time_origin_ = kDay * std::floor(start / kDay);
    note("holds times of day: taken as seconds since midnight of the first one's day");
  } else if (columns.is_plain() && !names.UnitOf(first, "--time").empty()) {
    const auto unit = TimeUnit(names.UnitOf(first, "--time"));
    if (unit && ImpliedTimeUnit("", start) == unit->symbol) time_origin_ = start;
  } else if (columns.unit.empty() && columns.is_plain()) {
    const std::string_view word = EvidenceOf(names.split(first).name).word;
    columns.unit = ImpliedTimeUnit(word, start);
    if (columns.unit.empty()) {
      columns.unit = "s";
      note(fmt::format("names no unit: taken as s; --time '{} [s]' says so", first + 1));
    } else if (ImpliedTimeUnit("", start) == columns.unit) {
      time_origin_ = start;
      note(fmt::format("holds stamps since 1970 in {}: taken as seconds since the first",
                       columns.unit));
    } else {
      note(fmt::format("names no unit: taken as {}", columns.unit));
    }
  }
  Add(names, Role::kTime, std::move(columns), text, file_.time.emplace());
  file_.time->is_clock = column.is_clock;
}

std::string RecordBuilder::Convert(std::span<const double> cells, std::size_t line, std::size_t row,
                                   bool begins_block, RowValues& values) {
  for (const Channel& channel : channels_) {
    double value = channel.sum.offset;
    for (const Expression::Term& term : channel.sum.terms)
      value += term.weight * cells[term.column];
    const auto at = [&] {
      return fmt::format("{}:{}:{}", name_, line, wanted_[channel.sum.terms.front().column] + 1);
    };
    if (channel.place == kTimePlace) {
      value -= time_origin_;
      if (begins_block && value + shift_ < last_time_) shift_ = last_time_ + last_step_ - value;
      value += shift_;
      const double above = std::exchange(last_time_, value);
      if (value < above) {
        return fmt::format(
            "{}: time = {} {} is before the {} {} of the row above: times must not fall; sort the "
            "rows, split the file where a clock starts again, or rename the column if it holds no "
            "time",
            at(), value, channel.unit.symbol, above, channel.unit.symbol);
      }
      if (std::isfinite(above)) last_step_ = value - above;
    }
    values[channel.place] = channel.unit.ToSi(value);
    if (!std::isfinite(values[channel.place])) {
      return fmt::format("{}: {} = {} {} is too large: must be below 1.8e308 in SI units", at(),
                         channel.name, value, channel.unit.symbol);
    }
  }
  if (!file_.time && interval_ > 0) values[kTimePlace] = static_cast<double>(row) * interval_;
  return "";
}

void MissingRows::Count(std::size_t line, const std::string& fault) {
  if (rows.count++ > 0) return;
  rows.first_line = line;
  first = fault;
}

void MissingRows::RequireFew(std::size_t of_rows) const {
  // One in a hundred, rounded up from a hundred on.
  constexpr std::size_t kOneIn = 100;
  const std::size_t most = of_rows < kOneIn ? 0 : (of_rows + kOneIn - 1) / kOneIn;
  if (rows.count <= most) return;
  throw InputError(fmt::format("{}; {} of {} rows are so: --broken-rows skip leaves them out",
                               first, rows.count, of_rows));
}

}  // namespace mindahl::io
