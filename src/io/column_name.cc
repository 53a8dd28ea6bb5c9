#include "io/column_name.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <boost/locale/encoding_utf.hpp>
#include <cmath>
#include <tuple>
#include <utility>
#include <vector>

#include "core/from_chars.h"
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

/// Words of a name whose numbers are ratios, in no unit.
constexpr std::string_view kRatios =
    "|normalized|normalised|normalisiert|normiert|percent|percentage|prozent|pct|ratio|";

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

bool IsCapital(char character) { return character >= 'A' && character <= 'Z'; }
bool IsSmall(char character) { return IsLetter(character) && !IsCapital(character); }

/// A unit of a displacement, a force or a time among the words of a text.
struct UnitWord {
  std::size_t begin, end;
  Unit unit;
  bool is_weak;              // one only where it suits what the name is
  std::size_t quantity = 0;  // begin of a number before it, as in "5 kN"; 0 without one
};

/// Finds the units among the words of a text, which are runs of letters, cut where a small one is
/// followed by a capital. A single letter is one as the last word.
std::vector<UnitWord> UnitsIn(std::string_view text) {
  struct Word {
    std::size_t begin, end;
    bool is_camel;
  };
  std::vector<Word> words;
  for (std::size_t begin = 0; begin < text.size(); ++begin) {
    if (!IsLetter(text[begin])) continue;
    std::size_t end = begin;
    while (end < text.size() && IsLetter(text[end])) ++end;
    Word word{begin, end, false};
    for (std::size_t at = begin + 1; at < end; ++at) {
      if (!IsSmall(text[at - 1]) || !IsCapital(text[at])) continue;
      if (FindUnit(text.substr(begin, end - begin))) break;  // "kN"
      // "ForcekN" ends with the unit kN.
      const bool has_prefix = text[at] == 'N' && FindUnit(text.substr(at - 1, 2));
      words.push_back({word.begin, has_prefix ? at - 1 : at, word.is_camel});
      word = {words.back().end, end, true};
    }
    words.push_back(word);
    begin = end;
  }
  const auto text_of = [&](std::size_t k) {
    return k < words.size() ? text.substr(words[k].begin, words[k].end - words[k].begin) : "";
  };
  std::vector<UnitWord> units;
  for (std::size_t k = 0; k < words.size(); ++k) {
    auto [begin, end, is_camel] = words[k];
    std::string word(text_of(k));
    const std::string next(text_of(k + 1));
    std::optional<Unit> unit = FindUnit(word);
    if (!unit && is_camel) {
      if (IsCapital(word.front())) word.front() = static_cast<char>(word.front() + 0x20);
      unit = FindUnit(word);
    }
    const bool is_divided = end < text.size() && (text[end] == '/' || text[end] == '^');
    if (unit && (is_divided || next == "per" || (unit->symbol == "deg" && next.size() == 1))) {
      k += next == "per" ? 2 : 1;  // a speed, an area or a temperature
      continue;
    }
    const bool is_one = !next.empty() && words[k + 1].begin == end;  // "MilliN"
    if (is_one || (unit && !next.empty() && words[k + 1].begin == end + 1)) {
      const auto product = FindUnit(fmt::format("{}{}{}", word, is_one ? "" : " ", next));
      if (product && (is_one || product->dimension == Dimension::kTorque)) {
        unit = product;
        end = words[++k].end;
      }
    }
    const bool is_single = CharactersIn(text.substr(begin, end - begin)) == 1;
    const bool is_last =
        std::ranges::none_of(text.substr(end), [](char c) { return IsLetter(c) || IsDigit(c); });
    if (!unit || unit->dimension == Dimension::kPressure || LowerCase(word) == "in" ||
        (is_single && (is_camel || !is_last))) {
      continue;
    }
    const bool has_number = end < text.size() && IsDigit(text[end]);
    UnitWord& found = units.emplace_back(begin, end, *unit, is_single || is_camel || has_number);
    const std::size_t last = text.substr(0, begin).find_last_not_of(' ');
    if (last == text.npos || !IsDigit(text[last])) continue;
    const std::size_t before = text.substr(0, last).find_last_not_of("0123456789.,");
    if (before != text.npos && !IsLetter(text[before])) found.quantity = before + 1;
  }
  return units;
}

/// True for a number that may be a factor of a unit, "[10 N]", and for one of another unit than
/// that which would be assumed, "[5 kN]"; not for "[23.8 N]", which is a range.
bool IsNoUnit(std::string_view number, const Unit& unit) {
  return unit.numerator != unit.denominator ||
         (std::ranges::count(number, '1') == 1 &&
          number.find_first_not_of("10., ") == std::string_view::npos);
}

/// Returns a factor in a name, "x1000", "×10⁻³", "/10" or "1e-3", from its sign on; "" where there
/// is none.
std::string_view FactorIn(std::string_view name) {
  for (std::size_t at = 1; at < name.size(); ++at) {
    const std::string_view rest = name.substr(at);
    const char before = name[at - 1];
    const bool is_times = rest.starts_with("×") || rest.starts_with('*');
    const bool is_power = LowerCase(rest.substr(0, 2)) == "e-" && !IsLetter(before);
    const bool is_x = LowerCase(rest.substr(0, 1)) == "x" && !IsLetter(before) && !IsDigit(before);
    const bool is_over = rest.starts_with('/') && IsLetter(before);
    if (!is_times && !is_power && !is_x && !is_over) continue;
    const std::size_t size = rest.starts_with("×") || is_power ? 2 : 1;
    const std::string_view number = Trimmed(rest.substr(size, rest.find(')') - size));
    double value = 0.0;
    const auto [stop, error] = FromChars(number.data(), number.data() + number.size(), value);
    const bool is_whole = stop == number.data() + number.size();
    const double power = std::log10(std::abs(value));
    // "x1" and "pos/2" are names.
    const bool is_of_ten = is_whole && power != 0 && std::abs(power - std::round(power)) < 1e-9;
    if (error != std::errc() || (!is_times && !is_power && !is_of_ten)) continue;
    const std::size_t begin =
        is_power ? name.substr(0, at).find_last_not_of("0123456789.") + 1 : at;
    return Trimmed(name.substr(begin, name.find(')', at) - begin));
  }
  return {};
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
  if (text.starts_with('%')) return true;
  const bool begins =
      !text.empty() && (IsLetter(text.front()) || text.front() == '?' || text.front() == '&');
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

/// Returns a name without a part of it, and what separates that from the rest.
std::string WithoutPart(std::string_view name, std::size_t begin, std::size_t end) {
  constexpr std::string_view kSeparators = " _-.:=@|,;/<{[(";
  const std::string_view before = name.substr(0, begin);
  const std::string_view after = name.substr(end);
  const std::size_t last = before.find_last_not_of(kSeparators);
  const bool goes_on = std::ranges::any_of(after, [](char c) { return IsLetter(c) || IsDigit(c); });
  if (last == before.npos) {
    return std::string(after.substr(std::min(after.find_first_not_of(kSeparators), after.size())));
  }
  return std::string(before.substr(0, last + 1)).append(goes_on ? after : "");
}

/// Takes the unit that is among the words of a name, or one that contradicts that which it has.
void TakeUnitAmongWords(ColumnName& split) {
  const std::string plain = split.name;
  for (const UnitWord& word : UnitsIn(plain)) {
    std::string name = WithoutPart(plain, word.begin, word.end);
    if (name.empty()) continue;
    const NameEvidence evidence = EvidenceOf(name);
    const Dimension dimension = word.unit.dimension;
    if (evidence.word.empty() ? word.is_weak : !MayHaveRole(dimension, evidence.role)) continue;
    const std::string number = plain.substr(word.quantity, word.begin - word.quantity);
    if (word.quantity > 0) {
      const bool is_none =
          split.unit.empty() && dimension != Dimension::kTime && IsNoUnit(number, word.unit);
      if (is_none) split.unit = plain.substr(word.quantity, word.end - word.quantity);
    } else if (split.unit.empty()) {
      split.unit = word.unit.symbol;
      split.name = std::move(name);
    } else if (const auto unit = FindUnit(split.unit);
               unit && unit->dimension == dimension && unit->symbol != word.unit.symbol) {
      split.other_unit = word.unit.symbol;
    }
  }
}

/// Gives a name with a factor, or of a ratio, a unit that is none.
void RequireUnit(ColumnName& split) {
  if (const std::string_view factor = FactorIn(split.name); !factor.empty()) {
    split.unit.append(split.unit.empty() ? "" : " ").append(factor);
  }
  if (!split.unit.empty()) return;
  const std::string words = WordsOf(split.name);
  for (const std::string_view word : PartsOf(Trimmed(words), ' ')) {
    if (Lists(kRatios, word)) split.unit = word;
  }
  if (split.name.ends_with('%')) split.unit = "%";
  const std::size_t slash = std::min(split.name.find('/'), split.name.size());
  const auto is_force = [](const NameEvidence& evidence) {
    return evidence.names(Role::kForce) || evidence.names(Role::kNormalLoad);
  };
  if (slash < split.name.size() && is_force(EvidenceOf(split.name.substr(0, slash))) &&
      is_force(EvidenceOf(split.name.substr(slash + 1)))) {
    split.unit = split.name;
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
    std::string unit(Trimmed(std::string_view(plain).substr(open + 1, close - open - 1)));
    is_known = IsKnown(unit);
    if (const auto among = UnitsIn(unit);  // "in mm"
        !is_known && among.size() == 1 && unit.find_first_of("0123456789*%?&") == unit.npos) {
      unit = among.front().unit.symbol;
      is_known = true;
    }
    if (!is_known && (close + 1 < plain.size() || !MayBeUnit(unit))) continue;
    split.unit = std::move(unit);
    split.name = std::string(Trimmed(plain.substr(0, open))) + plain.substr(close + 1);
  }
  if (split.unit.empty()) TakeUnitAtEnd(split);
  TakeUnitAmongWords(split);
  RequireUnit(split);
  split.evidence = EvidenceOf(split.name);
  return split;
}

std::string UnitAmongWords(std::string_view text, Role role) {
  for (const UnitWord& word : UnitsIn(text)) {
    if (MayHaveRole(word.unit.dimension, role)) return word.unit.symbol;
  }
  return "";
}

std::size_t CountKnownWords(std::span<const std::string> cells) {
  return static_cast<std::size_t>(std::ranges::count_if(cells, [](const std::string& cell) {
    const ColumnName split = SplitColumnName(cell);
    return !split.unit.empty() || !split.evidence.word.empty();
  }));
}

}  // namespace mindahl::io
