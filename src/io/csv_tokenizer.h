#pragma once

#include <csv.h>

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace mindahl::io {

/// Text from a file as a message shows it: on one line, and cut off after 60 bytes or so.
inline std::string ForMessage(std::string_view text) {
  constexpr std::size_t kLongest = 60;
  std::size_t size = std::min(text.size(), kLongest);
  // Never within a UTF-8 character, whose bytes after the first are 10xxxxxx.
  while (size < text.size() && (static_cast<unsigned char>(text[size]) & 0xC0U) == 0x80U) ++size;
  std::string shown(text.substr(0, size));
  std::ranges::replace_if(
      shown, [](char byte) { return static_cast<unsigned char>(byte) < 0x20; }, ' ');
  return size < text.size() ? shown + "..." : shown;
}

/// Separates the cells of a row; kBlanks is any run of spaces and tabs.
enum class Delimiter : char { kTab = '\t', kSemicolon = ';', kComma = ',', kBlanks = ' ' };

/// The cells of one row and where it begins. Reused from row to row, so that nothing is allocated.
class CsvRow {
 public:
  [[nodiscard]] std::size_t size() const { return ends_.size(); }
  std::string_view operator[](std::size_t cell) const {
    const std::size_t begin = cell == 0 ? 0 : ends_[cell - 1];
    return std::string_view(bytes_).substr(begin, ends_[cell] - begin);
  }
  /// Number of cells when the empty ones at the end are left out.
  [[nodiscard]] std::size_t FilledSize() const;

  std::size_t line = 0;    ///< 1-based physical line on which the row begins
  std::size_t offset = 0;  ///< start of that line in the text [bytes]

 private:
  friend class CsvTokenizer;
  std::string bytes_;
  std::vector<std::size_t> ends_;
};

/// Cuts a text into rows of cells (RFC 4180, by libcsv), lines ending in LF, CRLF or CR.
/// Skips blank lines, rows of delimiters alone, and lines that begin with '#', unless that is an
/// error value of a spreadsheet ("#N/A"). A quoted cell may span lines. The text must outlive the
/// tokenizer.
class CsvTokenizer {
 public:
  /// @param offset, line  where to start: offset of a line in `text` [bytes] and its number
  CsvTokenizer(std::string_view text, Delimiter delimiter, std::size_t offset = 0,
               std::size_t line = 1);
  ~CsvTokenizer();
  CsvTokenizer(const CsvTokenizer&) = delete;
  CsvTokenizer& operator=(const CsvTokenizer&) = delete;

  /// The next row, or false at the end of the text.
  bool Next(CsvRow& row);

  /// After Next() returned false: the text ended within the quoted cell of the last row.
  [[nodiscard]] bool EndedInQuotes() const { return ended_in_quotes_; }

 private:
  std::string_view TakeLine();
  void Feed(std::string_view line);
  static void OnCell(void* text, std::size_t size, void* tokenizer);
  static void OnRow(int terminator, void* tokenizer);

  std::string_view text_;
  Delimiter delimiter_;
  std::size_t next_offset_;
  std::size_t next_line_;
  bool ended_in_quotes_ = false;
  csv_parser parser_{};
  std::string blank_line_;  ///< a line with its tabs made blanks
  CsvRow* row_ = nullptr;
  bool row_complete_ = false;
};

}  // namespace mindahl::io
