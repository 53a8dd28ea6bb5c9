#pragma once

#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include "mindahl/report/page.h"
#include "report/statements.h"

// Pieces of a page of HTML. Text is escaped here, and nowhere else.
namespace mindahl::report {

/// Returns "good", "poor" or "bad": its class of the page's style.
std::string_view CssClass(Judgement judgement);

/// Returns <p>, with a class where one is given.
std::string Paragraph(std::string_view text, std::string_view css_class = {});

/// Returns <h2> that begins a section.
std::string Heading(std::string_view text);
/// Returns <h3> within one.
std::string SubHeading(std::string_view text);

/// Returns a list of sentences; nothing where there is none.
std::string SentenceList(const std::vector<std::string>& sentences);

/// Returns a command to copy.
std::string CommandBlock(std::string_view command);

/// A cell of a table.
struct Cell {
  enum class Kind { kNumber, kWords };
  std::string text;
  Kind kind = Kind::kNumber;
  std::string_view css_class = {};  ///< "good", "poor" or "bad" where it is a judgement
};
[[nodiscard]] Cell Number(std::string text);
[[nodiscard]] Cell Words(std::string text, std::string_view css_class = {});

/// A table whose first column names its rows. It scrolls by itself where it is wider than the page.
class Table {
 public:
  /// @param caption  what it holds, read aloud before it
  Table(std::string_view caption, std::initializer_list<std::string_view> columns);
  void Row(std::string_view name, const std::vector<Cell>& cells);
  [[nodiscard]] bool empty() const { return rows_.empty(); }
  /// Returns nothing where there is no row.
  [[nodiscard]] std::string Html() const;

 private:
  std::string head_;
  std::string rows_;
};

/// Returns the first paragraph of a page: a judgement and its colour, "good", "poor" or "bad".
std::string VerdictBlock(std::string_view css_class, std::string_view word,
                         std::string_view sentence);

/// Returns the section that says what it takes to make the result again.
std::string ReproduceSection(const Provenance& provenance);

}  // namespace mindahl::report
