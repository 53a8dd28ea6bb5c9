#include "io/column_name.h"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>
#include <vector>

#include "core/text.h"
#include "io/cells.h"
#include "io/words.h"
#include "mindahl/core/units.h"

namespace mindahl::io {
namespace {

constexpr std::array<std::string_view, 44> kOtherUnits = {
    "-",        "%",     "V",      "mV",     "A",   "mA",    "bar",   "Pa",    "kPa",
    "MPa",      "psi",   "°C",     "C",      "°F",  "K",     "Hz",    "kHz",   "m/s",
    "mm/s",     "um/s",  "µm/s",   "in/s",   "rpm", "rad/s", "deg/s", "°/s",   "m/s2",
    "m/s^2",    "m/s²",  "mm/s2",  "mm/min", "N/s", "kN/s",  "mV/V",  "cycle", "cycles",
    "segments", "count", "counts", "#",      "J",   "W",     "mm/mm", "1/s"};

/// Words in brackets at the end of a name that are no unit of it.
constexpr std::array<std::string_view, 16> kRemarks = {
    "raw",      "ave",    "avg", "mean", "min",  "max",       "rms",     "filtered",
    "measured", "actual", "abs", "rel",  "calc", "corrected", "trigger", "demand"};

/// Lower case, of the letters of Latin-1 too.
std::string Lower(std::string_view text) {
  std::string lower = LowerCase(text);
  for (std::size_t at = 1; at < lower.size(); ++at) {
    const auto byte = static_cast<unsigned char>(lower[at]);
    const bool is_capital = lower[at - 1] == '\xC3' && byte >= 0x80 && byte <= 0x9E && byte != 0x97;
    if (is_capital) lower[at] = static_cast<char>(byte + 0x20);
  }
  return lower;
}

bool IsLetter(char character) {
  const auto byte = static_cast<unsigned char>(character);
  return byte >= 0x80 || (byte >= 'a' && byte <= 'z') || (byte >= 'A' && byte <= 'Z');
}

/// The words of a name as they are written: runs of letters, cut where a small one is followed by a
/// capital.
std::vector<std::string> WordsOf(std::string_view name) {
  std::vector<std::string> words;
  bool begins = true;
  for (std::size_t at = 0; at < name.size(); ++at) {
    const char character = name[at];
    const bool is_capital = character >= 'A' && character <= 'Z';
    const bool after_small = at > 0 && name[at - 1] >= 'a' && name[at - 1] <= 'z';
    if (!IsLetter(character)) {
      begins = true;
      continue;
    }
    if (begins || (is_capital && after_small)) words.emplace_back();
    words.back() += character;
    begins = false;
  }
  return words;
}

/// True for a word of a language that does not part its words by blanks.
bool IsUnparted(std::string_view word) { return static_cast<unsigned char>(word.front()) >= 0xE3; }

/// Returns the place behind the match of some words in a name; 0 where they are not in it.
std::size_t MatchEnd(std::string_view entry, std::span<const std::string> words) {
  const std::vector<std::string_view> parts = PartsOf(entry, ' ');
  for (std::size_t at = words.size() + 1 - std::min(words.size() + 1, parts.size()); at-- > 0;) {
    bool matches = true;
    for (std::size_t k = 0; k < parts.size() && matches; ++k) {
      const bool is_end = parts[k].starts_with('*');
      const std::string_view part = is_end ? parts[k].substr(1) : parts[k];
      matches = is_end ? words[at + k].ends_with(part) : words[at + k] == part;
    }
    if (matches) return at + parts.size();
  }
  return 0;
}

struct Found {
  std::size_t words = 0;
  std::size_t end = 0;
  int rank = 0;
  friend bool operator<(const Found& a, const Found& b) {
    return std::pair(a.words, a.end) < std::pair(b.words, b.end) ||
           (std::pair(a.words, a.end) == std::pair(b.words, b.end) && a.rank > b.rank);
  }
};

Dimension DimensionOf(std::string_view symbol) {
  if (symbol.empty()) return Dimension::kNone;
  if (LengthUnit(symbol)) return Dimension::kLength;
  if (AngleUnit(symbol)) return Dimension::kAngle;
  if (ForceUnit(symbol)) return Dimension::kForce;
  if (TorqueUnit(symbol)) return Dimension::kTorque;
  if (TimeUnit(symbol)) return Dimension::kTime;
  return Dimension::kOther;
}

bool IsKnown(std::string_view symbol) {
  return (DimensionOf(symbol) != Dimension::kOther && !symbol.empty()) || IsPressureUnit(symbol) ||
         std::ranges::find(kOtherUnits, symbol) != kOtherUnits.end();
}

/// True for a text in brackets that can only be meant as a unit, though none that is known.
bool MayBeUnit(std::string_view text) {
  constexpr std::size_t kLongest = 12;
  const bool begins = !text.empty() && (IsLetter(text.front()) || text.front() == '%');
  return begins && text.size() <= kLongest && text.find(' ') == std::string_view::npos &&
         std::ranges::find(kRemarks, LowerCase(text)) == kRemarks.end();
}

/// The text with the brackets of Chinese and Japanese fonts as those of ASCII.
std::string WithAsciiBrackets(std::string_view text) {
  std::string plain(text);
  for (const auto& [wide, narrow] :
       {std::pair("（", "("), std::pair("）", ")"), std::pair("［", "["), std::pair("］", "]"),
        std::pair("【", "["), std::pair("】", "]")}) {
    for (std::size_t at = plain.find(wide); at != std::string::npos; at = plain.find(wide)) {
      plain.replace(at, std::string_view(wide).size(), narrow);
    }
  }
  return plain;
}

bool IsOf(Dimension dimension, Role role) {
  switch (role) {
    case Role::kDisplacement:
      return dimension == Dimension::kLength || dimension == Dimension::kAngle;
    case Role::kForce:
    case Role::kNormalLoad:
      return dimension == Dimension::kForce || dimension == Dimension::kTorque;
    case Role::kTime:
      return dimension == Dimension::kTime;
    default:
      return false;
  }
}

}  // namespace

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

NameEvidence EvidenceOf(std::string_view name) {
  NameEvidence evidence;
  std::vector<std::string> words = WordsOf(name);
  // One letter, or few, are a name by themselves, or at the end of a path of instruments.
  std::size_t path = name.find_last_of("/.:|");
  while (path != std::string_view::npos && path + 1 < name.size() && !IsLetter(name[path + 1])) {
    path = path == 0 ? std::string_view::npos : name.find_last_of("/.:|", path - 1);
  }
  const std::vector<std::string> last = WordsOf(name.substr(path + 1));
  const std::string whole = last.size() == 1 ? last.front() : "";
  for (std::string& word : words) word = Lower(word);
  const std::string lower = Lower(name);
  Found best;
  for (const WordRow& row : kWords) {
    for (const std::string_view entry : PartsOf(row.words, '|')) {
      Found found{.rank = row.rank};
      if (IsUnparted(entry)) {
        const std::size_t at = lower.find(entry);
        if (at != std::string::npos) found = {entry.size() / 3, at + entry.size(), row.rank};
      } else if (CharactersIn(entry) == 1) {
        if (whole == entry) found = {words.size(), words.size(), row.rank};
      } else {
        found.end = MatchEnd(entry, words);
        found.words =
            found.end == 0 ? 0 : 1 + static_cast<std::size_t>(std::ranges::count(entry, ' '));
      }
      if (found.words == 0 || !(best < found)) continue;
      best = found;
      evidence.role = row.role;
      evidence.is_angular = row.is_angular;
      evidence.rank = row.rank;
      evidence.word = entry;
    }
  }
  for (const std::string_view lesser : PartsOf(kLesserWords, '|')) {
    evidence.is_lesser = evidence.is_lesser || std::ranges::find(words, lesser) != words.end();
  }
  evidence.other_words = words.size() - std::min(words.size(), best.words);
  return evidence;
}

ColumnName SplitColumnName(std::string_view header) {
  const std::string plain = WithAsciiBrackets(Trimmed(header));
  ColumnName split{.name = plain};
  const auto take = [&](std::size_t open, std::size_t close) {
    split.unit = Trimmed(std::string_view(plain).substr(open + 1, close - open - 1));
    split.name = std::string(Trimmed(plain.substr(0, open))) + plain.substr(close + 1);
  };
  std::optional<std::pair<std::size_t, std::size_t>> at_end;
  for (std::size_t close = plain.find_last_of("])"); close != std::string::npos && close > 0;
       close = plain.find_last_of("])", close - 1)) {
    const std::size_t open = plain.rfind(plain[close] == ']' ? '[' : '(', close);
    if (open == std::string::npos || open == 0) continue;
    const std::string_view unit =
        Trimmed(std::string_view(plain).substr(open + 1, close - open - 1));
    if (IsKnown(unit)) {
      take(open, close);
      split.dimension = DimensionOf(split.unit);
      return split;
    }
    if (close + 1 == plain.size() && MayBeUnit(unit)) at_end = {open, close};
  }
  if (at_end) {
    take(at_end->first, at_end->second);
    split.dimension = Dimension::kOther;
    return split;
  }
  for (const std::size_t separator :
       {plain.rfind(','), plain.find('/'), plain.find_last_of("_ ")}) {
    if (separator == std::string::npos || separator == 0) continue;
    std::string name(Trimmed(std::string_view(plain).substr(0, separator)));
    const std::string_view unit = Trimmed(std::string_view(plain).substr(separator + 1));
    if (!IsKnown(unit)) continue;
    const Dimension dimension = DimensionOf(unit);
    const bool is_marked = plain[separator] == ',' || plain[separator] == '/';
    const NameEvidence evidence = EvidenceOf(name);
    // "F_h" is a horizontal force, "F_rad" a radial one; "k_N" is nothing that is known.
    const bool agrees =
        evidence.word.empty() ? CharactersIn(unit) > 1 : IsOf(dimension, evidence.role);
    if (!is_marked && (!agrees || dimension == Dimension::kOther)) continue;
    if (LowerCase(name) == "f" && unit == "N") name = plain;  // perhaps the normal force
    if (name.ends_with(" in")) name.resize(name.size() - 3);
    return {std::move(name), std::string(unit), dimension};
  }
  return split;
}

std::size_t CountKnownWords(std::span<const std::string> cells) {
  return static_cast<std::size_t>(std::ranges::count_if(cells, [](const std::string& cell) {
    const ColumnName split = SplitColumnName(cell);
    return split.dimension != Dimension::kNone || !EvidenceOf(split.name).word.empty();
  }));
}

bool MayHaveRole(Dimension dimension, Role role) { return IsOf(dimension, role); }

Dimension DimensionOfUnit(std::string_view symbol) { return DimensionOf(symbol); }

}  // namespace mindahl::io
