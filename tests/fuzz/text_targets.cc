#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "fuzz/bytes.h"
#include "fuzz/memory_file.h"
#include "mindahl/core/error.h"
#include "mindahl/core/units.h"
#include "mindahl/io/record_reader.h"

namespace mindahl::fuzz {
namespace {

std::optional<io::RecordFile> ReadWhole(const std::string& path,
                                        const io::RecordColumns& columns = {}) {
  try {
    return io::ReadRecord(path, columns);
  } catch (const InputError& error) {
    Require(std::string_view(error.what()).find('\n') == std::string_view::npos,
            "a message has one line");
    return std::nullopt;
  }
}

std::optional<io::Samples> ReadStreamed(const std::string& path,
                                        const io::RecordColumns& columns = {}) {
  try {
    io::RecordStream stream(path, columns);
    io::Samples all;
    io::Samples piece;
    while (stream.Next(piece)) {
      Require(piece.displacement.size() == piece.lines.size(), "a sample has a line");
      for (const auto column : loop::kRecordColumns) {
        (all.*column).insert((all.*column).end(), (piece.*column).begin(), (piece.*column).end());
      }
    }
    return all;
  } catch (const InputError&) {
    return std::nullopt;
  }
}

/// Requires what holds of a record however it is read.
void RequireSameWholeAndStreamed(const std::optional<io::RecordFile>& whole,
                                 const std::optional<io::Samples>& streamed) {
  if (whole) {
    Require(whole->lines.size() == whole->record.size(), "a sample of a record has a line");
    for (const auto column : {&loop::Record::displacement, &loop::Record::force}) {
      for (const double value : whole->record.*column) {
        Require(std::isfinite(value), "a displacement or force that is read is finite");
      }
    }
  }
  if (!whole || !streamed || streamed->displacement.empty()) return;
  for (const auto column : loop::kRecordColumns) {
    Require(whole->record.*column == (*streamed).*column,
            "a record is the same read whole and as a stream");
  }
}

/// Returns an ASCII text in UTF-16, with the mark that states the order of its bytes.
std::string InUtf16(std::string_view text, bool little) {
  std::string bytes = little ? "\xFF\xFE" : "\xFE\xFF";
  for (const char character : text) {
    const char other = '\0';
    bytes.push_back(little ? character : other);
    bytes.push_back(little ? other : character);
  }
  return bytes;
}

}  // namespace

void ReadRecords(Input input) {
  const MemoryFile file({reinterpret_cast<const char*>(input.data()), input.size()});
  RequireSameWholeAndStreamed(ReadWhole(file.name()), ReadStreamed(file.name()));
}

void ReadEncodedRecords(Input input) {
  constexpr std::array kEncodings = {"",     "utf-16le", "utf-16be", "utf-16", "utf-8",  "latin1",
                                     "sjis", "utf-7",    "utf-32le", "cp1252", "euc-jp", "nothing"};
  Bytes bytes(input);
  const std::uint8_t kind = bytes.Byte();
  std::string text = bytes.Text();
  if (kind >= kEncodings.size()) {
    // An ASCII record is the same in either order of bytes.
    for (char& character : text) character = static_cast<char>(character & 0x7F);
    std::erase(text, '\0');
    const MemoryFile plain(text);
    const MemoryFile encoded(InUtf16(text, kind % 2 == 0));
    const std::optional<io::RecordFile> record = ReadWhole(plain.name());
    const std::optional<io::RecordFile> same = ReadWhole(encoded.name());
    Require(record.has_value() == same.has_value(), "a text can be read in UTF-16 too");
    Require(!record || (record->record.displacement == same->record.displacement &&
                        record->record.force == same->record.force),
            "a record is the same in UTF-16");
    RequireSameWholeAndStreamed(same, ReadStreamed(encoded.name()));
    return;
  }
  const MemoryFile file(text);
  io::RecordColumns columns;
  columns.encoding = kEncodings[kind];
  RequireSameWholeAndStreamed(ReadWhole(file.name(), columns), ReadStreamed(file.name(), columns));
}

void LookUpUnits(Input input) {
  const std::string symbol = Bytes(input).Text();
  const std::optional<Unit> unit = FindUnit(symbol);
  if (!unit) return;
  Require(std::isfinite(unit->ToSi(1)) && unit->ToSi(1) > 0, "a unit is positive");
  const std::optional<Unit> again = FindUnit(unit->symbol);
  Require(again && again->ToSi(1) == unit->ToSi(1), "a unit is found by its own symbol");
}

}  // namespace mindahl::fuzz
