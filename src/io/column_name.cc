#include "io/column_name.h"

#include <algorithm>
#include <array>
#include <boost/locale/encoding_utf.hpp>
#include <tuple>
#include <utility>

#include "core/text.h"
#include "io/cells.h"
#include "io/words.h"

namespace mindahl::io {
namespace {

constexpr std::string_view kOtherUnits =
    "|-|%|V|mV|Volt|Volts|volt|volts|A|mA|°C|C|°F|K|Hz|kHz|m/s|mm/s|um/s|µm/s|in/s|rpm|rad/s|deg/"
    "s|°/s|m/s2|m/s^2|m/s²|"
    "mm/s2|mm/min|N/s|kN/s|mV/V|cycle|cycles|segments|count|counts|#|J|W|mm/mm|1/s|";

/// Words in brackets at the end of a name that are no unit of it.
constexpr std::string_view kRemarks =
    "|raw|ave|avg|mean|min|max|rms|filtered|measured|actual|abs|rel|calc|corrected|trigger|demand|";

/// True if a list "|a|b|" has the word.
bool Lists(std::string_view list, std::string_view word) {
  return list.find('|' + std::string(word) + '|') != std::string_view::npos;
}

bool IsLetter(char character) {
  const auto byte = static_cast<unsigned char>(character);
  return byte >= 0x80 || (byte >= 'a' && byte <= 'z') || (byte >= 'A' && byte <= 'Z');
}

/// Returns the words of a name between blanks, " in lower case ", the letters of Latin-1 too: runs
/// of letters, cut where a small one is followed by a capital.
std::string WordsOf(std::string_view name) {
  std::string words = " ";
  char before = ' ';
  for (const char character : name) {
    const bool is_capital = character >= 'A' && character <= 'Z';
    const bool is_latin = before == '\xC3' && character <= '\x9E' && character != '\x97';
    const bool ends_word = !IsLetter(character) || (is_capital && before >= 'a' && before <= 'z');
    if (ends_word && words.back() != ' ') words += ' ';
    if (IsLetter(character)) {
      words += static_cast<char>(is_capital || is_latin ? character + 0x20 : character);
    }
    before = character;
  }
  return words.back() == ' ' ? words : words + ' ';
}

/// True for a word of a language that does not part its words by blanks.
bool IsUnparted(std::string_view word) { return static_cast<unsigned char>(word.front()) >= 0xE3; }

/// Returns the place behind the last match of an entry of the table in such words; 0 where there is
/// none. "*kraft" is the end of a word.
std::size_t MatchEnd(std::string_view entry, std::string_view words) {
  std::string pattern(entry.starts_with('*') ? entry.substr(1) : entry);
  if (!IsUnparted(entry)) pattern += ' ';
  if (!IsUnparted(entry) && !entry.starts_with('*')) pattern.insert(0, 1, ' ');
  const std::size_t at = words.rfind(pattern);
  return at == std::string_view::npos ? 0 : at + pattern.size();
}

/// The name behind the path of an instrument, if it begins with a letter there: "AI 1/x" is "x".
std::string_view WithoutPath(std::string_view name) {
  for (std::size_t at = name.size(); at-- > 0;) {
    const bool separates = std::string_view("/.:|").find(name[at]) != std::string_view::npos;
    if (separates && at + 1 < name.size() && IsLetter(name[at + 1])) return name.substr(at + 1);
  }
  return name;
}

/// One letter, or a few that are no word, are a name by themselves, perhaps with "actual" and the
/// like; what is behind a label, "U1 PI: P N: 1", is none of it.
std::string_view OnlyWord(std::string_view name) {
  if (const std::size_t label = name.find(": "); label != std::string_view::npos) {
    name = name.substr(0, name.find_last_of(' ', label));
  }
  std::string_view only;
  for (auto end = name.begin(); end != name.end();) {
    const auto begin = std::find_if(end, name.end(), IsLetter);
    end = std::find_if_not(begin, name.end(), IsLetter);
    const std::string_view word(begin, end);
    if (word.empty() || Lists(kRemarks, LowerCase(word))) continue;
    if (!only.empty()) return {};
    only = word;
  }
  return only;
}

NameEvidence EvidenceOf(std::string_view name) {
  NameEvidence evidence;
  const std::string words = WordsOf(name);
  const std::string_view only = OnlyWord(WithoutPath(name));
  const auto count = static_cast<std::size_t>(std::ranges::count(words, ' ')) - 1;
  // The entry of most words, of these the last in the name, of these that of the lowest rank.
  std::tuple<std::size_t, std::size_t, int> best{0, 0, 0};
  for (const WordRow& row : kWords) {
    for (const std::string_view entry : PartsOf(row.words, '|')) {
      const bool is_letter = CharactersIn(entry) == 1 && entry.size() < 3;
      const std::size_t end = !is_letter      ? MatchEnd(entry, words)
                              : only == entry ? words.size()
                                              : 0;
      if (end == 0) continue;
      const std::size_t size = is_letter           ? count
                               : IsUnparted(entry) ? CharactersIn(entry)
                                                   : PartsOf(entry, ' ').size();
      const std::tuple found{size, end, -row.rank};
      if (!(best < found)) continue;
      best = found;
      evidence = {.word = entry, .role = row.role, .rank = row.rank, .is_angular = row.is_angular};
    }
  }
  evidence.is_lesser = std::ranges::any_of(
      PartsOf(kLesserWords, '|'), [&](auto lesser) { return MatchEnd(lesser, words) > 0; });
  evidence.other_words = count - std::min(count, std::get<0>(best));
  return evidence;
}

bool IsKnown(std::string_view symbol) { return FindUnit(symbol) || Lists(kOtherUnits, symbol); }

/// True for a text in brackets that can only be meant as a unit, though none that is known:
/// "furlong", "N x10" and "1e-5 m", but neither "23.8 N" nor "in contact".
bool MayBeUnit(std::string_view text) {
  const auto is_unit = [](std::string_view word) {
    const auto of = DimensionOf(word);
    return word != "in" && (MayHaveRole(of, Role::kDisplacement) || MayHaveRole(of, Role::kForce));
  };
  const std::size_t last = text.find_last_of(" *");
  const bool is_quantity =
      text.substr(0, last).find_first_not_of("0123456789., ±+-") == std::string_view::npos;
  if (last != std::string_view::npos && !is_quantity &&
      (is_unit(text.substr(0, text.find_first_of(" ,*"))) || is_unit(text.substr(last + 1)))) {
    return true;
  }
  constexpr std::size_t kLongest = 12;
  const bool begins = !text.empty() && (IsLetter(text.front()) || text.front() == '%');
  return begins && text.size() <= kLongest && text.find(' ') == std::string_view::npos &&
         !Lists(kRemarks, LowerCase(text));
}

/// The text with the brackets, letters and signs of Chinese and Japanese fonts as those of ASCII.
std::string WithNarrowLetters(std::string_view text) {
  using boost::locale::conv::utf_to_utf;
  const auto narrow = [](char32_t letter) {
    constexpr char32_t kWide = 0xFEE0;  // from '!' to its wide sign, U+FF01
    const bool is_wide = letter > kWide + ' ' && letter <= kWide + '~';
    return letter == U'【' ? U'[' : letter == U'】' ? U']' : is_wide ? letter - kWide : letter;
  };
  std::u32string letters = utf_to_utf<char32_t>(text.data(), text.data() + text.size());
  std::ranges::transform(letters, letters.begin(), narrow);
  return utf_to_utf<char>(letters);
}

/// Takes a unit off behind a comma, a slash, an underscore or a blank.
void TakeUnitAtEnd(ColumnName& split) {
  const std::string plain = split.name;
  for (const std::size_t at : {plain.rfind(','), plain.find('/'), plain.find_last_of("_ ")}) {
    if (at == std::string::npos || at == 0) continue;
    std::string name(Trimmed(std::string_view(plain).substr(0, at)));
    const std::string_view unit = Trimmed(std::string_view(plain).substr(at + 1));
    if (!IsKnown(unit)) continue;
    const bool is_marked = plain[at] == ',' || plain[at] == '/';
    const NameEvidence evidence = EvidenceOf(name);
    // "F_h" is a horizontal force, "F_rad" a radial one; "k_N" is nothing that is known.
    const std::optional<Dimension> dimension = DimensionOf(unit);
    const bool agrees = evidence.word.empty() ? dimension && CharactersIn(unit) > 1
                                              : MayHaveRole(dimension, evidence.role);
    if (!is_marked && !agrees) continue;
    split.unit = unit;
    if (name.ends_with(" in")) name.resize(name.size() - 3);
    const bool is_perhaps_normal = LowerCase(name) == "f" && unit == "N";
    if (!is_perhaps_normal) split.name = std::move(name);
    return;
  }
}

}  // namespace

std::optional<Dimension> DimensionOf(std::string_view symbol) {
  const std::optional<Unit> unit = FindUnit(symbol);
  return unit ? std::optional(unit->dimension) : std::nullopt;
}

bool MayHaveRole(std::optional<Dimension> dimension, Role role) {
  if (role == Role::kDisplacement) {
    return dimension == Dimension::kLength || dimension == Dimension::kAngle;
  }
  if (role == Role::kForce || role == Role::kNormalLoad) {
    return dimension == Dimension::kForce || dimension == Dimension::kTorque;
  }
  return role == Role::kTime && dimension == Dimension::kTime;
}

std::string_view WithoutBrackets(std::string_view cell) {
  cell = Trimmed(cell);
  const bool bracketed = cell.size() >= 2 && ((cell.front() == '[' && cell.back() == ']') ||
                                              (cell.front() == '(' && cell.back() == ')'));
  return bracketed ? Trimmed(cell.substr(1, cell.size() - 2)) : cell;
}

bool LooksLikeUnit(std::string_view cell) {
  const std::string_view symbol = WithoutBrackets(cell);
  return IsKnown(symbol) || (symbol.size() != Trimmed(cell).size() && MayBeUnit(symbol));
}

ColumnName SplitColumnName(std::string_view header) {
  const std::string plain = WithNarrowLetters(Trimmed(header));
  ColumnName split{.name = plain};
  bool is_known = false;
  for (std::size_t close = plain.find_last_of("])");
       !is_known && close != std::string::npos && close > 0;
       close = plain.find_last_of("])", close - 1)) {
    const std::size_t open = plain.rfind(plain[close] == ']' ? '[' : '(', close);
    if (open == std::string::npos || open == 0) continue;
    const std::string_view unit =
        Trimmed(std::string_view(plain).substr(open + 1, close - open - 1));
    is_known = IsKnown(unit);
    if (!is_known && (close + 1 < plain.size() || !MayBeUnit(unit))) continue;
    split.unit = unit;
    split.name = std::string(Trimmed(plain.substr(0, open))) + plain.substr(close + 1);
  }
  if (split.unit.empty()) TakeUnitAtEnd(split);
  split.evidence = EvidenceOf(split.name);
  return split;
}

std::size_t CountKnownWords(std::span<const std::string> cells) {
  return static_cast<std::size_t>(std::ranges::count_if(cells, [](const std::string& cell) {
    const ColumnName split = SplitColumnName(cell);
    return !split.unit.empty() || !split.evidence.word.empty();
  }));
}

}  // namespace mindahl::io
