#include "io/column_name.h"

#include <algorithm>
#include <array>
#include <boost/locale/encoding_utf.hpp>
#include <tuple>
#include <utility>
#include <vector>

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

/// Beginnings of a factor in a name.
constexpr std::array<std::string_view, 9> kFactors = {"×",    "*0",    "*1",  " x0.", " x 0.",
                                                      " x10", " x 10", "1e-", " e-"};

/// True if a list "|a|b|" has the word.
bool Lists(std::string_view list, std::string_view word) {
  return list.find('|' + std::string(word) + '|') != std::string_view::npos;
}

bool IsCapital(char character) { return character >= 'A' && character <= 'Z'; }
bool IsSmall(char character) { return character >= 'a' && character <= 'z'; }
bool IsLetter(char character) {
  return IsCapital(character) || IsSmall(character) ||
         static_cast<unsigned char>(character) >= 0x80;
}

bool IsKnown(std::string_view symbol) { return FindUnit(symbol) || Lists(kOtherUnits, symbol); }

/// Returns the words of a name: runs of letters, cut where a small one is followed by a capital.
std::vector<std::string_view> WordsOf(std::string_view name) {
  std::vector<std::string_view> words;
  for (const auto* end = name.begin(); end != name.end();) {
    const auto* begin = std::find_if(end, name.end(), IsLetter);
    end = std::find_if_not(begin, name.end(), IsLetter);
    while (begin != end) {
      const auto* cut = std::adjacent_find(
          begin, end, [](char one, char next) { return IsSmall(one) && IsCapital(next); });
      if (cut != end) ++cut;
      if (FindUnit({begin, end})) cut = end;  // "kN"
      words.emplace_back(begin, cut);
      begin = cut;
    }
  }
  return words;
}

/// Returns words between blanks, " in lower case ", the letters of Latin-1 too.
std::string InLowerCase(const std::vector<std::string_view>& words) {
  std::string lower = " ";
  for (const std::string_view word : words) {
    for (const char character : word) {
      const bool is_latin = lower.back() == '\xC3' && character <= '\x9E' && character != '\x97';
      lower += static_cast<char>(IsCapital(character) || is_latin ? character + 0x20 : character);
    }
    lower += ' ';
  }
  return lower;
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

NameEvidence EvidenceOf(std::string_view name) {
  NameEvidence evidence;
  const std::vector<std::string_view> all = WordsOf(name);
  const std::string words = InLowerCase(all);
  // One letter is a name by itself, perhaps with "actual" and the like.
  std::vector<std::string_view> only = WordsOf(WithoutPath(name));
  std::erase_if(only, [](std::string_view word) { return Lists(kRemarks, LowerCase(word)); });
  // The entry of most words, of these the last in the name, of these that of the lowest rank.
  std::tuple<std::size_t, std::size_t, int> best{0, 0, 0};
  for (const WordRow& row : kWords) {
    for (const std::string_view entry : PartsOf(row.words, '|')) {
      const bool is_letter = CharactersIn(entry) == 1 && entry.size() < 3;
      const bool is_only = only.size() == 1 && only.front() == entry;
      const std::size_t end = is_letter ? (is_only ? words.size() : 0) : MatchEnd(entry, words);
      if (end == 0) continue;
      const std::size_t size = is_letter           ? all.size()
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
  evidence.other_words = all.size() - std::min(all.size(), std::get<0>(best));
  return evidence;
}

/// True for a text in brackets that can only be meant as a unit, though none that is known:
/// "furlong" and "% FS", but neither "23.8 N" nor "in contact".
bool MayBeUnit(std::string_view text) {
  constexpr std::size_t kLongest = 12;
  if (text.empty() || text.starts_with('%')) return !text.empty();
  const bool begins = IsLetter(text.front()) || text.front() == '?' || text.front() == '&';
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

/// Takes a unit off the end of a name: any behind a comma or a slash, else one that suits the words
/// before it; or finds one among the words of a name, which keeps it.
void TakeUnitAtEnd(ColumnName& split) {
  constexpr std::string_view kSeparators = " _-.:=@|,;/<{[()]}>";
  constexpr std::string_view kBehind = " _-.:=@|,;/<{[()]}>0123456789";  // "force_kN_1"
  const std::string plain = split.name.substr(0, split.name.find_last_not_of(kBehind) + 1);
  for (std::size_t at = plain.find_first_of(kSeparators, 1); at != plain.npos;
       at = plain.find_first_of(kSeparators, at + 1)) {
    std::string unit(Trimmed(std::string_view(plain).substr(at + 1)));
    std::ranges::replace(unit, '_', ' ');  // "torque_N_m"
    const std::size_t last = plain.find_last_not_of(kSeparators, at);
    std::string name = plain.substr(0, last + 1);
    if (!IsKnown(unit) || LowerCase(unit) == "in" || name.empty()) continue;
    if (name.ends_with(" in")) name.resize(name.size() - 3);
    const NameEvidence evidence = EvidenceOf(name);
    const auto of = FindUnit(unit);
    // "F_h" is a horizontal force, "F_rad" a radial one; "k_N" is nothing that is known.
    const bool suits = evidence.word.empty() ? of && CharactersIn(unit) > 1
                                             : MayHaveRole(DimensionOf(unit), evidence.role);
    const bool is_marked = plain[at] == ',' || plain[at] == '/';
    if (!suits && !is_marked) continue;
    const std::size_t number = name.find_last_not_of("0123456789.") + 1;
    if (suits && IsDigit(name.back()) && !IsLetter(name[number - (number > 0 ? 1 : 0)])) {
      // "5 kN" is none; "23.8 N" is in the unit that would be assumed.
      if (of->numerator != of->denominator) split.unit = plain.substr(number);
      return;
    }
    split.unit = unit;
    // "F_N" is perhaps the normal force.
    if (LowerCase(name) != "f" || unit != "N") split.name = std::move(name);
    return;
  }
  for (const std::string_view word : WordsOf(plain)) {  // "Disp_um_raw"
    const auto at = static_cast<std::size_t>(word.data() - plain.data());
    const std::size_t before = plain.substr(0, at).find_last_not_of(' ');
    const bool is_range = before != plain.npos && IsDigit(plain[before]);
    const bool may_be = CharactersIn(word) > 1 && LowerCase(word) != "in" && !is_range;
    if (may_be && MayHaveRole(DimensionOf(word), EvidenceOf(plain).role)) split.unit = word;
  }
}

/// Gives a name with a factor, or of a ratio, a unit that is none.
void RequireUnit(ColumnName& split) {
  std::string lower = LowerCase(split.name);
  std::ranges::replace(lower, '(', ' ');
  for (const std::string_view factor : kFactors) {
    const std::size_t found = lower.find(factor);
    if (found == lower.npos || found == 0) continue;
    const std::size_t at = lower.find_first_not_of(' ', found);
    split.unit.append(split.unit.empty() ? "" : " ");
    split.unit.append(split.name.substr(at, split.name.find_first_of(")]", at) - at));
    return;
  }
  if (!split.unit.empty()) return;
  for (const std::string_view word : WordsOf(split.name)) {
    if (Lists(kRatios, LowerCase(word))) split.unit = LowerCase(word);
  }
  if (split.name.ends_with('%')) split.unit = "%";
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
  std::string plain = WithNarrowLetters(Trimmed(header));
  plain.resize(std::min(plain.find(" PI: "), plain.size()));  // of Abaqus: a label of a point
  ColumnName split{.name = plain};
  bool is_known = false;
  for (std::size_t close = plain.find_last_of("])");
       !is_known && close != std::string::npos && close > 0;
       close = plain.find_last_of("])", close - 1)) {
    const std::size_t open = plain.rfind(plain[close] == ']' ? '[' : '(', close);
    if (open == std::string::npos || open == 0) continue;
    const std::string unit(Trimmed(std::string_view(plain).substr(open + 1, close - open - 1)));
    is_known = IsKnown(unit);
    if (!is_known && (close + 1 < plain.size() || !MayBeUnit(unit))) continue;
    split.unit = unit;
    split.name = std::string(Trimmed(plain.substr(0, open))) + plain.substr(close + 1);
  }
  if (split.unit.empty()) TakeUnitAtEnd(split);
  RequireUnit(split);
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
