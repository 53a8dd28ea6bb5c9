#include "io/record_builder.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "mindahl/core/error.h"

namespace mindahl::io {
namespace {

/// The unit that a time has without stating it: "millis", or that of a stamp since 1970.
std::string ImpliedTimeUnit(std::string_view word, double first) {
  if (word == "ms" || word == "millis" || word == "msec") return "ms";
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

std::vector<double>& ColumnOf(Samples& samples, Role role) {
  return role == Role::kDisplacement ? samples.displacement
         : role == Role::kForce      ? samples.force
         : role == Role::kTime       ? samples.time
                                     : samples.normal_load;
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
    : name_(table.file), skip_broken_(columns.skip_broken_rows) {
  const std::optional<double>& rate = columns.sample_rate;
  if (rate && (!(*rate > 0) || !std::isfinite(*rate))) {
    throw InputError(fmt::format("--sample-rate {}: must be finite and > 0 Hz", *rate));
  }
  if (rate && !columns.time.empty()) {
    throw InputError(fmt::format("{}: --time and --sample-rate exclude each other", name_));
  }
  file_.notes = table.notes;
  const ColumnNames names(table);
  Roles roles = AssignRoles(names, columns, file_.notes);
  file_.is_torsional = roles.is_torsional;
  Choose(names, Role::kDisplacement, std::move(roles.displacement), columns.displacement,
         file_.displacement);
  Choose(names, Role::kForce, std::move(roles.force), columns.force, file_.force);
  if (!roles.time.terms.empty()) ChooseTime(names, roles.time, columns.time);
  if (!roles.normal_load.terms.empty()) {
    Choose(names, Role::kNormalLoad, std::move(roles.normal_load), columns.normal_load,
           file_.normal_load.emplace());
  }
  if (file_.time) return;
  interval_ = rate ? 1.0 / *rate : table.interval;
  if (table.interval > 0 && !rate) {
    file_.notes.push_back(
        fmt::format("{}: has no time: its header states {} s between rows", name_, table.interval));
  }
}

void RecordBuilder::Choose(const ColumnNames& names, Role role, Expression columns,
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
  for (const Expression::Term& term : columns.terms) {
    if (names.table().columns[term.column].values.empty()) {
      static_cast<void>(names.table().Numbers(term.column));  // throws
    }
    if (std::ranges::find(wanted_, term.column) == wanted_.end()) wanted_.push_back(term.column);
  }
  channels_.push_back({role, std::move(columns), unit, rules.name});
}

void RecordBuilder::ChooseTime(const ColumnNames& names, const Expression& given,
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
    const std::string_view word = names[first].name.evidence.word;
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
  Choose(names, Role::kTime, std::move(columns), text, file_.time.emplace());
  file_.time->is_clock = column.is_clock;
}

double RecordBuilder::Channel::ValueAt(const CsvTable& table, std::size_t row) const {
  double value = sum.offset;
  for (const Expression::Term& term : sum.terms) {
    value += term.weight * table.columns[term.column].values[row];
  }
  return value;
}

std::string RecordBuilder::Add(const CsvTable& table, Samples& samples) {
  const std::size_t rows = table.rows();
  Channel* time = nullptr;
  for (Channel& channel : channels_) {
    channel.values = table.columns[channel.sum.terms.front().column].values;
    if (!channel.sum.is_plain()) {
      for (std::size_t row = 0; row < rows; ++row)
        channel.values[row] = channel.ValueAt(table, row);
    }
    if (channel.role == Role::kTime) {
      time = &channel;
    } else {
      for (double& value : channel.values) value = channel.unit.ToSi(value);
    }
  }
  auto block = table.blocks.begin();
  std::string refusal;
  std::size_t kept = 0;
  for (std::size_t row = 0; row < rows; ++row, ++rows_) {
    if (block != table.blocks.end() && row == *block) {
      begins_block_ = true;
      ++block;
    }
    bool is_whole = true;
    for (const Channel& channel : channels_) {
      is_whole = is_whole && std::isfinite(channel.values[row]);
    }
    if (!is_whole || (time != nullptr && !Follows(*time, row))) {
      bool is_missing = false;
      std::string fault = FaultOf(table, row, is_missing);
      if (!is_missing && !skip_broken_) {
        refusal = std::move(fault);
        break;
      }
      left_out_.Add(table.lines[row], fault);
      continue;
    }
    begins_block_ = false;
    if (kept < row) {
      for (Channel& channel : channels_) channel.values[kept] = channel.values[row];
    }
    ++kept;
    if (time == nullptr && interval_ > 0) {
      samples.time.push_back(static_cast<double>(rows_) * interval_);
    }
    samples.lines.push_back(table.lines[row]);
  }
  for (const Channel& channel : channels_) {
    std::vector<double>& to = ColumnOf(samples, channel.role);
    const auto end = channel.values.begin() + static_cast<std::ptrdiff_t>(kept);
    to.insert(to.end(), channel.values.begin(), end);
  }
  return refusal;
}

/// Converts a time.
/// @returns false where it is before the last
bool RecordBuilder::Follows(Channel& time, std::size_t row) {
  double& value = time.values[row];
  value -= time_origin_;
  if (begins_block_ && value + shift_ < last_time_) shift_ = last_time_ + last_step_ - value;
  value += shift_;
  time_above_ = std::exchange(last_time_, value);
  if (value < time_above_) return false;
  if (std::isfinite(time_above_)) last_step_ = value - time_above_;
  value = time.unit.ToSi(value);
  return std::isfinite(value);
}

/// Describes what is wrong with a row.
std::string RecordBuilder::FaultOf(const CsvTable& table, std::size_t row, bool& is_missing) const {
  for (const Channel& channel : channels_) {
    for (const Expression::Term& term : channel.sum.terms) {
      const TableColumn& column = table.columns[term.column];
      if (!std::isnan(column.values[row])) continue;
      is_missing = column.fault.empty() || column.fault_row != row;
      return is_missing && !column.missing.empty() ? column.missing : column.fault;
    }
  }
  for (const Channel& channel : channels_) {
    const std::string at =
        fmt::format("{}:{}:{}", name_, table.lines[row], channel.sum.terms.front().column + 1);
    const double value = channel.ValueAt(table, row);
    if (!std::isfinite(channel.unit.ToSi(value))) {
      return fmt::format("{}: {} = {} {} is too large: must be below 1.8e308 in SI units", at,
                         channel.name, value, channel.unit.symbol);
    }
    if (channel.role != Role::kTime || !(last_time_ < time_above_)) continue;
    return fmt::format(
        "{}: time = {} {} is before the {} {} of the row above: times must not fall; sort the "
        "rows, split the file where a clock starts again, or rename the column if it holds no "
        "time",
        at, last_time_, channel.unit.symbol, time_above_, channel.unit.symbol);
  }
  return "";
}

std::string RecordBuilder::TooManyLeftOut() const {
  // One in a hundred, rounded up from a hundred on.
  constexpr std::size_t kOneIn = 100;
  const std::size_t most = rows_ < kOneIn ? 0 : (rows_ + kOneIn - 1) / kOneIn;
  if (skip_broken_ || left_out_.count <= most) return "";
  return fmt::format("{}; {} of {} rows are so: --broken-rows skip leaves them out",
                     left_out_.fault, left_out_.count, rows_);
}

}  // namespace mindahl::io
