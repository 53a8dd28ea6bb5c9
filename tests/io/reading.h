#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/text.h"
#include "mindahl/io/record_reader.h"
#include "support/prelude.h"
#include "temporary_directory.h"

// Texts as files, each read whole and as a stream.
namespace mindahl::io {

using Strings = std::vector<std::string>;
using Numbers = std::vector<double>;
using Lines = std::vector<std::size_t>;

inline std::string Replaced(std::string text, const std::string& sign, const std::string& by) {
  for (std::size_t at = text.find(sign); at != std::string::npos; at = text.find(sign)) {
    text.replace(at, sign.size(), by);
  }
  return text;
}

/// Returns the rows of a table of texts whose cells are parted by " | ". A row goes on in lines
/// that are indented by two blanks; → is a tab, ¶ ends a line, ␍ is a carriage return, and - is
/// nothing.
inline std::vector<Strings> RowsOf(const std::string& table) {
  std::vector<Strings> rows;
  const std::string joined = Replaced(Replaced(table, "\n  ", ""), " | ", "\v");
  for (const std::string_view line : PartsOf(joined, '\n')) {
    if (line.empty()) continue;
    Strings& row = rows.emplace_back();
    for (const std::string_view cell : PartsOf(line, '\v')) {
      const std::string text = Replaced(Replaced(std::string(cell), "¶", "\n"), "␍", "\r");
      row.push_back(text == "-" ? "" : Replaced(text, "→", "\t"));
    }
  }
  return rows;
}

inline Samples ReadStreamed(const std::filesystem::path& path, const RecordColumns& columns = {}) {
  RecordStream stream(path, columns);
  Samples all;
  const auto append = [](const auto& from, auto& to) {
    to.insert(to.end(), from.begin(), from.end());
  };
  for (Samples piece; stream.Next(piece);) {
    append(piece.displacement, all.displacement);
    append(piece.force, all.force);
    append(piece.time, all.time);
    append(piece.normal_load, all.normal_load);
    append(piece.lines, all.lines);
  }
  return all;
}

/// Reads a file in both ways and expects one record.
inline RecordFile ReadBothWays(const std::filesystem::path& path,
                               const RecordColumns& columns = {}) {
  const RecordFile whole = ReadRecord(path, columns);
  if (!columns.with.empty()) return whole;
  const Samples streamed = ReadStreamed(path, columns);
  EXPECT_EQ(streamed.displacement, whole.record.displacement);
  EXPECT_EQ(streamed.force, whole.record.force);
  EXPECT_EQ(streamed.time, whole.record.time);
  EXPECT_EQ(streamed.normal_load, whole.record.normal_load);
  EXPECT_EQ(streamed.lines, whole.lines);
  return whole;
}

inline RecordFile Read(const std::string& text, const RecordColumns& columns = {}) {
  const TemporaryDirectory directory;
  return ReadBothWays(directory.Write("loop.csv", text), columns);
}

inline std::string WithoutDirectory(const std::string& text, const TemporaryDirectory& directory) {
  return Replaced(text, directory.path().string() + "/", "");
}

/// Returns what is said of a file called loop.csv that is refused, in both ways.
inline std::string Refusal(const std::string& text, const RecordColumns& columns = {}) {
  const TemporaryDirectory directory;
  const std::filesystem::path path = directory.Write("loop.csv", text);
  const std::string message = MessageOf<InputError>([&] { ReadRecord(path, columns); });
  EXPECT_EQ(MessageOf<InputError>([&] { ReadStreamed(path, columns); }), message);
  return WithoutDirectory(message, directory);
}

inline RecordColumns Choose(const std::string& displacement, const std::string& force = {},
                            const std::string& time = {}, const std::string& normal_load = {}) {
  return {.displacement = displacement, .force = force, .time = time, .normal_load = normal_load};
}

inline const RecordColumns kSkipping = [] {
  RecordColumns columns;
  columns.skip_broken_rows = true;
  return columns;
}();

}  // namespace mindahl::io
