#include "mindahl/io/record_stream.h"

#include <fmt/format.h>

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
  State(const std::filesystem::path& path, const RecordColumns& columns)
      : pieces(path, columns.encoding),
        name(NameOfInput(path)),
        rows(pieces.Next()),
        layout(FindLayout(rows, name)),
        builder(FirstRows(), columns),
        reader(layout, name, builder.wanted(), columns.skip_broken_rows) {
    if (!columns.with.empty()) {
      throw InputError("--with: a record that is read in pieces is of one file: join them before");
    }
    rows.remove_prefix(layout.data_offset);
    std::vector<std::string>& notes = builder.file().notes;
    if (!pieces.note().empty()) notes.insert(notes.begin(), pieces.note());
  }

  /// The table of the first rows: what becomes of those at fault is for Next() to say.
  CsvTable FirstRows() const {
    TableReader first(layout, name, /*skip_broken=*/true);
    const std::size_t end = rows.find('\n', layout.data_offset + kJudged);
    first.Read(rows.substr(layout.data_offset,
                           end == std::string_view::npos ? end : end + 1 - layout.data_offset));
    return std::move(first.table());
  }

  LinePieces pieces;
  std::string name;
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
  auto& [pieces, name, rows, layout, builder, reader, refusal] = *state_;
  for (const auto column : loop::kRecordColumns) (samples.*column).clear();
  samples.lines.clear();
  while (samples.lines.empty()) {
    if (!refusal.empty()) throw InputError(refusal);
    const std::string_view text = rows.empty() ? pieces.Next() : std::exchange(rows, {});
    reader.Clear();
    reader.Read(text);
    if (text.empty()) reader.Finish();
    refusal = builder.Add(reader.table(), samples);
    if (refusal.empty()) refusal = reader.fault();
    if (refusal.empty()) refusal = builder.TooManyLeftOut();
    if (text.empty() && refusal.empty()) return false;
  }
  return true;
}

LeftOutRows RecordStream::left_out() const {
  const LeftOutRows& missing = state_->builder.left_out();
  LeftOutRows all = state_->reader.skipped();
  if (missing.count > 0 && (all.count == 0 || missing.first_line < all.first_line)) {
    all.first_line = missing.first_line;
    all.fault = missing.fault;
  }
  all.count += missing.count;
  return all;
}

std::uintmax_t RecordStream::bytes() const { return state_->pieces.bytes(); }

}  // namespace mindahl::io
