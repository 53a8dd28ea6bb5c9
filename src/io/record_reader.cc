#include "mindahl/io/record_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <span>
#include <string_view>
#include <utility>

#include "core/from_chars.h"
#include "core/nearest_name.h"
#include "core/text.h"
#include "io/column_name.h"
#include "io/csv_tokenizer.h"
#include "io/expression.h"
#include "mindahl/core/error.h"
#include "mindahl/core/units.h"
#include "mindahl/io/csv_table.h"

namespace mindahl::io {
namespace {

/// Names by which a column is recognised, those of one rank in a row, the best first; "" is none.
using NamesOfRank = std::array<std::string_view, 11>;

constexpr std::array<NamesOfRank, 5> kDisplacementNames = {{
    {"tangential displacement", "relative displacement"},
    {"displacement", "disp", "verschiebung", "déplacement", "deplacement", "変位"},
    {"position", "pos", "travel", "stroke", "extension", "weg", "verfahrweg", "auslenkung"},
    {"x", "X", "d", "delta", "δ"},
    {"angle", "rotation", "twist"},
}};
constexpr std::size_t kRankOfAngles = 4;

constexpr std::array<NamesOfRank, 7> kForceNames = {{
    {"tangential force", "friction force", "lateral force", "shear force", "tangentialkraft",
     "reibkraft", "reibungskraft", "querkraft", "force tangentielle", "effort tangentiel",
     "摩擦力"},
    {"force", "friction", "kraft", "effort", "荷重"},
    {"torque"},
    {"ft", "f t"},
    {"F", "f", "Q"},
    {"T"},    // t is the time
    {"f n"},  // a force in newton, unless there is a better one
}};
constexpr std::array<NamesOfRank, 2> kTimeNames = {{
    {"time", "time stamp", "timestamp", "elapsed time", "date/time", "date time", "datetime",
     "zeit", "temps", "時間"},
    {"t"},
}};
constexpr std::array<NamesOfRank, 3> kNormalLoadNames = {{
    {"normal load", "normal force", "normalkraft", "charge normale", "force normale"},
    {"normal", "n load"},
    {"fn", "f n", "N"},  // n counts the samples
}};
constexpr std::array<NamesOfRank, 2> kResponseNames = {{
    {"stiffness", "tangential stiffness", "contact stiffness", "secant stiffness",
     "tangent stiffness", "compliance", "contact compliance"},
    {"kt", "k", "K"},
}};

struct Role {
  std::string_view name;
  std::span<const NamesOfRank> names;  ///< of its column
  std::optional<Unit> (*find_unit)(std::string_view);
  std::string (*unit_symbols)();
  std::string_view si_unit;
  std::string_view option;  ///< command-line option that names the column
};

constexpr Role kDisplacement{
    "displacement", kDisplacementNames, LengthUnit, LengthUnitSymbols, "m", "--displacement"};
constexpr Role kForce{"force", kForceNames, ForceUnit, ForceUnitSymbols, "N", "--force"};
constexpr Role kAngle{"displacement", kDisplacementNames, AngleUnit, AngleUnitSymbols,
                      "rad",          "--displacement"};
constexpr Role kTorque{"force", kForceNames, TorqueUnit, TorqueUnitSymbols, "N m", "--force"};
constexpr Role kTime{"time", kTimeNames, TimeUnit, TimeUnitSymbols, "s", "--time"};
constexpr Role kCovariate{"covariate", {}, nullptr, nullptr, "", "--covariate"};
constexpr Role kNormalLoad{"normal load", kNormalLoadNames,      ForceUnit, ForceUnitSymbols,
                           "N",           "--normal-load-column"};

std::string ForceOrTorqueUnitSymbols() { return ForceUnitSymbols() + ", " + TorqueUnitSymbols(); }
std::string LengthOrAngleUnitSymbols() { return LengthUnitSymbols() + ", " + AngleUnitSymbols(); }
std::optional<Unit> LengthOrAngleUnit(std::string_view symbol) {
  const std::optional<Unit> length = LengthUnit(symbol);
  return length ? length : AngleUnit(symbol);
}

/// A joint carries a torque, a twisted contact a normal load.
constexpr Role kLoadOfTorsion{
    "normal load", kNormalLoadNames,      ForceOrTorqueUnit, ForceOrTorqueUnitSymbols,
    "N",           "--normal-load-column"};

/// Column of the motion that drives a simulated contact or joint.
constexpr Role kDrive{
    "displacement",  kDisplacementNames, LengthOrAngleUnit, LengthOrAngleUnitSymbols, "m",
    "--displacement"};

/// Returns the unit of one quantity over another, "N/um".
std::optional<Unit> RatioUnit(std::string_view symbol,
                              std::optional<Unit> (*above)(std::string_view),
                              std::optional<Unit> (*below)(std::string_view)) {
  const std::size_t slash = symbol.find('/');
  if (slash == std::string_view::npos) return std::nullopt;
  const std::optional<Unit> numerator = above(symbol.substr(0, slash));
  const std::optional<Unit> denominator = below(symbol.substr(slash + 1));
  if (!numerator || !denominator) return std::nullopt;
  return Unit{.symbol = std::string(symbol),
              .numerator = numerator->numerator * denominator->denominator,
              .denominator = numerator->denominator * denominator->numerator};
}

constexpr Role kStiffness{
    "stiffness",
    kResponseNames,
    [](std::string_view symbol) { return RatioUnit(symbol, ForceUnit, LengthUnit); },
    [] { return std::string("a force over a length, as N/um"); },
    "N/m",
    "--response"};
constexpr Role kCompliance{
    "compliance",
    kResponseNames,
    [](std::string_view symbol) { return RatioUnit(symbol, LengthUnit, ForceUnit); },
    [] { return std::string("a length over a force, as um/N"); },
    "m/N",
    "--response"};

/// Lower case, with '_' and '-' as blanks; a name of one letter stays as it is.
std::string Normalized(std::string_view name) {
  if (name.size() == 1) return std::string(name);
  std::string normalized = LowerCase(name);
  std::ranges::replace_if(
      normalized, [](char character) { return character == '_' || character == '-'; }, ' ');
  return normalized;
}

/// Returns the row of a name; empty where it is in none.
std::optional<std::size_t> Rank(std::span<const NamesOfRank> ranks, std::string_view name) {
  if (name.empty()) return std::nullopt;
  const std::string normalized = Normalized(name);
  for (std::size_t rank = 0; rank < ranks.size(); ++rank) {
    if (std::ranges::find(ranks[rank], normalized) != ranks[rank].end()) return rank;
  }
  return std::nullopt;
}

bool IsVelocity(const ColumnName& column) {
  constexpr std::array<std::string_view, 4> kNames = {"velocity", "speed", "vel", "v"};
  const std::string name = Normalized(column.name);
  return std::ranges::find(kNames, name) != kNames.end() || name.ends_with(" velocity") ||
         name.ends_with(" speed") || column.unit.ends_with("/s");
}

/// Finds columns and units in one table by name.
class ColumnFinder {
 public:
  explicit ColumnFinder(const CsvTable& table) : ColumnFinder(table, table.names()) {}
  /// @param names  by which columns are recognised, in place of the table's
  ColumnFinder(const CsvTable& table, const std::vector<std::string>& names) : table_(table) {
    for (const std::string& name : names) split_.push_back(SplitColumnName(name));
  }

  /// The column, from 0, that the user calls `choice`.
  std::size_t Chosen(std::string_view choice, const Role& role) const {
    if (const auto number = NumberIn<std::size_t>(choice)) {
      if (*number >= 1 && *number <= table_.columns()) return *number - 1;
      throw InputError(fmt::format("{}: there is no column {} for the {}: the file has {} column{}",
                                   table_.file(), choice, role.name, table_.columns(),
                                   table_.columns() == 1 ? "" : "s"));
    }
    if (const auto column = Named(choice, role)) return *column;
    throw InputError(fmt::format("{}: {}", table_.file(), Unknown(choice, role)));
  }

  std::optional<std::size_t> Named(std::string_view choice, const Role& role) const {
    const std::string lower = LowerCase(choice);
    const auto full = [&](std::size_t column) -> std::string_view {
      return table_.names()[column];
    };
    const std::array<std::function<bool(std::size_t)>, 3> matches = {
        [&](std::size_t column) { return full(column) == choice; },
        [&](std::size_t column) { return LowerCase(full(column)) == lower; },
        [&](std::size_t column) { return LowerCase(split_[column].name) == lower; }};
    for (const auto& match : matches) {
      std::vector<std::size_t> found;
      for (std::size_t column = 0; column < split_.size(); ++column) {
        if (match(column)) found.push_back(column);
      }
      if (found.size() > 1) ThrowAmbiguous(role, found);
      if (found.size() == 1) return found.front();
    }
    return std::nullopt;
  }

  /// "no column is called 'z' (for the force): the columns are …".
  [[nodiscard]] std::string Unknown(std::string_view choice, const Role& role) const {
    return fmt::format("no column is called '{}' (for the {}){} {}", choice, role.name,
                       DidYouMean(choice, Names()), Listing());
  }

  /// The columns that the user gives for a role.
  [[nodiscard]] Expression Read(const std::string& text, const Role& role) const {
    return ReadExpression(
        text, table_.columns(), [&](std::string_view name) { return Named(name, role); },
        fmt::format("{}: {} {}", table_.file(), role.option, text),
        [&](std::string_view name) { return Unknown(name, role); });
  }

  /// The best match for a role among the columns that are not `taken`.
  std::optional<std::size_t> Recognized(const Role& role, const std::vector<bool>& taken) const {
    std::vector<std::size_t> best;
    std::optional<std::size_t> best_rank;
    for (std::size_t column = 0; column < split_.size(); ++column) {
      if (taken[column]) continue;
      std::optional<std::size_t> rank = Rank(role.names, table_.names()[column]);
      if (!rank) rank = Rank(role.names, split_[column].name);
      if (!rank || (best_rank && *rank > *best_rank)) continue;
      if (rank != best_rank) best.clear();
      best_rank = rank;
      best.push_back(column);
    }
    if (best.size() > 1) ThrowAmbiguous(role, best);
    if (best.empty()) return std::nullopt;
    return best.front();
  }

  /// The unit that the header states for a column, "" when it states none.
  /// @param option  with which the user states it
  std::string HeaderUnit(std::size_t column, std::string_view option) const {
    const std::string of_name = UnitOfName(column);
    const std::string of_row = UnitOfRow(column);
    if (!StatesOneUnit(column)) {
      throw InputError(fmt::format(
          "{}: {} has the unit '{}' in its name and '{}' below it: choose its unit{}", Header(),
          Label(column), of_name, of_row,
          option.empty() ? "" : fmt::format(" with {} '{} [{}]'", option, column + 1, of_name)));
    }
    return of_name.empty() ? of_row : of_name;
  }

  /// True unless header and units row state two different units.
  [[nodiscard]] bool StatesOneUnit(std::size_t column) const {
    const std::string of_name = UnitOfName(column);
    const std::string of_row = UnitOfRow(column);
    return of_name.empty() || of_row.empty() || of_name == of_row;
  }

  /// The header's name of a column, without its unit, where no other has the same; else its number.
  [[nodiscard]] std::string NameOf(std::size_t column) const {
    const auto same = [&](const ColumnName& other) { return other.name == split_[column].name; };
    const bool is_named =
        !split_.empty() && !split_[column].name.empty() && std::ranges::count_if(split_, same) == 1;
    return is_named ? split_[column].name : std::to_string(column + 1);
  }

  [[nodiscard]] bool IsAngle(std::size_t column) const {
    return !split_.empty() && Rank(kDisplacementNames, split_[column].name) == kRankOfAngles;
  }

  [[nodiscard]] bool IsVelocity(std::size_t column) const {
    return !split_.empty() && io::IsVelocity(split_[column]);
  }

  /// "'x [mm]' (column 2)", or "column 2" without a header.
  std::string Label(std::size_t column) const {
    if (table_.names().empty()) return fmt::format("column {}", column + 1);
    return fmt::format("'{}' (column {})", ForMessage(table_.names()[column]), column + 1);
  }

  /// Returns the names as a message shows them, without their units.
  [[nodiscard]] std::vector<std::string> Names() const {
    std::vector<std::string> names;
    names.reserve(split_.size());
    for (const ColumnName& column : split_) names.push_back(ForMessage(column.name));
    return names;
  }

  /// "the columns are 'x' (1), 'F' (2)".
  std::string Listing() const {
    if (table_.names().empty()) {
      return fmt::format("the file names none of its {} columns: choose by number",
                         table_.columns());
    }
    std::string listing = "the columns are ";
    for (std::size_t column = 0; column < split_.size(); ++column) {
      listing += fmt::format("{}'{}' ({})", column == 0 ? "" : ", ",
                             ForMessage(table_.names()[column]), column + 1);
    }
    return listing;
  }

  /// "file:line" of the header.
  std::string Header() const { return fmt::format("{}:{}", table_.file(), table_.header_line()); }

 private:
  [[nodiscard]] std::string UnitOfName(std::size_t column) const {
    return split_.empty() ? "" : split_[column].unit;
  }
  [[nodiscard]] std::string UnitOfRow(std::size_t column) const {
    return table_.units().empty() ? "" : std::string(WithoutBrackets(table_.units()[column]));
  }

  [[noreturn]] void ThrowAmbiguous(const Role& role, std::span<const std::size_t> found) const {
    std::string labels;
    std::string choices;
    for (const std::size_t column : found) {
      labels += fmt::format("{}{}", labels.empty() ? "" : " and ", Label(column));
      choices += fmt::format("{}{} {}", choices.empty() ? "" : " or ", role.option, column + 1);
    }
    throw InputError(
        fmt::format("{}: {} may each be the {}: give {}", Header(), labels, role.name, choices));
  }

  const CsvTable& table_;
  std::vector<ColumnName> split_;
};

/// States that a column in a unit of pressure cannot have a role.
std::string PressureText(std::string_view column, std::string_view unit, const Role& role) {
  return fmt::format(
      "{} is a pressure, in {}, and no {}: choose another column; pressure times area is an "
      "additional force, for which there is --covariate",
      column, unit, role.name);
}

/// Reads columns of one table in SI units.
class ColumnReader {
 public:
  ColumnReader(const CsvTable& table, const ColumnFinder& finder, std::vector<std::string>& notes)
      : table_(table), finder_(finder), notes_(notes) {}

  /// @throws InputError when the choice's unit, or else the header's, is not one for the role.
  Unit FindUnit(const Role& role, std::size_t column, const Expression& choice) {
    const std::string& chosen = choice.unit;
    if (!chosen.empty()) {
      if (const auto unit = role.find_unit(chosen)) return *unit;
      if (IsPressureUnit(chosen)) {
        throw InputError(PressureText(fmt::format("{}: {}", table_.file(), finder_.Label(column)),
                                      chosen, role));
      }
      throw InputError(fmt::format("{}: the {} unit '{}' is not known: must be one of {}",
                                   table_.file(), role.name, ForMessage(chosen),
                                   role.unit_symbols()));
    }
    const std::string stated = finder_.HeaderUnit(column, role.option);
    if (stated.empty()) {
      notes_.push_back(fmt::format("{}: {} {} names no unit: taken as {}; {} '{} [{}]' says so",
                                   table_.file(), role.name, finder_.Label(column), role.si_unit,
                                   role.option, column + 1, role.si_unit));
      return {.symbol = std::string(role.si_unit)};
    }
    if (const auto unit = role.find_unit(stated)) return *unit;
    if (choice.is_scaled) return {.symbol = std::string(role.si_unit)};
    if (IsPressureUnit(stated)) {
      throw InputError(PressureText(
          fmt::format("{}:{}: {}", finder_.Header(), column + 1, finder_.Label(column)), stated,
          role));
    }
    throw InputError(
        fmt::format("{}:{}: the unit '{}' of {} is not known for the {}: must be one "
                    "of {}, or choose the unit with {} '{} [{}]'",
                    finder_.Header(), column + 1, ForMessage(stated), finder_.Label(column),
                    role.name, role.unit_symbols(), role.option, column + 1, role.si_unit));
  }

  /// True if the two are an angle and a torque: by their units, and by name where there is none.
  /// @throws InputError when only one of them is
  bool IsTorsional(std::size_t displacement, const Expression& displacement_choice,
                   std::size_t force, const Expression& force_choice) const {
    const auto stated = [&](const Role& role, std::size_t column, const Expression& choice) {
      return choice.unit.empty() ? finder_.HeaderUnit(column, role.option) : choice.unit;
    };
    const std::string displacement_unit = stated(kDisplacement, displacement, displacement_choice);
    const std::string force_unit = stated(kForce, force, force_choice);
    const bool is_angle = displacement_unit.empty() ? finder_.IsAngle(displacement)
                                                    : AngleUnit(displacement_unit).has_value();
    const bool is_torque = TorqueUnit(force_unit).has_value();
    const bool is_length = LengthUnit(displacement_unit).has_value();
    const bool is_force = ForceUnit(force_unit).has_value();
    if ((is_angle && is_force) || (is_torque && is_length)) {
      throw InputError(fmt::format(
          "{}: {} in {} and {} in {} do not match: a torque needs an angle, a force a length; "
          "choose other columns, or give their units, as in --force '{} [N]'",
          table_.file(), finder_.Label(displacement),
          displacement_unit.empty() ? "rad" : displacement_unit, finder_.Label(force), force_unit,
          force + 1));
    }
    return is_angle || is_torque;
  }

  std::vector<double> Read(const Role& role, std::size_t column, const Unit& unit,
                           const Expression& choice) {
    std::vector<double> values(table_.rows(), choice.offset);
    const auto add = [&](std::size_t of_column, double weight) {
      const std::span<const double> numbers = table_.Numbers(of_column);
      for (std::size_t row = 0; row < values.size(); ++row) values[row] += weight * numbers[row];
    };
    if (choice.terms.empty()) add(column, 1.0);
    for (const Expression::Term& term : choice.terms) add(term.column, term.weight);
    for (std::size_t row = 0; row < values.size(); ++row) {
      const double value = values[row];
      values[row] = unit.ToSi(value);
      if (!std::isfinite(values[row])) {
        throw InputError(fmt::format("{}:{}:{}: {} = {} {} is too large: must be below 1.8e308 {}",
                                     table_.file(), table_.lines()[row], column + 1, role.name,
                                     value, unit.symbol, role.si_unit));
      }
    }
    return values;
  }

  ChosenColumn Describe(std::size_t column, const Unit& unit, const Expression& choice,
                        const std::string& text) const {
    const bool is_sum = choice.is_scaled || choice.terms.size() > 1;
    return {.name = is_sum                   ? text
                    : table_.names().empty() ? ""
                                             : table_.names()[column],
            .index = column + 1,
            .unit = unit.symbol};
  }

 private:
  const CsvTable& table_;
  const ColumnFinder& finder_;
  std::vector<std::string>& notes_;
};

bool IsStrictlyMonotone(std::span<const double> values) {
  if (values.size() < 3) return false;
  const bool grows = values[1] > values[0];
  for (std::size_t i = 1; i < values.size(); ++i) {
    if (!(grows ? values[i] > values[i - 1] : values[i] < values[i - 1])) return false;
  }
  return true;
}

/// Both rises and falls by a good part of its range on the way: noise does not, nor does a friction
/// force along a single stroke. Half the range is what one cycle from the middle has.
bool GoesToAndFro(std::span<const double> values) {
  double least = std::numeric_limits<double>::infinity();
  double greatest = -least;
  double rise = 0.0;
  double fall = 0.0;
  for (const double value : values) {
    least = std::min(least, value);
    greatest = std::max(greatest, value);
    rise = std::max(rise, value - least);
    fall = std::max(fall, greatest - value);
  }
  constexpr double kGoodPart = 0.4;
  return std::min(rise, fall) > kGoodPart * (greatest - least);
}

std::string WithoutAmplitude(const std::string& name) {
  constexpr std::string_view kWord = "amplitude";
  const std::size_t at = LowerCase(name).find(kWord);
  if (at == std::string::npos || at == 0) return name;
  std::string rest = name.substr(0, at - 1) + name.substr(at + kWord.size());
  return rest;
}

/// Columns from 0, by role.
struct Assignment {
  std::size_t displacement = 0;
  std::size_t force = 1;
  std::optional<std::size_t> time, normal_load;
};

class RoleAssigner {
 public:
  RoleAssigner(const CsvTable& table, const ColumnFinder& finder, std::vector<std::string>& notes)
      : table_(table), finder_(finder), notes_(notes), taken_(table.columns(), false) {}

  Assignment Assign(const GivenColumns& columns, const std::vector<std::string>& covariates) {
    std::optional<std::size_t> displacement = TakeChosen(kDisplacement, columns.displacement);
    std::optional<std::size_t> force = TakeChosen(kForce, columns.force);
    std::optional<std::size_t> time = TakeChosen(kTime, columns.time);
    std::optional<std::size_t> normal_load = TakeChosen(kNormalLoad, columns.normal_load);
    TakeRecognized(kDisplacement, displacement);
    TakeRecognized(kForce, force);
    TakeRecognized(kTime, time);
    // A load that is fitted as a force of its own is not also the law's, unless it is asked to be.
    for (const std::string& covariate : covariates) {
      taken_[finder_.Chosen(covariate, kCovariate)] = true;
    }
    TakeRecognized(kNormalLoad, normal_load);
    const bool is_guessed = !displacement;
    if (!displacement) nameless_.push_back(&kDisplacement);
    if (!force) nameless_.push_back(&kForce);
    named_ = taken_;
    const Assignment assigned{
        .displacement = displacement ? *displacement : TakeByPosition(kDisplacement, 0),
        .force = force ? *force : TakeByPosition(kForce, 1),
        .time = time,
        .normal_load = normal_load};
    if (is_guessed) RequireDisplacement(assigned.displacement);
    return assigned;
  }

 private:
  std::optional<std::size_t> TakeChosen(const Role& role, const Expression& choice) {
    for (const Expression::Term& term : choice.terms) {
      if (taken_[term.column]) {
        throw InputError(
            fmt::format("{}: {} is chosen for the {} and for another quantity: choose two columns",
                        table_.file(), finder_.Label(term.column), role.name));
      }
      taken_[term.column] = true;
    }
    if (choice.terms.empty()) return std::nullopt;
    return choice.terms.front().column;
  }

  void TakeRecognized(const Role& role, std::optional<std::size_t>& column) {
    if (column) return;
    column = finder_.Recognized(role, taken_);
    if (column) taken_[*column] = true;
  }

  std::size_t TakeByPosition(const Role& role, std::size_t position) {
    std::size_t column = position;
    const bool is_free = position < taken_.size() && !taken_[position];
    if (!is_free && std::ranges::count(taken_, false) == 1) {
      column = static_cast<std::size_t>(std::ranges::find(taken_, false) - taken_.begin());
    } else if (!is_free) {
      throw InputError(fmt::format("{}: no column for the {}: {}", table_.file(), role.name,
                                   table_.columns() == 1
                                       ? "the file has 1 column"
                                       : fmt::format("{}: {}", finder_.Listing(), HowToName())));
    }
    taken_[column] = true;
    notes_.push_back(fmt::format("{}: no column name is recognised as {}: taken from {}",
                                 table_.file(), role.name, finder_.Label(column)));
    return column;
  }

  /// Refuses a column taken for the displacement that is a velocity or looks like a time.
  void RequireDisplacement(std::size_t column) const {
    const std::string where = fmt::format("{}:{}:{}: {}", table_.file(), table_.lines().front(),
                                          column + 1, finder_.Label(column));
    if (finder_.IsVelocity(column)) {
      throw InputError(fmt::format("{} is a velocity: {}", where, HowToName(column)));
    }
    if (!IsStrictlyMonotone(table_.NumbersOrNan(column))) return;
    for (std::size_t other = 0; other < table_.columns(); ++other) {
      if (!GoesToAndFro(table_.NumbersOrNan(other))) continue;
      throw InputError(fmt::format(
          "{} only {} while {} goes to and fro, as a time does: {}", where,
          table_.NumbersOrNan(column)[1] > table_.NumbersOrNan(column)[0] ? "grows" : "falls",
          finder_.Label(other), HowToName(column)));
    }
  }

  /// "name the column of the force with --force, as in --force 3": of all roles that no column's
  /// name decides, by the first columns that have no other.
  /// @param refused  a column that is none of them
  [[nodiscard]] std::string HowToName(std::optional<std::size_t> refused = std::nullopt) const {
    std::string rule;
    std::string example;
    std::size_t column = 0;
    for (const Role* role : nameless_) {
      rule += fmt::format("{} the {} with {}", rule.empty() ? "name the column of" : " and that of",
                          role->name, role->option);
      while (column < named_.size() && (named_[column] || column == refused)) ++column;
      if (column == named_.size()) continue;
      example += fmt::format("{} {} {}", example.empty() ? ", as in" : "", role->option, ++column);
    }
    return rule + example;
  }

  const CsvTable& table_;
  const ColumnFinder& finder_;
  std::vector<std::string>& notes_;
  std::vector<bool> taken_;
  std::vector<bool> named_;            // taken by choice or by name
  std::vector<const Role*> nameless_;  // of displacement and force
};

/// Returns why a column that nobody asked for cannot be used; "" when it can.
std::string WhyUnusable(const CsvTable& table, const ColumnFinder& finder, const Role& role,
                        std::size_t column, const Expression& choice) {
  if (!table.HasNumbers(column)) return "holds no numbers";
  if (choice.is_scaled) return "";
  const std::string stated = choice.unit.empty() ? finder.HeaderUnit(column, role.option) : "";
  if (IsPressureUnit(stated)) return fmt::format("is a pressure, in {}", stated);
  if (!stated.empty() && !role.find_unit(stated)) {
    return fmt::format("has the unit '{}', not one of {}", stated, role.unit_symbols());
  }
  return "";
}

/// Reads the columns chosen in addition to displacement and force, then some of the others.
class CovariateReader {
 public:
  CovariateReader(const CsvTable& table, const ColumnFinder& finder, const Assignment& assigned,
                  RecordFile& file)
      : table_(table), finder_(finder), assigned_(assigned), file_(file) {}

  /// @throws InputError where one is no column, chosen twice, or has a role that forbids it
  void ReadChosen(std::span<const std::string> choices) {
    for (const std::string& choice : choices) {
      const std::size_t column = finder_.Chosen(choice, kCovariate);
      for (const auto& [role, taken] : {std::pair(&kDisplacement, assigned_.displacement),
                                        std::pair(&kForce, assigned_.force)}) {
        if (column != taken) continue;
        throw InputError(fmt::format("{}: {} is the {} already: choose another column for the {}",
                                     table_.file(), finder_.Label(column), role->name,
                                     kCovariate.name));
      }
      if (IsRead(column)) {
        throw InputError(fmt::format("{}: {} is chosen twice as a {}: choose it once",
                                     table_.file(), finder_.Label(column), kCovariate.name));
      }
      Add(column, choice, table_.Numbers(column));
    }
  }

  void ReadOthers() {
    const std::array<std::optional<std::size_t>, 4> roles = {
        assigned_.displacement, assigned_.force, assigned_.time, assigned_.normal_load};
    std::size_t left = kMostOtherColumns;
    for (std::size_t column = 0; column < table_.columns() && left > 0; ++column) {
      if (IsRead(column) || std::ranges::find(roles, column) != roles.end()) continue;
      const std::span<const double> numbers = table_.NumbersOrNan(column);
      const bool all_there =
          std::ranges::all_of(numbers, [](double number) { return std::isfinite(number); });
      const bool is_clear = finder_.StatesOneUnit(column);
      if (!all_there || !is_clear ||
          std::ranges::adjacent_find(numbers, std::not_equal_to<>()) == numbers.end())
        continue;
      Add(column, finder_.NameOf(column), numbers);
      --left;
    }
  }

 private:
  [[nodiscard]] bool IsRead(std::size_t column) const {
    return std::ranges::find(file_.covariates, column + 1, &ChosenColumn::index) !=
           file_.covariates.end();
  }

  void Add(std::size_t column, const std::string& name, std::span<const double> numbers) {
    const std::string unit = finder_.HeaderUnit(column, kCovariate.option);
    file_.covariates.push_back({.name = name, .index = column + 1, .unit = unit});
    file_.record.covariates.push_back(
        {.name = name, .unit = unit, .values = {numbers.begin(), numbers.end()}});
  }

  const CsvTable& table_;
  const ColumnFinder& finder_;
  const Assignment& assigned_;
  RecordFile& file_;
};

/// One column of a path: that chosen, or the first; or, where the first is a time, the one that is
/// recognised. Taking SI for granted is the documented default here.
std::vector<double> ReadPathColumn(const CsvTable& table, const Role& role,
                                   const std::string& text) {
  const ColumnFinder finder(table);
  const Expression choice = finder.Read(text, role);
  std::size_t column = 0;
  if (!choice.terms.empty()) {
    column = choice.terms.front().column;
  } else {
    const std::vector<bool> none_taken(table.columns(), false);
    const bool first_is_time = finder.Recognized(kTime, none_taken) == std::size_t{0};
    if (first_is_time) column = finder.Recognized(role, none_taken).value_or(0);
  }
  std::vector<std::string> notes;
  ColumnReader reader(table, finder, notes);
  return reader.Read(role, column, reader.FindUnit(role, column, choice), choice);
}

}  // namespace

std::optional<Unit> ForceOrTorqueUnit(std::string_view symbol) {
  const std::optional<Unit> force = ForceUnit(symbol);
  return force ? force : TorqueUnit(symbol);
}

void JoinedTimes::Shift(std::vector<double>& times) {
  if (times.empty()) return;
  if (begins_ && times.front() + shift_ < last_) shift_ = last_ + step_ - times.front();
  begins_ = false;
  for (double& time : times) time += shift_;
  if (times.size() > 1) step_ = times.back() - times[times.size() - 2];
  last_ = times.back();
}

void RequireJoinable(const RecordFile& first, const std::string& first_name, const RecordFile& next,
                     const std::string& next_name) {
  const auto require = [&](bool same, std::string_view what) {
    if (same) return;
    throw InputError(
        fmt::format("--join: one of {} and {} has {} and the other does not: pieces of one record "
                    "must have the same columns",
                    first_name, next_name, what));
  };
  require(next.time.has_value() == first.time.has_value(), "a time");
  require(next.normal_load.has_value() == first.normal_load.has_value(), "a normal load");
  require(next.is_torsional == first.is_torsional, "a torque");
}

RecordFile Joined(std::vector<RecordFile> records, const std::vector<std::string>& names) {
  RecordFile joined = std::move(records.front());
  joined.lines.clear();
  JoinedTimes times;
  times.Shift(joined.record.time);
  for (std::size_t k = 1; k < records.size(); ++k) {
    RecordFile& next = records[k];
    RequireJoinable(joined, names.front(), next, names[k]);
    times.NextFile();
    times.Shift(next.record.time);
    const auto append = [](const std::vector<double>& from, std::vector<double>& to) {
      to.insert(to.end(), from.begin(), from.end());
    };
    loop::Record& record = joined.record;
    append(next.record.displacement, record.displacement);
    append(next.record.force, record.force);
    append(next.record.time, record.time);
    append(next.record.normal_load, record.normal_load);
    for (std::size_t c = record.covariates.size(); c-- > 0;) {
      const auto same = std::ranges::find(next.record.covariates, record.covariates[c].name,
                                          &loop::Covariate::name);
      if (same != next.record.covariates.end()) {
        append(same->values, record.covariates[c].values);
      } else {
        record.covariates.erase(record.covariates.begin() + static_cast<std::ptrdiff_t>(c));
        joined.covariates.erase(joined.covariates.begin() + static_cast<std::ptrdiff_t>(c));
      }
    }
    joined.notes.insert(joined.notes.end(), next.notes.begin(), next.notes.end());
  }
  return joined;
}

GivenColumns ReadGivenColumns(const CsvTable& table, const RecordColumns& columns) {
  const ColumnFinder finder(table);
  return {.displacement = finder.Read(columns.displacement, kDisplacement),
          .force = finder.Read(columns.force, kForce),
          .time = finder.Read(columns.time, kTime),
          .normal_load = finder.Read(columns.normal_load, kNormalLoad)};
}

RecordFile RecordOfRows(const CsvTable& table, const RecordColumns& columns) {
  const ColumnFinder finder(table);
  RecordFile file;
  file.notes = table.notes();
  if (table.preamble_rows() > 0) {
    file.notes.push_back(fmt::format("{}: {} row{} above the header skipped", finder.Header(),
                                     table.preamble_rows(), table.preamble_rows() == 1 ? "" : "s"));
  }
  const GivenColumns given = ReadGivenColumns(table, columns);
  const Assignment assigned =
      RoleAssigner(table, finder, file.notes).Assign(given, columns.covariates);
  ColumnReader reader(table, finder, file.notes);

  const auto read = [&](const Role& role, std::size_t column, const Expression& choice,
                        const std::string& text, std::vector<double>& values) {
    const Unit unit = reader.FindUnit(role, column, choice);
    values = reader.Read(role, column, unit, choice);
    return reader.Describe(column, unit, choice, text);
  };
  const auto read_optional = [&](const Role& role, std::optional<std::size_t> column,
                                 const Expression& choice, const std::string& text,
                                 std::vector<double>& values) -> std::optional<ChosenColumn> {
    if (!column && !choice.unit.empty()) {
      throw InputError(fmt::format("{}: {} {}: no column is recognised as the {}: name it",
                                   table.file(), role.option, text, role.name));
    }
    if (!column) return std::nullopt;
    if (choice.terms.empty()) {
      const std::string fault = WhyUnusable(table, finder, role, *column, choice);
      if (!fault.empty()) {
        file.notes.push_back(fmt::format("{}: {} {} {}: left out", table.file(), role.name,
                                         finder.Label(*column), fault));
        return std::nullopt;
      }
    }
    return read(role, *column, choice, text, values);
  };
  loop::Record& record = file.record;
  file.lines = table.lines();
  file.is_torsional =
      reader.IsTorsional(assigned.displacement, given.displacement, assigned.force, given.force);
  file.displacement = read(file.is_torsional ? kAngle : kDisplacement, assigned.displacement,
                           given.displacement, columns.displacement, record.displacement);
  file.force = read(file.is_torsional ? kTorque : kForce, assigned.force, given.force,
                    columns.force, record.force);
  std::optional<std::vector<double>> clock;
  if (assigned.time) clock = table.Times(*assigned.time);
  if (clock) {
    record.time = std::move(*clock);
    file.time = reader.Describe(*assigned.time, {.symbol = "s"}, {}, "");
    file.time->is_clock = true;
    file.notes.push_back(fmt::format(
        "{}: time {} holds times of day: taken as seconds since midnight of the first one's day",
        table.file(), finder.Label(*assigned.time)));
  } else {
    file.time = read_optional(kTime, assigned.time, given.time, columns.time, record.time);
  }
  if (columns.sample_rate) {
    if (!(*columns.sample_rate > 0) || !std::isfinite(*columns.sample_rate)) {
      throw InputError(
          fmt::format("--sample-rate {}: must be finite and > 0 Hz", *columns.sample_rate));
    }
    if (!columns.time.empty()) {
      throw InputError(
          fmt::format("{}: --time and --sample-rate exclude each other", table.file()));
    }
    file.time.reset();
    record.time.resize(table.rows());
    for (std::size_t row = 0; row < table.rows(); ++row) {
      record.time[row] = static_cast<double>(row) / *columns.sample_rate;
    }
  }
  file.normal_load =
      read_optional(file.is_torsional ? kLoadOfTorsion : kNormalLoad, assigned.normal_load,
                    given.normal_load, columns.normal_load, record.normal_load);
  if (table.MayHaveCommasForThousands(assigned.displacement) &&
      table.MayHaveCommasForThousands(assigned.force)) {
    file.notes.push_back(fmt::format(
        "{}: every {} and {} is written like 1,234: the comma is taken as a decimal mark, as in "
        "1.234; leave it out where it separates thousands",
        table.file(), kDisplacement.name, kForce.name));
  }
  if (table.short_rows() > 0) {
    file.notes.push_back(fmt::format("{}: {} of {} rows have no cell for {}: left out",
                                     table.file(), table.short_rows(), table.rows(),
                                     finder.Label(table.columns() - 1)));
  }
  CovariateReader covariates(table, finder, assigned, file);
  covariates.ReadChosen(columns.covariates);
  covariates.ReadOthers();
  return file;
}

std::string DescribeTimeFault(double time, double time_above, std::string_view unit) {
  if (!(time < time_above)) return "";
  return fmt::format(
      "time = {} {} is before the {} {} of the row above: times must not fall; sort the rows, "
      "split the file where a clock starts again, or rename the column if it holds no time",
      time, unit, time_above, unit);
}

RecordFile RecordOf(const CsvTable& table, const RecordColumns& columns) {
  RecordFile file = RecordOfRows(table, columns);
  if (!file.time) return file;
  const std::span<const double> times =
      file.time->is_clock ? file.record.time : table.NumbersOrNan(file.time->index - 1);
  for (std::size_t row = 1; row < times.size(); ++row) {
    const std::string fault = DescribeTimeFault(times[row], times[row - 1], file.time->unit);
    if (fault.empty()) continue;
    throw InputError(
        fmt::format("{}:{}:{}: {}", table.file(), file.lines[row], file.time->index, fault));
  }
  return file;
}

RecordFile ReadRecord(const std::filesystem::path& path, const RecordColumns& columns,
                      const ReadLimits& limits) {
  return RecordOf(ReadCsvTable(path, limits, columns.encoding), columns);
}

SweepFile ReadSweep(const std::filesystem::path& path, const RecordColumns& columns,
                    const std::string& response) {
  return SweepOf(ReadCsvTable(path, {}, columns.encoding), columns, response);
}

SweepFile SweepOf(const CsvTable& table, const RecordColumns& columns,
                  const std::string& response) {
  std::vector<std::string> names;
  for (const std::string& name : table.names()) names.push_back(WithoutAmplitude(name));
  const ColumnFinder finder(table, names);
  SweepFile sweep;
  sweep.notes = table.notes();
  sweep.lines = table.lines();
  std::vector<bool> taken(table.columns(), false);
  const Expression given_response = finder.Read(response, kStiffness);
  const Expression given_displacement = finder.Read(columns.displacement, kDisplacement);
  const Expression given_force = finder.Read(columns.force, kForce);
  const auto find = [&](const Role& role, const Expression& choice) {
    const std::optional<std::size_t> column = choice.terms.empty()
                                                  ? finder.Recognized(role, taken)
                                                  : std::optional(choice.terms.front().column);
    if (column) taken[*column] = true;
    return column;
  };
  const std::optional<std::size_t> responses = find(kStiffness, given_response);
  std::optional<std::size_t> displacement;
  std::optional<std::size_t> force;
  if (given_force.terms.empty()) displacement = find(kDisplacement, given_displacement);
  if (given_displacement.terms.empty()) force = find(kForce, given_force);
  if (!responses) {
    throw InputError(
        fmt::format("{}: no column of a stiffness or compliance is recognised: name it "
                    "with --response: {}",
                    table.file(), finder.Listing()));
  }
  if (displacement.has_value() == force.has_value()) {
    throw InputError(fmt::format(
        "{}: {} of the amplitude is recognised: name the one with --displacement or --force: {}",
        table.file(), force ? "more than one column" : "no column", finder.Listing()));
  }
  sweep.over_force = force.has_value();
  ColumnReader reader(table, finder, sweep.notes);
  const Role& role = sweep.over_force ? kForce : kDisplacement;
  const Expression& choice = sweep.over_force ? given_force : given_displacement;
  const std::size_t amplitudes = sweep.over_force ? *force : *displacement;
  sweep.amplitude =
      reader.Read(role, amplitudes, reader.FindUnit(role, amplitudes, choice), choice);
  const std::string stated = given_response.unit.empty()
                                 ? finder.HeaderUnit(*responses, kStiffness.option)
                                 : given_response.unit;
  sweep.is_compliance = stated.empty() ? finder.NameOf(*responses).starts_with("compliance")
                                       : RatioUnit(stated, LengthUnit, ForceUnit).has_value();
  const Role& kind = sweep.is_compliance ? kCompliance : kStiffness;
  sweep.response = reader.Read(kind, *responses, reader.FindUnit(kind, *responses, given_response),
                               given_response);
  for (std::size_t row = 0; row < table.rows(); ++row) {
    for (const auto& [values, column] :
         {std::pair{&sweep.amplitude, amplitudes}, std::pair{&sweep.response, *responses}}) {
      if ((*values)[row] > 0) continue;
      throw InputError(
          fmt::format("{}:{}:{}: {} in SI units must be > 0 in a sweep: remove the row",
                      table.file(), table.lines()[row], column + 1, (*values)[row]));
    }
  }
  return sweep;
}

std::vector<double> ReadDisplacementPath(const std::filesystem::path& path,
                                         const std::string& displacement) {
  const CsvTable table = ReadCsvTable(path);
  return ReadPathColumn(table, kDrive, displacement);
}

LoadedPath ReadLoadedPath(const std::filesystem::path& path, const std::string& displacement,
                          const std::string& normal_load) {
  const CsvTable table = ReadCsvTable(path);
  return {ReadPathColumn(table, kDrive, displacement),
          ReadPathColumn(table, kLoadOfTorsion, normal_load)};
}

ForcePath ReadForcePath(const std::filesystem::path& path, const std::string& force) {
  const CsvTable table = ReadCsvTable(path);
  return {ReadPathColumn(table, kForce, force), table.lines()};
}

}  // namespace mindahl::io
