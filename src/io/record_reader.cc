#include "mindahl/io/record_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <utility>

#include "io/roles.h"
#include "io/table_reader.h"
#include "mindahl/io/csv_table.h"

namespace mindahl::io {
namespace {

bool IsNumber(double value) { return std::isfinite(value); }

/// Refuses numbers of a register whose bit 1024 is a sign: none lies in the upper half of those
/// below it, and there are some on both sides.
void RequireNoSignBit(const ColumnNames& names, const Quantity& quantity) {
  constexpr double kBit = 1024.0;
  const std::size_t column = quantity.first_column();
  double below = -1.0;
  double above = 0.0;
  for (const double value : names.table().columns[column].values) {
    if (!IsNumber(value)) continue;
    if (value < 0 || value >= 2 * kBit || value != std::floor(value)) return;
    double& greatest = value < kBit ? below : above;
    greatest = std::max(greatest, value);
  }
  if (below < 0 || above < kBit || below >= kBit / 2) return;
  Refuse(
      "{}: {} holds no value between {} and {}, as a register whose bit {} is the sign of the {}: "
      "write signed numbers, {} - value where the value is {} or more",
      names.Header(), names.Label(column), below, kBit - 1, kBit, RulesOf(quantity.role).name, kBit,
      kBit);
}

}  // namespace

/// Turns the rows of tables into samples of a record.
class RecordBuilder {
 public:
  /// Assigns the columns, by the rows that the table has.
  RecordBuilder(const ColumnNames& names, const RecordColumns& asked)
      : skip_broken_(asked.skip_broken_rows) {
    const CsvTable& table = names.table();
    const std::optional<double>& rate = asked.sample_rate;
    if (rate && (!(*rate > 0) || !std::isfinite(*rate))) {
      Refuse("--sample-rate {}: must be finite and > 0 Hz", *rate);
    }
    if (rate && !asked.time.empty()) {
      Refuse("{}: --time and --sample-rate exclude each other", table.file);
    }
    file_.name = table.file;
    file_.notes = table.notes;
    for (Quantity& quantity : AssignRoles(names, asked, file_.notes)) {
      const RoleRules& role = RulesOf(quantity.role);
      file_.*role.chosen = Choose(names, quantity, asked.*role.given);
      quantities_.push_back(std::move(quantity));
    }
    file_.is_torsional = quantities_.front().unit.dimension == Dimension::kAngle;
    if (file_.time) return;
    interval_ = rate ? 1.0 / *rate : table.interval;
    if (table.interval > 0 && !rate) {
      file_.notes.push_back(fmt::format("{}: has no time: its header states {} s between rows",
                                        table.file, table.interval));
    }
  }

  /// Returns the columns, units, notes and the rows left out so far, without samples.
  [[nodiscard]] RecordFile& file() { return file_; }
  /// Returns the columns that are used, from 0, each once.
  [[nodiscard]] const std::vector<std::size_t>& wanted() const { return wanted_; }

  /// Appends the rows of a table, up to one that is refused; those without a number in a column
  /// that is used are left out, up to one in a hundred, or all where broken rows are skipped.
  /// @returns the fault of that row, or of too many that are left out; "" where there is none
  std::string Add(const CsvTable& table, Samples& samples) {
    std::vector<std::vector<double>*> columns;  // of the quantities
    columns.reserve(quantities_.size());
    for (const Quantity& quantity : quantities_) {
      columns.push_back(&(samples.*RulesOf(quantity.role).values));
    }
    const bool has_interval = !file_.time && interval_ > 0;
    const auto resize = [&](std::size_t size) {
      samples.lines.resize(size);
      if (has_interval) samples.time.resize(size);
      for (std::vector<double>* column : columns) column->resize(size);
    };
    std::size_t kept = samples.lines.size();
    resize(kept + table.rows());
    LeftOutRows& left_out = file_.left_out;
    std::string refusal;
    auto block = table.blocks.begin();
    for (std::size_t row = 0; row < table.rows() && refusal.empty(); ++row, ++rows_) {
      if (block != table.blocks.end() && row == *block) {
        times_.NextPiece();
        ++block;
      }
      bool is_whole = true;
      for (std::size_t k = 0; k < columns.size(); ++k) {
        const Quantity& quantity = quantities_[k];
        double& value = (*columns[k])[kept];
        value = quantity.ValueIn(table, row);
        if (quantity.role != Role::kTime) value = quantity.unit.ToSi(value);
        is_whole = is_whole && std::isfinite(value);
      }
      if (is_whole && (!file_.time || Follows(samples.time[kept]))) {
        if (has_interval) samples.time[kept] = static_cast<double>(rows_) * interval_;
        samples.lines[kept++] = table.lines[row];
        continue;
      }
      bool is_missing = false;
      const std::string fault = FaultOf(table, row, is_missing);
      if (!is_missing && !skip_broken_) {
        refusal = fault;
      } else if (left_out.count++ == 0) {
        left_out.fault = fault;
      }
    }
    resize(kept);
    // One in a hundred, rounded up from a hundred on.
    constexpr std::size_t kOneIn = 100;
    const std::size_t most = rows_ < kOneIn ? 0 : (rows_ + kOneIn - 1) / kOneIn;
    if (!refusal.empty() || skip_broken_ || left_out.count <= most) return refusal;
    return fmt::format("{}; {} of {} rows are so: --broken-rows skip leaves them out",
                       left_out.fault, left_out.count, rows_);
  }

 private:
  /// @param text  by which it was chosen
  ChosenColumn Choose(const ColumnNames& names, const Quantity& quantity, const std::string& text) {
    const Role role = quantity.role;
    const bool is_plain = quantity.is_plain();
    const std::size_t first = quantity.first_column();
    if (is_plain && (role == Role::kDisplacement || role == Role::kForce)) {
      RequireNoSignBit(names, quantity);
    }
    const std::vector<TableColumn>& columns = names.table().columns;
    for (const Quantity::Term& term : quantity.terms) {
      if (columns[term.column].values.empty())
        static_cast<void>(names.table().Numbers(term.column));
      if (std::ranges::find(wanted_, term.column) == wanted_.end()) wanted_.push_back(term.column);
    }
    return {.name = is_plain ? columns[first].name : text,
            .index = first + 1,
            .unit = quantity.unit.symbol,
            .has_no_unit = quantity.has_no_unit};
  }

  /// Converts a time.
  /// @returns false where it is before the last
  bool Follows(double& time) {
    time = times_.Next(time);
    time_above_ = std::exchange(last_time_, time);
    if (time < time_above_) return false;
    time = quantities_[2].unit.ToSi(time);
    return std::isfinite(time);
  }

  /// Describes what is wrong with a row; of cells, the first of their column that are at fault so.
  std::string FaultOf(const CsvTable& table, std::size_t row, bool& is_missing) const {
    for (const std::size_t column : wanted_) {
      const TableColumn& of = table.columns[column];
      if (IsNumber(of.values[row])) continue;
      is_missing = std::isnan(of.values[row]);
      return is_missing ? of.missing : of.broken;
    }
    if (!file_.time || last_time_ >= time_above_) {
      return fmt::format("{}:{}: has a number that is too large in SI units", table.file,
                         table.lines[row]);
    }
    const Quantity& time = quantities_[2];
    return fmt::format(
        "{}:{}:{}: time = {} {} is before the {} {} of the row above: times must not fall; sort "
        "the "
        "rows, split the file where a clock starts again, or rename the column if it holds no time",
        table.file, table.lines[row], time.first_column() + 1, last_time_, time.unit.symbol,
        time_above_, time.unit.symbol);
  }

  RecordFile file_;
  std::vector<Quantity> quantities_;
  std::vector<std::size_t> wanted_;
  bool skip_broken_;
  std::size_t rows_ = 0;   // seen so far
  double interval_ = 0.0;  // [s] between rows, in place of a column of times
  JoinedTimes times_;      // of the blocks, in their unit
  double last_time_ = -std::numeric_limits<double>::infinity();
  double time_above_ = 0.0;  // the one before the last
};

namespace {

/// Reads the columns chosen in addition to displacement and force, then some of the others: those
/// with a number in every row, and not the same in all.
void AddCovariates(const ColumnNames& names, const std::vector<std::string>& choices,
                   RecordFile& file) {
  const CsvTable& table = names.table();
  std::vector<bool> is_read(names.size());
  const auto add = [&](std::size_t column, const std::string& name, bool may_be_constant) {
    const std::vector<double>& all = table.columns[column].values;
    std::vector<double> values;
    for (std::size_t row = 0; row < all.size() && values.size() < file.lines.size(); ++row) {
      if (table.lines[row] == file.lines[values.size()]) values.push_back(all[row]);
    }
    const bool changes = std::ranges::adjacent_find(values, std::not_equal_to<>()) != values.end();
    if (values.empty() || !std::ranges::all_of(values, IsNumber)) return false;
    if (!changes && !may_be_constant) return false;
    file.record.covariates.push_back(
        {.name = name, .unit = names.UnitOf(column, Role::kOther), .values = std::move(values)});
    is_read[column] = true;
    return true;
  };
  const auto mark = [&](const ChosenColumn& used) {
    if (used) is_read[used.index - 1] = true;
  };
  mark(file.displacement);
  mark(file.force);
  for (const std::string& choice : choices) {
    const std::size_t column = names.Chosen(choice, Role::kOther);
    if (is_read[column]) {
      Refuse("{}: {} is used already: choose another column for the covariate", table.file,
             names.Label(column));
    }
    if (!add(column, choice, true)) static_cast<void>(table.Numbers(column));  // throws
  }
  mark(file.time);
  mark(file.normal_load);
  const std::size_t most = choices.size() + kMostOtherColumns;
  for (std::size_t column = 0; column < names.size(); ++column) {
    if (is_read[column] || names[column].is_clock) continue;
    if (file.record.covariates.size() < most) add(column, names.NameOf(column), false);
  }
}

/// Returns the time of a table, by which another is joined to it, where it has one.
std::optional<Quantity> TimeOf(const CsvTable& table, const std::string& given) {
  const ColumnNames names(table);
  Quantity time = names.Read(given, Role::kTime);
  if (time.terms.empty()) {
    const std::optional<std::size_t> best = names.Best(Role::kTime);
    if (!best) return std::nullopt;
    time.terms = {{*best, 1.0}};
  }
  std::vector<std::string> notes;
  names.FindUnitOf(time, false, notes);
  return time;
}

/// Appends the columns of another file of the same test: at the times of the first, by straight
/// lines, where both have a time, else row by row.
void AddColumnsOf(CsvTable& table, const CsvTable& other, const std::string& given_time) {
  const auto time_of_table = TimeOf(table, given_time);
  const auto time_of_other = TimeOf(other, "");
  std::vector<double> times;
  if (time_of_table && time_of_other) times = time_of_other->Numbers(other);
  const bool by_time = !times.empty() && std::ranges::is_sorted(times);
  if (!by_time && table.rows() != other.rows()) {
    Refuse("--with: {} has {} rows and {} {}, and not both a time: give files of as many rows",
           table.file, table.rows(), other.file, other.rows());
  }
  for (const TableColumn& column : other.columns) {
    TableColumn& added = table.columns.emplace_back(column);
    if (!by_time || added.values.empty()) continue;
    added.values.clear();
    for (std::size_t row = 0; row < table.rows(); ++row) {
      const double time = time_of_table->unit.ToSi(time_of_table->ValueIn(table, row));
      const auto next = std::ranges::lower_bound(times, time);
      const auto k = static_cast<std::size_t>(next - times.begin());
      double& value = added.values.emplace_back();
      if (next != times.end() && *next == time) {
        value = column.values[k];
      } else if (k > 0 && next != times.end()) {
        value = std::lerp(column.values[k - 1], column.values[k],
                          (time - times[k - 1]) / (times[k] - times[k - 1]));
      } else {
        value = std::numeric_limits<double>::quiet_NaN();
        if (!added.missing.empty()) continue;
        added.missing = fmt::format("{}:{}: {} has no row at this time", table.file,
                                    table.lines[row], other.file);
      }
    }
  }
  table.notes.insert(table.notes.end(), other.notes.begin(), other.notes.end());
  table.notes.push_back(fmt::format("{}: its columns follow those of {}, {}", other.file,
                                    table.file, by_time ? "at its times" : "row by row"));
  table.header_line = std::max<std::size_t>(table.header_line, 1);
}

}  // namespace

RecordFile RecordOf(const CsvTable& table, const RecordColumns& columns) {
  const ColumnNames names(table);
  RecordBuilder builder(names, columns);
  Samples samples;
  std::string fault = builder.Add(table, samples);
  RecordFile& file = builder.file();
  if (fault.empty() && samples.lines.empty()) fault = file.left_out.fault;
  if (!fault.empty()) throw InputError(fault);
  if (file.left_out.count > 0) file.notes.push_back(file.left_out.InWords());
  file.lines = std::move(samples.lines);
  file.record = std::move(samples);
  AddCovariates(names, columns.covariates, file);
  return std::move(file);
}

RecordFile ReadRecord(const std::filesystem::path& path, const RecordColumns& columns) {
  CsvTable table = ReadCsvTable(path, columns.encoding);
  if (!columns.with.empty()) {
    AddColumnsOf(table, ReadCsvTable(columns.with, columns.encoding), columns.time);
  }
  RecordFile file = RecordOf(table, columns);
  file.name = path.string();
  return file;
}

std::vector<double> ImposedDisplacement(const std::filesystem::path& path,
                                        const std::string& column) {
  const CsvTable table = ReadCsvTable(path);
  const ColumnNames names(table);
  Quantity displacement = names.Read(column, Role::kDisplacement);
  if (displacement.terms.empty()) {
    const bool first_is_another = names.Best(Role::kTime) == 0U || names.Best(Role::kForce) == 0U;
    const auto best = first_is_another ? names.Best(Role::kDisplacement) : std::nullopt;
    displacement.terms = {{best.value_or(0), 1.0}};
  }
  const bool is_torsional =
      names[displacement.first_column()].IsAngular(displacement.given_unit) == true;
  std::vector<std::string> notes;  // SI is the documented default here
  names.FindUnitOf(displacement, is_torsional, notes);
  return displacement.Numbers(table);
}

struct RecordStream::State {
  State(const std::filesystem::path& path, const RecordColumns& columns)
      : pieces(path, columns.encoding),
        rows(pieces.Next()),
        layout(FindLayout(rows, NameOfInput(path))),
        builder(ColumnNames(FirstRows()), columns),
        reader(layout, builder.wanted()) {
    if (!columns.with.empty()) {
      Refuse("--with: a record that is read in pieces is of one file: join them before");
    }
    rows.remove_prefix(layout.data_offset);
    std::vector<std::string>& notes = builder.file().notes;
    if (!pieces.note().empty()) notes.insert(notes.begin(), pieces.note());
  }

  /// The table of the first rows, by which the content of the columns is judged: what becomes of
  /// those at fault is for Next() to say.
  CsvTable FirstRows() const {
    constexpr std::size_t kJudged = LinePieces::kPiece / 8;  // [bytes]
    TableReader first(layout);
    const std::string_view data = rows.substr(layout.data_offset);
    first.Read(data.substr(0, std::min(data.find('\n', kJudged), data.size() - 1) + 1));
    return std::move(first.table());
  }

  LinePieces pieces;
  std::string_view rows;  // of the first piece
  Layout layout;
  RecordBuilder builder;
  TableReader reader;
  std::string refusal;  // of a row that is reached next
};

RecordStream::RecordStream(const std::filesystem::path& path, const RecordColumns& columns)
    : state_(std::make_unique<State>(path, columns)) {}
RecordStream::~RecordStream() = default;

const RecordFile& RecordStream::layout() const { return state_->builder.file(); }

bool RecordStream::Next(Samples& samples) {
  auto& [pieces, rows, layout, builder, reader, refusal] = *state_;
  for (const auto column : loop::kRecordColumns) (samples.*column).clear();
  samples.lines.clear();
  while (samples.lines.empty()) {
    if (!refusal.empty()) throw InputError(refusal);
    const std::string_view text = rows.empty() ? pieces.Next() : std::exchange(rows, {});
    reader.Clear();
    reader.Read(text);
    if (text.empty()) reader.Finish();
    refusal = builder.Add(reader.table(), samples);
    if (text.empty() && refusal.empty()) return false;
  }
  return true;
}

}  // namespace mindahl::io
