#include "mindahl/io/record_stream.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>
#include <vector>

#include "io/record_builder.h"
#include "io/source.h"
#include "io/table_reader.h"
#include "mindahl/core/error.h"
#include "mindahl/io/csv_table.h"

namespace mindahl::io {
namespace {

/// Size [bytes] of the first rows, by which the content of the columns is judged.
constexpr std::size_t kJudged = LinePieces::kPiece / 8;

}  // namespace

struct RecordStream::State {
  State(const std::filesystem::path& path, const RecordColumns& columns, BrokenRows policy)
      : pieces(path, columns.encoding),
        name(NameOfInput(path)),
        first(pieces.Next()),
        layout(FindLayout(first, name)),
        builder(FirstRows(), columns),
        rows(layout, name, builder.wanted()),
        cells(builder.wanted().size()),
        line(layout.data_line - 1),
        skips(policy == BrokenRows::kSkip) {
    if (!columns.with.empty()) {
      throw InputError("--with: a record that is read in pieces is of one file: join them before");
    }
    first.remove_prefix(layout.data_offset);
    std::vector<std::string>& notes = builder.file().notes;
    if (!pieces.note().empty()) notes.insert(notes.begin(), pieces.note());
  }

  /// The table of the first rows: what becomes of those at fault is for Read() to say.
  CsvTable FirstRows() const {
    TableReader reader(first, name, /*skip_broken=*/true);
    const std::size_t end = first.find('\n', layout.data_offset + kJudged);
    reader.Read(first.substr(layout.data_offset,
                             end == std::string_view::npos ? end : end + 1 - layout.data_offset));
    return reader.Finish();
  }

  bool Next(Samples& samples);
  void Read(std::string_view text, Samples& samples);
  void Refuse(std::size_t at, const std::string& fault);

  LinePieces pieces;
  std::string name;
  std::string_view first;  // rows of the first piece
  Layout layout;
  RecordBuilder builder;
  RowReader rows;
  std::vector<double> cells;
  RowValues values{};
  std::size_t line;     // last that was read
  std::size_t row = 0;  // likewise
  bool skips;
  bool begins_block = false;
  MissingRows missing;
  MissingRows broken;
  std::string refusal;  // of a row that is reached next
};

bool RecordStream::State::Next(Samples& samples) {
  samples.lines.clear();
  for (auto* const column :
       {&samples.displacement, &samples.force, &samples.time, &samples.normal_load}) {
    column->clear();
  }
  while (samples.lines.empty()) {
    if (!refusal.empty()) throw InputError(refusal);
    const std::string_view text = first.empty() ? pieces.Next() : std::exchange(first, {});
    if (text.empty()) {
      const std::string below = rows.TakeFault();
      if (below.empty()) return false;
      Refuse(line, below);
      if (refusal.empty()) return false;
      continue;
    }
    Read(text, samples);
    if (skips || !refusal.empty()) continue;
    try {
      missing.RequireFew(row);
    } catch (const InputError& error) {
      refusal = error.what();
    }
  }
  return true;
}

void RecordStream::State::Read(std::string_view text, Samples& samples) {
  while (!text.empty() && refusal.empty()) {
    const std::size_t at = line + 1;
    const std::string_view text_of_row = TakeRow(text, line);
    const RowReader::Row kind = rows.Read(text_of_row, at, cells);
    if (kind == RowReader::Row::kNone) continue;
    if (const std::string fault = rows.TakeFault(); !fault.empty()) Refuse(at, fault);
    if (kind == RowReader::Row::kFault || !refusal.empty()) continue;
    begins_block = begins_block || rows.begins_block();
    const std::size_t number = row++;
    if (!rows.cell_faults().empty()) {
      const auto fault =
          std::ranges::find(rows.cell_faults(), false, &RowReader::Fault::is_missing);
      if (fault != rows.cell_faults().end()) {
        Refuse(at, fault->message);
      } else {
        missing.Count(at, rows.cell_faults().front().message);
      }
      continue;
    }
    const std::string fault = builder.Convert(cells, at, number, begins_block, values);
    if (!fault.empty()) {
      Refuse(at, fault);
      continue;
    }
    begins_block = false;
    builder.Append(values, samples);
    samples.lines.push_back(at);
  }
}

void RecordStream::State::Refuse(std::size_t at, const std::string& fault) {
  if (skips) {
    broken.Count(at, fault);
  } else if (refusal.empty()) {
    refusal = fault;
  }
}

RecordStream::RecordStream(const std::filesystem::path& path, const RecordColumns& columns,
                           BrokenRows broken)
    : state_(std::make_unique<State>(path, columns, broken)) {}
RecordStream::~RecordStream() = default;

const RecordFile& RecordStream::layout() const { return state_->builder.file(); }
bool RecordStream::Next(Samples& samples) { return state_->Next(samples); }
std::size_t RecordStream::broken_rows() const {
  return state_->broken.rows.count + (state_->skips ? state_->missing.rows.count : 0);
}
const std::string& RecordStream::first_broken_row() const {
  const MissingRows& missing = state_->missing;
  const MissingRows& broken = state_->broken;
  const bool is_missing =
      broken.rows.count == 0 ||
      (missing.rows.count > 0 && missing.rows.first_line < broken.rows.first_line);
  return is_missing ? missing.first : broken.first;
}
const LeftOutRows& RecordStream::left_out() const { return state_->missing.rows; }
std::uintmax_t RecordStream::bytes() const { return state_->pieces.bytes(); }

}  // namespace mindahl::io
