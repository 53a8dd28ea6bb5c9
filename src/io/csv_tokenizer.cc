#include "io/csv_tokenizer.h"

#include <algorithm>
#include <new>

#include "io/number_cell.h"

namespace mindahl::io {

namespace {

bool IsBlankOrComment(std::string_view line) {
  const std::size_t first = line.find_first_not_of(" \t\r\n");
  if (first == std::string_view::npos) return true;
  return line[first] == '#' && !BeginsWithErrorValue(line.substr(first));
}

}  // namespace

std::size_t CsvRow::FilledSize() const {
  std::size_t filled = size();
  while (filled > 0 && Trimmed((*this)[filled - 1]).empty()) --filled;
  return filled;
}

CsvTokenizer::CsvTokenizer(std::string_view text, Delimiter delimiter, std::size_t offset,
                           std::size_t line)
    : text_(text), delimiter_(delimiter), next_offset_(offset), next_line_(line) {
  // An empty cell arrives as null unless it was quoted: that distinguishes a run of blanks from "".
  if (csv_init(&parser_, CSV_EMPTY_IS_NULL) != 0) throw std::bad_alloc();
  csv_set_delim(&parser_, static_cast<unsigned char>(delimiter));
}

CsvTokenizer::~CsvTokenizer() { csv_free(&parser_); }

bool CsvTokenizer::Next(CsvRow& row) {
  row_ = &row;
  row_complete_ = false;
  bool row_begun = false;
  while (next_offset_ < text_.size()) {
    const std::size_t offset = next_offset_;
    const std::size_t line_number = next_line_;
    const std::string_view line = TakeLine();
    if (!row_begun) {
      if (IsBlankOrComment(line)) continue;
      row.line = line_number;
      row.offset = offset;
      row.bytes_.clear();
      row.ends_.clear();
      row_begun = true;
    }
    Feed(line);
    if (next_offset_ == text_.size() && !row_complete_) Feed("\n");
    if (!row_complete_) continue;  // a quoted cell goes on in the next line
    if (row.FilledSize() > 0) return true;
    row_complete_ = false;
    row_begun = false;
  }
  ended_in_quotes_ = row_begun;
  return false;
}

/// One physical line with its end.
std::string_view CsvTokenizer::TakeLine() {
  std::string_view line = text_.substr(next_offset_);
  line = line.substr(0, line.find('\n'));
  const std::size_t carriage_return = line.find('\r');
  std::size_t size = line.size();
  if (carriage_return != std::string_view::npos) size = carriage_return;
  const std::string_view end = text_.substr(next_offset_ + size, 2);
  size += end == "\r\n" ? 2 : std::min<std::size_t>(end.size(), 1);
  line = text_.substr(next_offset_, size);
  next_offset_ += size;
  ++next_line_;
  return line;
}

void CsvTokenizer::Feed(std::string_view line) {
  if (delimiter_ == Delimiter::kBlanks && line.find('\t') != std::string_view::npos) {
    blank_line_ = line;
    std::ranges::replace(blank_line_, '\t', ' ');
    line = blank_line_;
  }
  if (csv_parse(&parser_, line.data(), line.size(), &OnCell, &OnRow, this) != line.size()) {
    throw std::bad_alloc();
  }
}

void CsvTokenizer::OnCell(void* text, std::size_t size, void* tokenizer) {
  auto& self = *static_cast<CsvTokenizer*>(tokenizer);
  if (text == nullptr && self.delimiter_ == Delimiter::kBlanks) return;
  if (text != nullptr) self.row_->bytes_.append(static_cast<const char*>(text), size);
  self.row_->ends_.push_back(self.row_->bytes_.size());
}

void CsvTokenizer::OnRow(int /*terminator*/, void* tokenizer) {
  static_cast<CsvTokenizer*>(tokenizer)->row_complete_ = true;
}

}  // namespace mindahl::io
