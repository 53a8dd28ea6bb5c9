#include "io/columns.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <boost/locale/encoding_utf.hpp>
#include <cmath>
#include <limits>
#include <tuple>

#include "core/text.h"
#include "io/cells.h"
#include "io/words.h"

namespace mindahl::io {
namespace {

// The rows are in the order of Role.
constexpr std::array kRules = {
    RoleRules{"displacement", "--displacement", Dimension::kLength, Dimension::kAngle,
              &RecordColumns::displacement, &RecordFile::displacement, &loop::Record::displacement},
    RoleRules{"force", "--force", Dimension::kForce, Dimension::kTorque, &RecordColumns::force,
              &RecordFile::force, &loop::Record::force},
    RoleRules{"time", "--time", Dimension::kTime, Dimension::kTime, &RecordColumns::time,
              &RecordFile::time, &loop::Record::time},
    // A joint carries a torque.
    RoleRules{"normal load", "--normal-load-column", Dimension::kForce, Dimension::kTorque,
              &RecordColumns::normal_load, &RecordFile::normal_load, &loop::Record::normal_load},
    RoleRules{"covariate", "--covariate", {}, {}, nullptr, nullptr, nullptr},
};

/// Units of a sensor's signal, which a gain makes a force or a displacement.
constexpr std::string_view kSignalUnits = "|%|V|mV|Volt|Volts|volt|volts|A|mA|mV/V|count|counts|";

constexpr std::string_view kOtherUnits =
    "|-|°C|C|°F|K|Hz|kHz|m/s|mm/s|um/s|µm/s|in/s|rpm|rad/s|deg/s|°/s|m/s2|m/s^2|m/s²|mm/s2|mm/min|"
    "N/s|kN/s|cycle|cycles|segments|#|J|W|mm/mm|1/s|";

/// Words in brackets at the end of a name that are no unit of it.
constexpr std::string_view kRemarks =
    "|raw|ave|avg|mean|min|max|rms|filtered|measured|actual|abs|rel|calc|corrected|trigger|demand|";

/// Beginnings of a factor behind a name, in lower case, that make its unit none.
constexpr std::array<std::string_view, 12> kFactors = {
    "×", "*0", "*1", " x0.", " x 0.", " x10", " x 10", "1e-", " e-", "10^", "10⁻", "%"};

/// True if a list "|a|b|" has the word.
bool Lists(std::string_view list, std::string_view word) {
  return list.find(fmt::format("|{}|", word)) != list.npos;
}

/// Returns the dimension of a unit; none of one that is not known.
std::optional<Dimension> DimensionOf(std::string_view symbol) {
  const std::optional<Unit> unit = FindUnit(symbol);
  return unit ? std::optional(unit->dimension) : std::nullopt;
}

bool IsKnown(std::string_view symbol) {
  return FindUnit(symbol) || Lists(kSignalUnits, symbol) || Lists(kOtherUnits, symbol);
}

/// Returns the words of a name between blanks, " in words ": runs of letters; "dispMm" is two.
std::string WordsIn(std::string_view name) {
  std::string words = " ";
  for (std::size_t k = 0; k < name.size(); ++k) {
    const bool is_cut = k > 0 && IsSmall(name[k - 1]) && IsCapital(name[k]);
    if ((is_cut || !IsLetter(name[k])) && words.back() != ' ') words += ' ';
    if (IsLetter(name[k])) words += name[k];
  }
  return words.back() == ' ' ? words : words + ' ';
}

/// True for a word of a language that does not part its words by blanks.
bool IsUnparted(std::string_view word) { return static_cast<unsigned char>(word.front()) >= 0xE3; }

/// Returns the end of the last match of a table's entry in such words, 0 without one.
std::size_t MatchEnd(std::string_view entry, std::string_view words) {
  std::string pattern(entry.starts_with('*') ? entry.substr(1) : entry);
  if (!IsUnparted(entry)) pattern += ' ';
  if (!IsUnparted(entry) && !entry.starts_with('*')) pattern.insert(0, 1, ' ');
  const std::size_t at = words.rfind(pattern);
  return at == std::string_view::npos ? 0 : at + pattern.size();
}

/// Finds the best word of a name: the entry of most words, of these the last in the name, of these
/// that of the lowest rank. One letter is a name by itself.
void FindWord(Column& column) {
  const std::string written = WordsIn(column.name);
  const std::string words = LowerCase(written);
  const std::vector<std::string_view> parts = PartsOf(Trimmed(written), ' ');
  std::string only;  // of one letter, where no other words but remarks are with it
  for (const std::string_view word : parts) {
    if (!Lists(kRemarks, LowerCase(word))) only += word;
  }
  std::tuple<std::size_t, std::size_t, int> best{0, 0, 0};
  for (const WordRow& row : kWords) {
    for (const std::string_view entry : PartsOf(row.words, '|')) {
      const bool is_letter = CharactersIn(entry) == 1 && entry.size() < 3;
      const auto end = !is_letter ? MatchEnd(entry, words) : only == entry ? words.size() : 0;
      if (end == 0) continue;
      const std::size_t size = is_letter           ? parts.size()
                               : IsUnparted(entry) ? CharactersIn(entry)
                                                   : PartsOf(entry, ' ').size();
      const std::tuple found{size, end, -row.rank};
      if (!(best < found)) continue;
      best = found;
      column.word = entry;
      std::tie(column.role, column.rank, column.is_angular) =
          std::tie(row.role, row.rank, row.is_angular);
    }
  }
  const auto has_any = [&](std::string_view list) {
    return std::ranges::any_of(PartsOf(list, '|'),
                               [&](auto word) { return MatchEnd(word, words) > 0; });
  };
  column.is_lesser = has_any(kLesserWords);
  if (column.unit.empty() && (column.rank == kRatio || has_any(kRatios))) column.unit = kRatioUnit;
  column.other_words = parts.size() - std::min(parts.size(), std::get<0>(best));
}

/// The text in brackets, or the cell itself: "[mm]", "(mm)" and "mm" are "mm".
std::string_view WithoutBrackets(std::string_view cell) {
  cell = Trimmed(cell);
  const bool bracketed = cell.size() >= 2 && ((cell.front() == '[' && cell.back() == ']') ||
                                              (cell.front() == '(' && cell.back() == ')'));
  return bracketed ? Trimmed(cell.substr(1, cell.size() - 2)) : cell;
}

/// True for a text in brackets that can only be meant as a unit, though none that is known:
/// "furlong" and "% FS", but neither "23.8 N" nor "in contact".
bool MayBeUnit(std::string_view text) {
  constexpr std::size_t kLongest = 12;
  if (text.empty() || text.starts_with('%')) return !text.empty();
  const bool begins = IsLetter(text.front()) || text.front() == '?' || text.front() == '&';
  return begins && text.size() <= kLongest && text.find(' ') == text.npos &&
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

/// Takes a unit in brackets off a name: the last that is known, at the end also one that is not.
void TakeUnitInBrackets(Column& column) {
  const std::string plain = column.name;
  for (std::size_t close = plain.find_last_of("])"); close != plain.npos && close > 0;
       close = plain.find_last_of("])", close - 1)) {
    const std::size_t open = plain.rfind(plain[close] == ']' ? '[' : '(', close);
    if (open == plain.npos || open == 0) continue;
    const std::string unit(Trimmed(std::string_view(plain).substr(open + 1, close - open - 1)));
    const bool is_known = IsKnown(unit);
    if (!is_known && (close + 1 < plain.size() || !MayBeUnit(unit))) continue;
    column.unit = unit;
    column.name = std::string(Trimmed(plain.substr(0, open))) + plain.substr(close + 1);
    if (is_known) return;
  }
}

/// Finds the longest last unit among the words of a name: any behind a comma or a slash, else one
/// that suits the words before it; of a single letter the last word. It is taken off the end.
void TakeUnitAmongWords(Column& column) {
  constexpr std::string_view kSeparators = " _-.:=@|,;/<{[()]}>";
  constexpr std::string_view kBehind = " _-.:=@|,;/<{[()]}>0123456789";  // "force_kN_1"
  const std::string plain = column.name.substr(0, column.name.find_last_not_of(kBehind) + 1);
  for (std::size_t end = plain.size(); end > 0; end = plain.find_last_of(kSeparators, end - 1)) {
    if (end == plain.npos) return;
    for (std::size_t at = plain.find_first_of(kSeparators, 1); at < end;
         at = plain.find_first_of(kSeparators, at + 1)) {
      std::string unit(Trimmed(std::string_view(plain).substr(at + 1, end - at - 1)));
      std::ranges::replace(unit, '_', ' ');  // "torque_N_m"
      Column rest{.name = plain.substr(0, plain.find_last_not_of(kSeparators, at) + 1)};
      if (!IsKnown(unit) || LowerCase(unit) == "in" || rest.name.empty()) continue;
      FindWord(rest);
      const bool is_end = end == plain.size();
      const bool is_long = CharactersIn(unit) > 1;
      // "F_h" is a horizontal force, "F_V" a vertical one; "k_N" is nothing that is known.
      const bool is_voltage = is_end && (unit == "mV" || (unit == "V" && rest.word.empty()));
      const bool suits =
          is_voltage || (rest.word.empty() ? is_end && is_long && FindUnit(unit)
                                           : MayHaveRole(DimensionOf(unit), rest.role));
      const bool is_marked = is_end && (plain[at] == ',' || plain[at] == '/');
      if (!is_marked && !(suits && (is_end || is_long))) continue;
      const std::size_t number = rest.name.find_last_not_of("0123456789.") + 1;
      if (suits && !is_voltage && IsDigit(rest.name.back()) &&
          (number == 0 || !IsLetter(rest.name[number - 1]))) {
        // "5 kN" is none; "23.8 N" is in the unit that would be assumed.
        if (FindUnit(unit)->ToSi(1) != 1) column.unit = plain.substr(number, end - number);
        return;
      }
      column.unit = unit;
      // "F_N" is perhaps the normal force.
      if (is_end && (LowerCase(rest.name) != "f" || unit != "N")) column.name = rest.name;
      return;
    }
  }
}

/// Gives a name with a factor a unit that is none.
void RequireNoFactor(Column& column) {
  std::string lower = LowerCase(column.name);
  std::ranges::replace(lower, '(', ' ');
  for (const std::string_view factor : kFactors) {
    // A name may begin with what would be a factor behind it: "x10 [mm]".
    const std::size_t found = lower.find(factor);
    if (found == lower.npos || found == 0) continue;
    const std::string_view rest = Trimmed(std::string_view(lower).substr(found));
    column.unit += column.unit.empty() ? "" : " ";
    column.unit += rest.substr(0, rest.find_first_of(")]"));
    return;
  }
}

/// Describes how numbers behave.
void ObserveValues(Column& column) {
  constexpr double kPart = 0.4;
  double least = std::numeric_limits<double>::infinity();
  double greatest = -least;
  double rise = 0.0;
  double fall = 0.0;
  std::size_t numbers = 0;
  for (const double value : column.values) {
    if (!std::isfinite(value)) continue;
    if (numbers++ == 0) column.first = value;
    least = std::min(least, value);
    greatest = std::max(greatest, value);
    rise = std::max(rise, value - least);
    fall = std::max(fall, greatest - value);
  }
  column.is_numeric = !column.values.empty() && 2 * numbers >= column.values.size();
  column.least = least;
  column.greatest = greatest;
  column.trend = int{rise > 0 && fall == 0} - int{fall > 0 && rise == 0};
  column.goes_to_and_fro = greatest > least && std::min(rise, fall) > kPart * (greatest - least);
}

}  // namespace

const RoleRules& RulesOf(Role role) { return kRules.at(static_cast<std::size_t>(role)); }

bool MayHaveRole(std::optional<Dimension> dimension, Role role) {
  return role <= Role::kNormalLoad && dimension &&
         (*dimension == RulesOf(role).linear || *dimension == RulesOf(role).angular);
}

std::optional<bool> Column::IsAngular(std::string_view given_unit) const {
  const auto of_unit = given_unit.empty() ? dimension : DimensionOf(given_unit);
  if (of_unit == Dimension::kAngle || of_unit == Dimension::kTorque) return true;
  if (of_unit == Dimension::kLength || of_unit == Dimension::kForce) return false;
  return is_angular ? std::optional(true) : std::nullopt;
}

Column ReadName(std::string_view header, std::string_view below) {
  Column column{.header = std::string(header), .name = WithNarrowLetters(Trimmed(header))};
  std::string& name = column.name;
  name.resize(std::min(name.find(" PI: "), name.size()));  // of Abaqus: a label of a point
  TakeUnitInBrackets(column);
  if (column.unit.empty()) TakeUnitAmongWords(column);
  RequireNoFactor(column);
  below = WithoutBrackets(below);
  if (column.unit.empty()) {
    column.unit = below;
  } else if (!below.empty() && below != column.unit) {
    column.unit += fmt::format(" or {}", below);
  }
  FindWord(column);
  // "millis"
  const bool is_unit = column.names(Role::kTime) && DimensionOf(name) == Dimension::kTime;
  if (column.unit.empty() && is_unit) column.unit = name;
  column.dimension = DimensionOf(column.unit);
  return column;
}

bool IsOfSignal(std::string_view symbol) { return Lists(kSignalUnits, symbol); }

bool LooksLikeUnit(std::string_view cell) {
  const std::string_view symbol = WithoutBrackets(cell);
  return IsKnown(symbol) || (symbol.size() != Trimmed(cell).size() && MayBeUnit(symbol));
}

void Observe(std::vector<Column>& columns) {
  for (Column& column : columns) ObserveValues(column);
  constexpr double kGreatestCoefficient = 2;
  const bool has_force = std::ranges::any_of(
      columns, [](const Column& of) { return of.dimension == Dimension::kForce; });
  bool has_friction = false;
  bool has_other = false;  // a ratio or a force to either side
  for (Column& of : columns) {
    const bool may_be = has_force && of.unit.empty() && of.least > -kGreatestCoefficient &&
                        of.greatest < kGreatestCoefficient;
    if (may_be && (of.word == "friction" || of.word == "f")) of.unit = kRatioUnit;
    const bool is_force = of.names(Role::kForce);
    has_other =
        has_other || of.unit == kRatioUnit || of.rank == kRatio ||
        (is_force && (of.rank != kLoad || of.is_angular) && of.least < 0 && of.greatest > 0);
    has_friction = has_friction || (is_force && of.rank == 0);
  }
  for (Column& of : columns) {
    const bool is_load =
        of.names(Role::kForce) && of.rank == kLoad && !of.is_angular && of.other_words == 0;
    const bool keeps_sign = of.least > 0 || of.greatest < 0;
    if (is_load && (has_friction || (has_other && keeps_sign))) of.role = Role::kNormalLoad;
  }
}

}  // namespace mindahl::io
