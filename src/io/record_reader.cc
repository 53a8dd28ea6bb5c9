#include "mindahl/io/record_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "io/roles.h"
#include "io/source.h"

namespace mindahl::io {
namespace {

/// Refuses numbers of a register whose bit 1024 is a sign: none lies in the upper half of those
/// below it, and there are some on both sides.
void RequireNoSignBit(const CsvTable& table, const Quantity& quantity) {
  constexpr double kBit = 1024.0;
  const std::size_t column = quantity.first_column();
  const Column& of = table.columns[column];
  if (of.least < 0 || of.least >= kBit || of.greatest < kBit || of.greatest >= 2 * kBit) return;
  double below = 0.0;
  for (const double value : of.values) {
    if (std::isfinite(value) && value != std::floor(value)) return;
    if (value < kBit) below = std::max(below, value);
  }
  if (below >= kBit / 2) return;
  Refuse(
      "{}: {} holds no value between {} and {}, as a register whose bit {} is the sign of the {}: "
      "write signed numbers",
      table.Header(), table.Label(column), below, kBit - 1, kBit, RulesOf(quantity.role).name);
}

}  // namespace

std::string LeftOutRows::InWords() const {
  return fmt::format("{} row{} left out, the first: {}", count, count > 1 ? "s are" : " is", fault);
}

/// Turns the rows of tables into samples of a record.
class RecordBuilder {
 public:
  /// Assigns the columns, by the rows that the table has.
  RecordBuilder(const CsvTable& table, const RecordColumns& asked)
      : skip_broken_(asked.skip_broken_rows) {
    const std::optional<double>& rate = asked.sample_rate;
    if (rate && (!(*rate > 0) || !std::isfinite(*rate) || !asked.time.empty())) {
      Refuse("{}: --sample-rate {}: must be finite and > 0 Hz, and --time excludes it", table.file,
             *rate);
    }
    file_.name = table.file;
    file_.notes = table.notes;
    quantities_ = AssignRoles(table, asked, file_.notes);
    for (const Quantity& quantity : quantities_) {
      const RoleRules& role = RulesOf(quantity.role);
      const std::size_t first = quantity.first_column();
      const bool is_plain = quantity.is_plain();
      if (is_plain && quantity.role <= Role::kForce) RequireNoSignBit(table, quantity);
      for (const auto& [column, weight] : quantity.terms) {
        wanted_.push_back(column);
        if (table.columns[column].values.empty()) static_cast<void>(table.Numbers(column));
      }
      file_.*role.chosen = {.name = is_plain ? table.columns[first].header : asked.*role.given,
                            .index = first + 1,
                            .unit = quantity.unit.symbol,
                            .has_no_unit = quantity.has_no_unit};
    }
    file_.is_torsional = quantities_.front().unit.dimension == Dimension::kAngle;
    if (!file_.time) interval_ = rate ? 1.0 / *rate : table.interval;
  }

  /// Returns the columns, units, notes and the rows left out so far, without samples.
  [[nodiscard]] RecordFile& file() { return file_; }
  /// Returns the columns that are used, from 0.
  [[nodiscard]] const std::vector<std::size_t>& wanted() const { return wanted_; }

  /// Fills empty samples with the rows of a table, up to one that is refused; rows without a number
  /// in a column that is used are left out: one in a hundred, or all where broken rows are skipped.
  /// @returns the fault of that row, or of too many that are left out; "" where there is none
  std::string Fill(Samples& samples, const CsvTable& table) {
    const auto resize = [&](std::size_t size) {
      for (const Quantity& of : quantities_) (samples.*RulesOf(of.role).values).resize(size);
    };
    resize(table.rows());
    LeftOutRows& left_out = file_.left_out;
    std::string refusal;
    for (std::size_t row = 0; row < table.rows() && refusal.empty(); ++row, ++rows_) {
      const std::size_t kept = samples.lines.size();
      bool is_whole = true;
      for (const Quantity& of : quantities_) {
        double& value = (samples.*RulesOf(of.role).values)[kept];
        value = of.unit.ToSi(of.ValueIn(table, row));
        is_whole = is_whole && std::isfinite(value);
      }
      if (is_whole && (!file_.time || samples.time[kept] >= last_time_)) {
        if (file_.time) last_time_ = samples.time[kept];
        if (interval_ > 0) samples.time.push_back(static_cast<double>(rows_) * interval_);
        samples.lines.push_back(table.lines[row]);
        continue;
      }
      bool is_missing = false;
      const std::string fault = FaultOf(table, row, is_whole, is_missing);
      if (!is_missing && !skip_broken_) {
        refusal = fault;
      } else if (left_out.count++ == 0) {
        left_out.fault = fault;
      }
    }
    resize(samples.lines.size());
    // One in a hundred, rounded up from a hundred on.
    constexpr std::size_t kOneIn = 100;
    const std::size_t most = rows_ < kOneIn ? 0 : (rows_ + kOneIn - 1) / kOneIn;
    if (!refusal.empty() || skip_broken_ || left_out.count <= most) return refusal;
    return fmt::format("{}; {} of {} rows are so: --broken-rows skip leaves them out",
                       left_out.fault, left_out.count, rows_);
  }

 private:
  /// Describes what is wrong with a row; of cells, the first of their column that are at fault so.
  std::string FaultOf(const CsvTable& table, std::size_t row, bool is_whole,
                      bool& is_missing) const {
    for (const std::size_t column : wanted_) {
      const Column& of = table.columns[column];
      if (std::isfinite(of.values[row])) continue;
      is_missing = std::isnan(of.values[row]);
      return is_missing ? of.missing : of.broken;
    }
    return fmt::format("{}:{}: has a {}", table.file, table.lines[row],
                       is_whole ? "time before that of the row above: sort the rows, split the "
                                  "file where a clock starts again, or give --sample-rate"
                                : "number that is too large in SI units");
  }

  RecordFile file_;
  std::vector<Quantity> quantities_;
  std::vector<std::size_t> wanted_;
  bool skip_broken_;
  std::size_t rows_ = 0;   // seen so far
  double interval_ = 0.0;  // [s] between rows, in place of a column of times
  double last_time_ = -std::numeric_limits<double>::infinity();  // [s]
};

namespace {

/// Reads the columns that were chosen, then others that have a number in every row and change.
void AddCovariates(const CsvTable& table, const std::vector<std::string>& asked, RecordFile& file) {
  std::vector<bool> is_read(table.columns.size() + 1);  // by the number from 1
  const auto add = [&](std::size_t column, const std::string& name, bool may_be_constant) {
    const std::vector<double>& all = table.columns[column].values;
    std::vector<double> values;
    for (std::size_t row = 0; row < all.size() && values.size() < file.lines.size(); ++row) {
      if (table.lines[row] == file.lines[values.size()]) values.push_back(all[row]);
    }
    const bool changes = std::ranges::adjacent_find(values, std::not_equal_to<>()) != values.end();
    const bool is_whole =
        std::ranges::all_of(values, [](double value) { return std::isfinite(value); });
    if (values.empty() || !is_whole || (!changes && !may_be_constant)) return false;
    const std::string& unit = table.columns[column].unit;
    file.record.covariates.push_back(
        {.name = name, .unit = unit == kRatioUnit ? "" : unit, .values = std::move(values)});
    is_read[column + 1] = true;
    return true;
  };
  is_read[file.displacement.index] = is_read[file.force.index] = true;
  for (const std::string& choice : asked) {
    const std::size_t column = ReadCovariate(choice, table);
    if (is_read[column + 1]) {
      Refuse("{}: {} is used already: choose another column for the covariate", table.file,
             table.Label(column));
    }
    if (!add(column, choice, true)) static_cast<void>(table.Numbers(column));  // throws
  }
  is_read[file.time.index] = is_read[file.normal_load.index] = true;
  for (std::size_t column = 0; column < table.columns.size(); ++column) {
    const std::string& name = table.columns[column].name;
    const bool is_one =
        !name.empty() && std::ranges::count(table.columns, name, &Column::name) == 1;
    if (is_read[column + 1] || table.columns[column].is_clock) continue;
    if (file.record.covariates.size() == asked.size() + kMostOtherColumns) return;
    add(column, is_one ? name : std::to_string(column + 1), false);
  }
}

/// Appends the columns of another file of the same test, row by row.
void AddColumnsOf(CsvTable& table, const CsvTable& other) {
  if (table.rows() != other.rows()) {
    Refuse("--with: {} has {} rows and {} {}: give files of as many rows, at the same times",
           table.file, table.rows(), other.file, other.rows());
  }
  const auto time = BestTime(table);
  const auto its_time = BestTime(other);
  if (time && its_time && table.columns[*time].values != other.columns[*its_time].values) {
    Refuse("--with: {} and {} have different times: give the values of one at those of the other",
           table.file, other.file);
  }
  table.columns.insert(table.columns.end(), other.columns.begin(), other.columns.end());
  table.notes.insert(table.notes.end(), other.notes.begin(), other.notes.end());
  Observe(table.columns);
}

RecordFile RecordIn(const CsvTable& table, const RecordColumns& asked) {
  RecordBuilder builder(table, asked);
  Samples samples;
  std::string fault = builder.Fill(samples, table);
  RecordFile& file = builder.file();
  if (fault.empty() && samples.lines.empty()) fault = file.left_out.fault;
  if (!fault.empty()) throw InputError(fault);
  if (file.left_out.count > 0) file.notes.push_back(file.left_out.InWords());
  file.lines = std::move(samples.lines);
  file.record = std::move(samples);
  AddCovariates(table, asked.covariates, file);
  return std::move(file);
}

}  // namespace

RecordFile ReadRecord(const std::filesystem::path& path, const RecordColumns& asked) {
  CsvTable table = ReadCsvTable(path, asked.encoding);
  if (!asked.with.empty()) AddColumnsOf(table, ReadCsvTable(asked.with, asked.encoding));
  RecordFile file = RecordIn(table, asked);
  file.name = path.string();
  return file;
}

RecordFile RecordOf(const std::vector<CsvColumn>& columns, std::string source,
                    const RecordColumns& asked) {
  if (columns.empty() || columns.front().values.empty()) {
    Refuse("{}: there is no {}", source, columns.empty() ? "column" : "row");
  }
  CsvTable table{.file = std::move(source), .header_line = 1};
  table.lines.resize(columns.front().values.size());
  std::iota(table.lines.begin(), table.lines.end(), std::size_t{1});
  for (const auto& [name, values] : columns) {
    if (values.size() != table.rows()) {
      Refuse("{}: '{}' has {} rows and '{}' {}: give as many of both", table.file,
             columns.front().name, table.rows(), name, values.size());
    }
    Column& added = table.columns.emplace_back(ReadName(name));
    if (std::ranges::all_of(values, [](double value) { return std::isnan(value); })) continue;
    added.values.assign(values.begin(), values.end());
    for (std::size_t row = 0; row < values.size(); ++row) {
      std::string& said = std::isnan(values[row]) ? added.missing : added.broken;
      if (std::isfinite(values[row]) || !said.empty()) continue;
      said = fmt::format("{}:{}:{}: holds no number", table.file, row + 1, table.columns.size());
    }
  }
  Observe(table.columns);
  return RecordIn(table, asked);
}

std::vector<double> ImposedDisplacement(const std::filesystem::path& path,
                                        const std::string& column) {
  const CsvTable table = ReadCsvTable(path);
  const Quantity displacement = ReadImposed(column, table);
  for (const auto& term : displacement.terms) static_cast<void>(table.Numbers(term.column));
  std::vector<double> values(table.rows());
  for (std::size_t row = 0; row < values.size(); ++row) {
    values[row] = displacement.unit.ToSi(displacement.ValueIn(table, row));
  }
  return values;
}

struct RecordStream::State {
  State(const std::filesystem::path& path, const RecordColumns& asked)
      : reader(path, asked.encoding), builder(FirstRows(), asked) {
    if (asked.with.empty()) return;
    Refuse("--with: a record that is read in pieces is of one file: join them before");
  }

  /// Reads the rows by which the content of the columns is judged; Next() judges the rows.
  const CsvTable& FirstRows() {
    reader.Read();
    Observe(reader.table().columns);
    return reader.table();
  }

  TableReader reader;
  RecordBuilder builder;
  bool has_rows = true;  // that are no samples yet
  std::string refusal;   // of a row that is reached next
};

RecordStream::RecordStream(const std::filesystem::path& path, const RecordColumns& asked)
    : state_(std::make_shared<State>(path, asked)) {}

const RecordFile& RecordStream::layout() const { return state_->builder.file(); }

bool RecordStream::Next(Samples& samples) {
  auto& [reader, builder, has_rows, refusal] = *state_;
  samples = {};
  while (samples.lines.empty()) {
    if (!refusal.empty()) throw InputError(refusal);
    const bool goes_on = std::exchange(has_rows, false) || reader.Read();
    refusal = builder.Fill(samples, reader.table());
    reader.KeepColumns(builder.wanted());
    if (!goes_on && refusal.empty()) return false;
  }
  return true;
}

void KeepTimeWindow(RecordFile& input, double first, double last) {
  const std::vector<double>& time = input.record.time;
  if (time.empty()) {
    Refuse("{}: a window of time needs a time: name its column with --time", input.name);
  }
  const auto begin = std::ranges::lower_bound(time, first);
  const auto end = std::ranges::upper_bound(time, last);
  if (begin >= end) {
    Refuse("{}: no sample lies in the window of time {}:{}: the record runs from {} to {} s",
           input.name, first, last, time.front(), time.back());
  }
  KeepSamples(input, static_cast<std::size_t>(begin - time.begin()),
              static_cast<std::size_t>(end - time.begin()));
}

void KeepSamples(RecordFile& input, std::size_t first, std::size_t last) {
  const auto keep = [first, last](auto& column) {
    if (column.empty()) return;
    column.resize(last);
    column.erase(column.begin(), column.begin() + static_cast<std::ptrdiff_t>(first));
  };
  for (const auto column : loop::kRecordColumns) keep(input.record.*column);
  for (loop::Covariate& covariate : input.record.covariates) keep(covariate.values);
  keep(input.lines);
}

}  // namespace mindahl::io
