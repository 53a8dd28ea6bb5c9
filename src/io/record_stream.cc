#include "mindahl/io/record_stream.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "io/column_name.h"
#include "io/csv_layout.h"
#include "io/input_file.h"
#include "io/number_cell.h"
#include "mindahl/core/error.h"
#include "mindahl/core/units.h"
#include "mindahl/io/csv_table.h"

namespace mindahl::io {
namespace {

/// Size [bytes] of the first rows, by which the content of the columns is judged.
constexpr std::size_t kJudged = LinePieces::kPiece / 8;

/// Lines at the end of a file that are taken for a footer at the most.
constexpr std::size_t kLongestFooter = 1000;

/// Takes the first line off a text, without its end.
std::string_view TakeLine(std::string_view& text) {
  const void* const found = std::memchr(text.data(), '\n', text.size());
  const std::size_t size =
      found == nullptr ? text.size()
                       : static_cast<std::size_t>(static_cast<const char*>(found) - text.data());
  std::string_view line = text.substr(0, size);
  text.remove_prefix(std::min(size + 1, text.size()));
  if (line.ends_with('\r')) line.remove_suffix(1);
  return line;
}

}  // namespace

struct RecordStream::State {
  struct StreamedColumn {
    std::size_t column;  // from 0
    Expression sum;      // of the columns that are wanted, by their place among these
    Unit unit;
    std::vector<double> Samples::*values;
    std::string_view name;
  };

  State(const std::filesystem::path& path, const RecordColumns& columns, BrokenRows policy)
      : name(NameOfInput(path)), pieces(path, columns.encoding), broken(policy) {
    Open(pieces.Next(), columns);
  }

  void Open(std::string_view text, const RecordColumns& columns);
  std::string WholeRows(std::string_view text, const CsvLayout& found) const;
  bool Next(Samples& samples);
  void Read(std::string_view text, Samples& samples);
  void MindBrokenRow(std::size_t row, std::size_t column, const std::string& fault);
  void MindFooter();

  std::string name;
  LinePieces pieces;
  BrokenRows broken;
  RecordFile layout;
  std::vector<StreamedColumn> channels;
  std::vector<double> cells;                       // of the row, those that are wanted
  NumberRowReader rows{Delimiter::kComma, 0, {}};  // of no columns until the layout is known
  std::string_view first;                          // rows of the first piece
  std::size_t line = 0;                            // last that was read
  struct FooterLine {
    std::size_t line;
    std::size_t column;
    std::string fault;
  };
  std::vector<FooterLine> footer;  // the last lines, that begin with a text
  std::size_t broken_rows = 0;
  std::string first_broken_row;
  std::string refusal;                                     // of a row that is reached next
  double time = -std::numeric_limits<double>::infinity();  // of the row above, in its unit
};

/// Finds out from the header and the first rows what the file holds.
void RecordStream::State::Open(std::string_view text, const RecordColumns& columns) {
  if (text.starts_with(kUtf8Mark)) text.remove_prefix(kUtf8Mark.size());
  const bool is_text = !text.empty() && text.find('\0') == std::string_view::npos;
  if (!is_text) ParseCsvTable(std::string(text), name);  // refuses it in its words
  const CsvLayout found = FindCsvLayout(text, name);
  first = text.substr(found.data_offset);
  line = found.data_line - 1;
  const std::size_t judged = text.find('\n', found.data_offset + kJudged);
  const CsvTable table = ParseCsvTable(WholeRows(text.substr(0, judged), found), name);
  layout = RecordOfRows(table, columns);
  if (!pieces.note().empty()) layout.notes.insert(layout.notes.begin(), pieces.note());
  const GivenColumns given = ReadGivenColumns(table, columns);
  std::vector<std::size_t> wanted;
  const auto add = [&](const ChosenColumn& column, const std::optional<Unit>& unit, Expression sum,
                       std::vector<double> Samples::*values, std::string_view what) {
    if (sum.terms.empty()) sum.terms = {{column.index - 1, 1.0}};
    for (Expression::Term& term : sum.terms) {
      auto place = std::ranges::find(wanted, term.column);
      if (place == wanted.end()) place = wanted.insert(wanted.end(), term.column);
      term.column = static_cast<std::size_t>(place - wanted.begin());
    }
    channels.push_back({column.index - 1, std::move(sum), *unit, values, what});
  };
  add(layout.displacement,
      layout.is_torsional ? AngleUnit(layout.displacement.unit)
                          : LengthUnit(layout.displacement.unit),
      given.displacement, &Samples::displacement, "displacement");
  add(layout.force,
      layout.is_torsional ? TorqueUnit(layout.force.unit) : ForceUnit(layout.force.unit),
      given.force, &Samples::force, "force");
  if (layout.time) {
    add(*layout.time, TimeUnit(layout.time->unit), given.time, &Samples::time, "time");
  }
  if (layout.normal_load) {
    add(*layout.normal_load, ForceOrTorqueUnit(layout.normal_load->unit), given.normal_load,
        &Samples::normal_load, "normal load");
  }
  cells.resize(wanted.size());
  const bool has_clock = layout.time && layout.time->is_clock;
  rows = NumberRowReader(found.delimiter, table.columns(), std::move(wanted),
                         has_clock ? std::optional(layout.time->index - 1) : std::nullopt);
  layout.record = {};
  layout.lines.clear();
  layout.covariates.clear();
}

/// The header and the rows that are not broken in any column that mostly holds numbers: what rows
/// become of is for Read() to say.
std::string RecordStream::State::WholeRows(std::string_view text, const CsvLayout& found) const {
  const std::string_view header = text.substr(0, found.data_offset);
  const auto select = [&](const std::vector<std::size_t>& numeric) {
    NumberRowReader reader(found.delimiter, found.columns, numeric);
    std::vector<double> values(numeric.size());
    std::string selected(header);
    for (std::string_view rest = text.substr(found.data_offset); !rest.empty();) {
      const std::string_view row = TakeLine(rest);
      const bool may_be_cut = rest.empty() && !pieces.at_end();
      if (may_be_cut || reader.Read(row, 1, values) != NumberRowReader::Row::kNumbers) continue;
      selected.append(row).append("\n");
    }
    return selected;
  };
  const CsvTable table = ParseCsvTable(select({}), name);
  std::vector<std::size_t> numeric;
  for (std::size_t column = 0; column < table.columns(); ++column) {
    const auto is_number = [](double value) { return !std::isnan(value); };
    const auto numbers = std::ranges::count_if(table.NumbersOrNan(column), is_number);
    if (2 * static_cast<std::size_t>(numbers) > table.rows()) numeric.push_back(column);
  }
  return select(numeric);
}

bool RecordStream::State::Next(Samples& samples) {
  samples.lines.clear();
  for (const StreamedColumn& channel : channels) (samples.*channel.values).clear();
  while (samples.lines.empty()) {
    if (!refusal.empty()) throw InputError(refusal);
    const std::string_view text = first.empty() ? pieces.Next() : std::exchange(first, {});
    if (text.empty()) return false;
    Read(text, samples);
  }
  return true;
}

void RecordStream::State::Read(std::string_view text, Samples& samples) {
  std::array<double, 4> values{};  // of displacement, force, time and normal load
  constexpr std::size_t kTimeChannel = 2;
  while (!text.empty() && refusal.empty()) {
    const std::string_view row = TakeLine(text);
    ++line;
    switch (rows.Read(row, line, cells)) {
      case NumberRowReader::Row::kNone:
        continue;
      case NumberRowReader::Row::kBroken:
        if (rows.may_be_footer()) {  // unless data follow
          footer.push_back({line, rows.fault_column(), rows.fault()});
          if (footer.size() > kLongestFooter) MindFooter();
        } else {
          MindFooter();
          MindBrokenRow(line, rows.fault_column(), rows.fault());
        }
        continue;
      case NumberRowReader::Row::kNumbers:
        break;
    }
    if (!footer.empty()) {
      MindFooter();
      if (!refusal.empty()) return;
    }
    for (std::size_t k = 0; k < channels.size(); ++k) {
      const Expression& sum = channels[k].sum;
      values[k] = sum.offset;
      for (const Expression::Term& term : sum.terms) values[k] += term.weight * cells[term.column];
    }
    if (layout.time) {
      const double above = std::exchange(time, values[kTimeChannel]);
      const std::string fault = DescribeTimeFault(time, above, layout.time->unit);
      if (!fault.empty()) {
        MindBrokenRow(line, channels[kTimeChannel].column, fault);
        continue;
      }
    }
    bool is_finite = true;
    for (std::size_t k = 0; k < channels.size(); ++k) {
      const double value = channels[k].unit.ToSi(values[k]);
      if (is_finite && !std::isfinite(value)) {
        MindBrokenRow(line, channels[k].column,
                      fmt::format("{} = {} {} is too large: must be below 1.8e308 in SI units",
                                  channels[k].name, values[k], channels[k].unit.symbol));
        is_finite = false;
      }
      values[k] = value;
    }
    if (!is_finite) continue;
    for (std::size_t k = 0; k < channels.size(); ++k) {
      (samples.*channels[k].values).push_back(values[k]);
    }
    samples.lines.push_back(line);
  }
}

/// Takes lines that begin with a text for broken rows, since data follow.
void RecordStream::State::MindFooter() {
  for (const FooterLine& row : footer) MindBrokenRow(row.line, row.column, row.fault);
  footer.clear();
}

void RecordStream::State::MindBrokenRow(std::size_t row, std::size_t column,
                                        const std::string& fault) {
  if (!refusal.empty()) return;
  const std::string message = fmt::format("{}:{}:{}: {}", name, row, column + 1, fault);
  if (broken == BrokenRows::kRefuse) {
    refusal = message;
  } else if (broken_rows++ == 0) {
    first_broken_row = message;
  }
}

RecordStream::RecordStream(const std::filesystem::path& path, const RecordColumns& columns,
                           BrokenRows broken)
    : state_(std::make_unique<State>(path, columns, broken)) {}
RecordStream::~RecordStream() = default;

const RecordFile& RecordStream::layout() const { return state_->layout; }
bool RecordStream::Next(Samples& samples) { return state_->Next(samples); }
std::size_t RecordStream::broken_rows() const { return state_->broken_rows; }
const std::string& RecordStream::first_broken_row() const { return state_->first_broken_row; }
std::size_t RecordStream::footer_lines() const { return state_->footer.size(); }
std::uintmax_t RecordStream::bytes() const { return state_->pieces.bytes(); }

}  // namespace mindahl::io
