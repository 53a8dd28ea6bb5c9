#include "io/roles.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <ranges>
#include <utility>

#include "core/text.h"
#include "io/cells.h"

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
constexpr std::array kRolesOfRecord = {Role::kDisplacement, Role::kForce, Role::kTime,
                                       Role::kNormalLoad};

/// Returns how a column's numbers behave.
ColumnNames::Column ObservedIn(const std::vector<double>& values) {
  constexpr double kGoodPart = 0.4;
  double least = std::numeric_limits<double>::infinity();
  double greatest = -least;
  double rise = 0.0;
  double fall = 0.0;
  double first = 0.0;
  std::size_t numbers = 0;
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    if (numbers++ == 0) first = value;
    least = std::min(least, value);
    greatest = std::max(greatest, value);
    rise = std::max(rise, value - least);
    fall = std::max(fall, greatest - value);
  }
  ColumnNames::Column column;
  column.is_numeric = !values.empty() && 2 * numbers >= values.size();
  column.least = least;
  column.greatest = greatest;
  column.trend = int{rise > 0 && fall == 0} - int{fall > 0 && rise == 0};
  column.goes_to_and_fro =
      greatest > least && std::min(rise, fall) > kGoodPart * (greatest - least);
  column.first = first;
  return column;
}

/// Evidence of a unit, which counts more than a word; and of numbers that go to and fro, more
/// still.
constexpr int kUnit = 100;
constexpr int kMoving = 1000;

/// Returns the evidence that a column has a role: 0 is none.
int EvidenceFor(const ColumnNames::Column& column, Role role) {
  constexpr int kWord = 50;
  constexpr int kStep = 5;       // of a rank
  constexpr int kLesser = 30;    // what is commanded or raw
  constexpr int kContrary = 60;  // a unit of the role, but a word of another
  const NameEvidence& evidence = column.evidence;
  const bool has_word = !evidence.word.empty();
  const bool is_named = evidence.names(role);
  // "N" counts cycles or rows where it only grows.
  if (evidence.word == "N" && column.unit.empty() && column.trend > 0) return 0;
  // A force in newton, unless there is a better one.
  if (role == Role::kForce && evidence.word == "f n") return 1;
  // A normal load is one by its name alone.
  const bool is_load = evidence.names(Role::kNormalLoad);
  if (!is_named && (role == Role::kNormalLoad || is_load)) return 0;
  const bool is_of_unit = MayHaveRole(column.dimension, role);
  int found = 0;
  if (is_of_unit) found = has_word && !is_named ? kUnit - kContrary : kUnit;
  if (role == Role::kTime && column.is_clock && !is_of_unit) {
    found = is_named || !has_word ? kUnit - kStep : 0;
  }
  if (is_named) {
    const bool may_be = column.unit.empty() || is_of_unit;
    const bool is_needed = role == Role::kDisplacement || role == Role::kForce;
    const int others = std::min<int>(static_cast<int>(evidence.other_words), kStep - 1);
    found += may_be ? kWord - kStep * evidence.rank - others : is_needed ? 1 : 0;
  }
  return found > kLesser && evidence.is_lesser ? found - kLesser : found;
}

std::string SiUnit(Dimension dimension) {
  const std::string symbols = UnitSymbols(dimension);
  return symbols.substr(0, symbols.find(','));
}

/// Returns the unit in which a number is a stamp since 1970, "" where it is none.
std::string UnitOfStamp(double number) {
  constexpr double kFrom2001 = 1e9;  // [s] since 1970, to 2100
  constexpr double kTo2100 = 4.1e9;
  for (const auto& [scale, unit] :
       {std::pair(1.0, "s"), std::pair(1e3, "ms"), std::pair(1e6, "us"), std::pair(1e9, "ns")}) {
    if (number >= kFrom2001 * scale && number <= kTo2100 * scale) return unit;
  }
  return "";
}

class RoleAssigner {
 public:
  RoleAssigner(const ColumnNames& names, std::vector<std::string>& notes)
      : names_(names), file_(names.table().file), notes_(notes), taken_(names.size()) {}

  std::vector<Quantity> Assign(const RecordColumns& asked) && {
    const bool has_load = asked.normal_load != "none";
    for (const Role role : kRolesOfRecord) {
      const bool is_none = role == Role::kNormalLoad && !has_load;
      TakeGiven(is_none ? "" : asked.*RulesOf(role).given, role);
    }
    const bool finds_displacement = IsMissing(Role::kDisplacement);
    const bool finds_force = IsMissing(Role::kForce);
    FindPair();
    if (!asked.sample_rate && IsMissing(Role::kTime)) {
      TakeFound(Role::kTime);
      if (!IsMissing(Role::kTime)) AddNanoseconds();
    }
    // A load that is fitted as a force of its own is not also the law's, unless it is asked to be.
    for (const std::string& covariate : asked.covariates) {
      taken_[names_.Chosen(covariate, Role::kOther)] = true;
    }
    if (has_load) TakeFound(Role::kNormalLoad);
    if (has_load && IsMissing(Role::kNormalLoad) && !IsMissing(Role::kForce)) TakeLoad();
    TakeLeft();
    if (finds_displacement) RequireMoving(Role::kDisplacement, Role::kForce);
    if (finds_force) RequireMoving(Role::kForce, Role::kDisplacement);
    RequireNoCoefficient(finds_force);
    TakeMagnitudeOfLoad();
    const bool is_torsional = RequireOneKind();
    std::erase_if(roles_, [](const Quantity& quantity) { return quantity.terms.empty(); });
    for (Quantity& quantity : roles_) {
      names_.FindUnitOf(quantity, is_torsional, notes_);
      if (quantity.role == Role::kTime) names_.SetOriginOf(quantity, notes_);
    }
    return std::move(roles_);
  }

 private:
  Quantity& Of(Role role) { return roles_.at(static_cast<std::size_t>(role)); }
  bool IsMissing(Role role) { return Of(role).terms.empty(); }
  std::size_t ColumnOf(Role role) { return Of(role).first_column(); }
  void Take(std::size_t column, Role role) {
    taken_[column] = true;
    Of(role).terms = {{column, 1.0}};
  }

  void TakeGiven(const std::string& text, Role role) {
    for (const Quantity::Term& term : roles_.emplace_back(names_.Read(text, role)).terms) {
      if (taken_[term.column]) {
        Refuse("{}: {} is chosen for the {} and for another quantity: choose two columns", file_,
               names_.Label(term.column), RulesOf(role).name);
      }
      taken_[term.column] = true;
    }
  }

  void TakeFound(Role role) {
    if (!IsMissing(role)) return;
    if (const auto found = names_.Best(role, taken_)) return Take(*found, role);
    if (!Of(role).given_unit.empty()) ThrowNoColumn(role);
  }

  /// Takes a "load" as the normal one beside what is a friction force by its name.
  void TakeLoad() {
    const NameEvidence& force = names_[ColumnOf(Role::kForce)].evidence;
    if (!force.names(Role::kForce) || force.rank > 0) return;
    for (std::size_t column = 0; column < taken_.size(); ++column) {
      const ColumnNames::Column& of = names_[column];
      const NameEvidence& load = of.evidence;
      const bool is_load = load.names(Role::kForce) && load.rank == 2 && !load.is_angular &&
                           load.other_words == 0 &&
                           (of.unit.empty() || of.dimension == Dimension::kForce);
      if (!taken_[column] && of.is_numeric && is_load) return Take(column, Role::kNormalLoad);
    }
  }

  /// Adds to a stamp of whole seconds, "header.stamp.sec", the column of its nanoseconds.
  void AddNanoseconds() {
    const std::string stamp = LowerCase(names_[ColumnOf(Role::kTime)].name);
    const std::size_t at = stamp.rfind("sec");
    for (const std::string_view prefix : {"nano", "n"}) {
      if (at == std::string::npos) return;
      const auto column = names_.Named(std::string(stamp).insert(at, prefix), Role::kTime);
      if (column && !taken_[*column]) return Of(Role::kTime).terms.push_back({*column, 1e-9});
    }
  }

  /// The columns of the most evidence for a role.
  struct Pick {
    int score = 0;
    std::vector<std::size_t> columns = {};
  };

  /// Returns what a force by a length, or a torque by an angle, may have as a role: the column that
  /// is given, or those of the most evidence, one that goes to and fro before all others.
  Pick PickFor(Role role, bool is_angular) {
    Pick pick;
    for (std::size_t column = 0; column < taken_.size(); ++column) {
      const ColumnNames::Column& of = names_[column];
      const bool is_free = IsMissing(role) && !taken_[column] && of.is_numeric;
      const bool is_given = !IsMissing(role) && column == ColumnOf(role);
      const int evidence = EvidenceFor(of, role);
      if (!is_given && !(is_free && evidence > 0)) continue;
      if (of.IsAngular(Of(role).given_unit).value_or(is_angular) != is_angular) continue;
      const int score = evidence + (of.goes_to_and_fro ? kMoving : 0);
      if (score > pick.score) pick = {score, {}};
      if (score == pick.score) pick.columns.push_back(column);
    }
    return pick;
  }

  /// Takes the displacement and the force of the most evidence that go together.
  void FindPair() {
    constexpr int kComplete = 60;  // of two columns by their words
    constexpr std::array kPair = {Role::kDisplacement, Role::kForce};
    std::array<std::array<Pick, 2>, 2> picks;  // of a force by a length, of a torque by an angle
    std::array<int, 2> scores = {};
    for (const std::size_t kind : {0U, 1U}) {
      for (const std::size_t k : {0U, 1U}) {
        picks[kind][k] = PickFor(kPair[k], kind == 1);
        scores[kind] += picks[kind][k].score;
      }
    }
    const std::size_t kind = scores[1] > scores[0] ? 1 : 0;
    const auto& [line, push] = picks[0];
    const auto& [turn, twist] = picks[1];
    const bool has_both = line.score > 0 && push.score > 0 && turn.score > 0 && twist.score > 0 &&
                          line.columns != turn.columns && push.columns != twist.columns;
    if (has_both && std::min(scores[0], scores[1]) > kComplete &&
        std::abs(scores[0] - scores[1]) < kMoving) {
      names_.ThrowAmbiguous(kPair[0], {line.columns.front(), turn.columns.front()});
    }
    for (const std::size_t k : {0U, 1U}) {
      // A displacement that has no force to go with it is refused with the one that there is.
      const std::vector<std::size_t>& of_kind = picks[kind][k].columns;
      std::vector<std::size_t> columns = of_kind.empty() ? picks[1 - kind][k].columns : of_kind;
      std::erase_if(columns, [&](std::size_t column) { return taken_[column]; });
      if (!IsMissing(kPair[k]) || columns.empty()) continue;
      if (columns.size() > 1) names_.ThrowAmbiguous(kPair[k], columns);
      NoteThatItMoves(columns.front(), kPair[k]);
      Take(columns.front(), kPair[k]);
    }
  }

  /// Says so where a column that has as much evidence of a role is not taken, as it rests.
  void NoteThatItMoves(std::size_t taken, Role role) {
    const int evidence = EvidenceFor(names_[taken], role);
    for (std::size_t column = 0; column < taken_.size() && names_[taken].goes_to_and_fro;
         ++column) {
      const ColumnNames::Column& of = names_[column];
      if (taken_[column] || !of.is_numeric || of.goes_to_and_fro) continue;
      if (EvidenceFor(of, role) < evidence) continue;
      notes_.push_back(fmt::format("{}: the {} is {}, as {} does not go to and fro", file_,
                                   RulesOf(role).name, names_.Label(taken), names_.Label(column)));
      return;
    }
  }

  /// Gives what no name or unit decides to the columns of numbers that are left, if they are as
  /// many.
  void TakeLeft() {
    std::vector<Role> missing = {Role::kDisplacement, Role::kForce};
    std::erase_if(missing, [&](Role role) { return !IsMissing(role); });
    std::vector<std::size_t> left;
    for (std::size_t column = 0; column < taken_.size(); ++column) {
      const ColumnNames::Column& of = names_[column];
      const bool is_unknown = of.unit.empty() && of.evidence.word.empty();
      if (!taken_[column] && is_unknown && !of.is_clock && of.is_numeric) left.push_back(column);
    }
    if (left.size() > missing.size()) {
      std::erase_if(left, [&](std::size_t column) {
        return names_[column].trend != 0 || !(names_[column].greatest > names_[column].least);
      });
    }
    if (missing.empty()) return;
    if (left.size() != missing.size()) ThrowNoColumn(missing.front());
    for (std::size_t k = 0; k < left.size(); ++k) {
      Take(left[k], missing[k]);
      notes_.push_back(fmt::format("{}: no column name is recognised as {}: taken from {}{}", file_,
                                   RulesOf(missing[k]).name, names_.Label(left[k]),
                                   left.size() > 1 ? ", of two in their order" : ""));
    }
  }

  /// Refuses a coefficient of friction as the force: one by its name, or a friction without a unit
  /// and below 2 beside a load in newton; and that load, where it never changes its sign. Whoever
  /// gives a unit is believed.
  void RequireNoCoefficient(bool finds_force) const {
    constexpr double kGreatest = 2;
    const Quantity& force = roles_[static_cast<std::size_t>(Role::kForce)];
    if (!force.given_unit.empty() || force.is_scaled) return;
    const ColumnNames::Column& taken = names_[force.first_column()];
    const bool keeps_sign = taken.least > 0 || taken.greatest < 0;
    const auto loads = std::ranges::count_if(names_.columns(), [](const auto& of) {
      return of.dimension == Dimension::kForce || of.evidence.names(Role::kNormalLoad);
    });
    for (std::size_t column = 0; column < names_.size(); ++column) {
      const ColumnNames::Column& of = names_[column];
      const bool is_named = of.evidence.names(Role::kFrictionCoefficient);
      const bool may_be = (of.evidence.word == "friction" || of.evidence.word == "f") &&
                          of.unit.empty() && of.GreatestMagnitude() < kGreatest;
      const bool is_taken = &of == &taken && (is_named || (may_be && loads > 0));
      const bool is_beside_load = &of != &taken && finds_force && keeps_sign && loads < 2;
      if (!is_taken && !(is_beside_load && (is_named || may_be))) continue;
      Refuse(
          "{}:{}: {} is a coefficient of friction, or looks like one, and no force: choose the "
          "force with --force, or multiply by the normal load, where that is 50 N by --force "
          "'#{}*50 [N]'; if it is a force, say so by --force '{} [N]'",
          names_.Header(), column + 1, names_.Label(column), column + 1, column + 1);
    }
  }

  /// Takes the magnitude of a load that is negative throughout.
  void TakeMagnitudeOfLoad() {
    Quantity& load = Of(Role::kNormalLoad);
    if (!load.is_plain()) return;
    const ColumnNames::Column& of = names_[load.first_column()];
    if (!(of.greatest < 0)) return;
    load.terms.front().weight = -1.0;
    notes_.push_back(
        fmt::format("{}: normal load {} is negative throughout: its magnitude is taken", file_,
                    names_.Label(load.first_column())));
  }

  [[noreturn]] void ThrowNoColumn(Role role) const {
    const RoleRules& rules = RulesOf(role);
    for (std::size_t column = 0; column < names_.size(); ++column) {
      const bool is_named = !names_.table().columns[column].name.empty();
      if (names_[column].is_numeric || (is_named && EvidenceFor(names_[column], role) == 0))
        continue;
      static_cast<void>(names_.table().Numbers(column));  // throws
    }
    Refuse("{}: no column for the {}: {}: choose it with {}, by name or number", file_, rules.name,
           names_.Listing(), rules.option);
  }

  /// Refuses a column without a unit whose numbers are those of a clock or a counter, where those
  /// of the other role go to and fro.
  void RequireMoving(Role role, Role other) {
    const std::size_t column = ColumnOf(role);
    const ColumnNames::Column& of = names_[column];
    if (!Of(role).given_unit.empty() || EvidenceFor(of, role) >= kUnit || of.trend == 0 ||
        !names_[ColumnOf(other)].goes_to_and_fro) {
      return;
    }
    Refuse(
        "{}:{}:{}: {} only {} while {} goes to and fro, as a clock or a counter does: choose the "
        "{} with {}, by name or number: {}",
        file_, names_.table().lines.front(), column + 1, names_.Label(column),
        of.trend > 0 ? "grows" : "falls", names_.Label(ColumnOf(other)), RulesOf(role).name,
        RulesOf(role).option, names_.Listing());
  }

  /// @returns true for a torque against an angle
  bool RequireOneKind() {
    const auto kind_of = [&](Role role) {
      return names_[ColumnOf(role)].IsAngular(Of(role).given_unit);
    };
    const auto turns = kind_of(Role::kDisplacement);
    const auto twists = kind_of(Role::kForce);
    const bool is_torsional = turns == true || twists == true;
    if (!is_torsional || (turns != false && twists != false)) return is_torsional;
    Refuse(
        "{}: {} and {} do not match: a torque needs an angle, a force a length: choose other "
        "columns, or give their units, as in --force '{} [N]'",
        file_, names_.Label(ColumnOf(Role::kDisplacement)), names_.Label(ColumnOf(Role::kForce)),
        ColumnOf(Role::kForce) + 1);
  }

  const ColumnNames& names_;
  const std::string& file_;
  std::vector<std::string>& notes_;
  std::vector<bool> taken_;
  std::vector<Quantity> roles_;  // in the order of Role
};

}  // namespace

const RoleRules& RulesOf(Role role) { return kRules.at(static_cast<std::size_t>(role)); }

std::vector<double> Quantity::Numbers(const CsvTable& table) const {
  for (const Term& term : terms) static_cast<void>(table.Numbers(term.column));
  std::vector<double> values(table.rows());
  for (std::size_t row = 0; row < values.size(); ++row)
    values[row] = unit.ToSi(ValueIn(table, row));
  return values;
}

std::optional<bool> ColumnNames::Column::IsAngular(std::string_view given_unit) const {
  const auto of_unit = given_unit.empty() ? dimension : DimensionOf(given_unit);
  if (of_unit == Dimension::kAngle || of_unit == Dimension::kTorque) return true;
  if (of_unit == Dimension::kLength || of_unit == Dimension::kForce) return false;
  return evidence.is_angular ? std::optional(true) : std::nullopt;
}

ColumnNames::ColumnNames(const CsvTable& table) : table_(table) {
  columns_.reserve(table.columns.size());
  for (const TableColumn& column : table.columns) {
    columns_.push_back(ObservedIn(column.values));
    Column& added = columns_.back();
    static_cast<ColumnName&>(added) = SplitColumnName(column.name);
    if (added.unit.empty()) added.unit = WithoutBrackets(column.unit);
    // "millis"
    if (added.unit.empty() && added.evidence.names(Role::kTime) &&
        DimensionOf(added.name) == Dimension::kTime) {
      added.unit = added.name;
    }
    added.dimension = DimensionOf(added.unit);
    added.is_clock = column.is_clock;
  }
}

std::optional<std::size_t> ColumnNames::Named(std::string_view name, Role role) const {
  const std::string lower = LowerCase(name);
  const auto matches = [&](std::size_t column, bool exactly) {
    const std::string& full = table_.columns[column].name;
    if (exactly) return full == name;
    return LowerCase(full) == lower || LowerCase(columns_[column].name) == lower;
  };
  for (const bool exactly : {true, false}) {
    std::vector<std::size_t> found;
    for (std::size_t column = 0; column < size() && !name.empty(); ++column) {
      if (matches(column, exactly)) found.push_back(column);
    }
    if (found.size() > 1) ThrowAmbiguous(role, found);
    if (found.size() == 1) return found.front();
  }
  return std::nullopt;
}

std::optional<std::size_t> ColumnNames::Best(Role role, const std::vector<bool>& taken) const {
  std::optional<std::size_t> best;
  int most = 0;
  for (std::size_t column = 0; column < size(); ++column) {
    if ((!taken.empty() && taken[column]) || !columns_[column].is_numeric) continue;
    const int evidence = EvidenceFor(columns_[column], role);
    if (evidence <= most) continue;
    most = evidence;
    best = column;
  }
  return best;
}

std::size_t ColumnNames::Chosen(const std::string& text, Role role) const {
  const Quantity chosen = Read(text, role);
  if (!chosen.is_plain()) {
    Refuse("{}: {} {}: must be one column", table_.file, RulesOf(role).option, text);
  }
  return chosen.first_column();
}

std::string ColumnNames::UnitOf(std::size_t column, Role role) const {
  const std::string& unit = columns_[column].unit;
  const std::string_view of_row = WithoutBrackets(table_.columns[column].unit);
  if (of_row.empty() || of_row == unit) return unit;
  Refuse(
      "{}: {} has the unit '{}' in its name and '{}' below it: choose its unit with {} '{} [{}]'",
      Header(), Label(column), unit, of_row, RulesOf(role).option, column + 1, unit);
}

std::string ColumnNames::NameOf(std::size_t column) const {
  const std::string& name = columns_[column].name;
  const bool is_one = !name.empty() && std::ranges::count(columns_, name, &Column::name) == 1;
  return is_one ? name : std::to_string(column + 1);
}

std::string ColumnNames::Label(std::size_t column) const {
  const std::string& name = table_.columns[column].name;
  if (table_.header_line == 0 || name.empty()) return fmt::format("column {}", column + 1);
  return fmt::format("'{}' (column {})", ForMessage(name), column + 1);
}

void ColumnNames::ThrowAmbiguous(Role role, const std::vector<std::size_t>& columns) const {
  std::vector<std::string> labels;
  labels.reserve(columns.size());
  for (const std::size_t column : columns) labels.push_back(Label(column));
  Refuse("{}: {} may each be the {}: choose one by its number, as {} {}", Header(),
         fmt::join(labels, " and "), RulesOf(role).name, RulesOf(role).option, columns.front() + 1);
}

std::string ColumnNames::Listing() const {
  if (std::ranges::all_of(table_.columns, [](auto& column) { return column.name.empty(); })) {
    return fmt::format("the file names none of its {} columns", size());
  }
  std::vector<std::string> listed;
  listed.reserve(size());
  for (const TableColumn& column : table_.columns) {
    listed.push_back(fmt::format("'{}' ({})", ForMessage(column.name), listed.size() + 1));
  }
  return fmt::format("the columns are {}", fmt::join(listed, ", "));
}

std::string ColumnNames::Header() const {
  return fmt::format("{}:{}", table_.file, table_.header_line);
}

void ColumnNames::FindUnitOf(Quantity& quantity, bool is_torsional,
                             std::vector<std::string>& notes) const {
  const auto& [name, option, linear, angular, given, chosen, values] = RulesOf(quantity.role);
  const Dimension dimension = is_torsional ? angular : linear;
  const std::size_t first = quantity.first_column();
  const Column& of = columns_[first];
  const bool is_clock = quantity.role == Role::kTime && of.is_clock;
  std::string symbol = is_clock ? "s" : quantity.given_unit;
  const bool is_given = !symbol.empty();
  if (!is_given) symbol = UnitOf(first, quantity.role);
  std::string assumed = SiUnit(dimension);
  for (const Quantity::Term& term : quantity.terms) {
    if (is_given || UnitOf(term.column, quantity.role) == symbol) continue;
    Refuse(
        "{}: {} and {} are not in one unit: scale them, and give the unit of the sum in brackets, "
        "as in {} '… [{}]'",
        table_.file, Label(first), Label(term.column), option, assumed);
  }
  if (const auto unit = FindUnit(symbol);
      unit && (unit->dimension == linear || unit->dimension == dimension)) {
    quantity.unit = *unit;
    return;
  }
  if (is_given || (!symbol.empty() && !quantity.is_scaled)) {
    Refuse(
        "{}: the unit '{}' of {} is not known for the {}: must be one of {}, as in {} '{} [{}]', "
        "or "
        "with a factor '#{}*0.001 [{}]'",
        is_given ? table_.file : fmt::format("{}:{}", Header(), first + 1), ForMessage(symbol),
        Label(first), name, UnitSymbols(dimension), option, first + 1, assumed, first + 1, assumed);
  }
  if (symbol.empty()) {
    quantity.has_no_unit = true;
    if (const std::string of_stamp = UnitOfStamp(of.first);
        quantity.role == Role::kTime && !quantity.is_scaled && !of_stamp.empty()) {
      assumed = of_stamp;
    }
    notes.push_back(fmt::format("{}: {} {} names no unit: taken as {}; {} '{} [{}]' says so",
                                table_.file, name, Label(first), assumed, option, first + 1,
                                assumed));
  }
  quantity.unit = *FindUnit(assumed);
}

void ColumnNames::SetOriginOf(Quantity& time, std::vector<std::string>& notes) const {
  const Column& of = columns_[time.first_column()];
  const bool is_stamp = !time.is_scaled && UnitOfStamp(of.first) == time.unit.symbol;
  if (!of.is_clock && !is_stamp) return;
  time.offset -= of.first;
  notes.push_back(fmt::format("{}: time {} holds dates or times of day: counted from the first",
                              table_.file, Label(time.first_column())));
}

std::vector<Quantity> AssignRoles(const ColumnNames& names, const RecordColumns& columns,
                                  std::vector<std::string>& notes) {
  return RoleAssigner(names, notes).Assign(columns);
}

}  // namespace mindahl::io
