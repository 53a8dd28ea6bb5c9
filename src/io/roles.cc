#include "io/roles.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <ranges>
#include <set>
#include <span>
#include <utility>

#include "core/text.h"

namespace mindahl::io {
namespace {

// The rows are in the order of Role.
constexpr std::array kRules = {
    RoleRules{"displacement", "--displacement", Dimension::kLength, Dimension::kAngle,
              &RecordColumns::displacement},
    RoleRules{"force", "--force", Dimension::kForce, Dimension::kTorque, &RecordColumns::force},
    RoleRules{"time", "--time", Dimension::kTime, Dimension::kTime, &RecordColumns::time},
    // A joint carries a torque.
    RoleRules{"normal load", "--normal-load-column", Dimension::kForce, Dimension::kTorque,
              &RecordColumns::normal_load},
    RoleRules{"covariate", "--covariate", {}, {}, nullptr},
};
constexpr std::array kRolesOfRecord = {Role::kDisplacement, Role::kForce, Role::kTime,
                                       Role::kNormalLoad};

/// Returns how a column's numbers behave.
ColumnNames::Column ObservedIn(std::span<const double> values) {
  constexpr double kGoodPart = 0.4;
  double least = std::numeric_limits<double>::infinity();
  double greatest = -least;
  double rise = 0.0;
  double fall = 0.0;
  std::size_t holes = 0;
  for (const double value : values) {
    if (!std::isfinite(value)) {
      ++holes;
      continue;
    }
    least = std::min(least, value);
    greatest = std::max(greatest, value);
    rise = std::max(rise, value - least);
    fall = std::max(fall, greatest - value);
  }
  return {
      .name = {},
      .is_numeric = !values.empty() && 2 * holes <= values.size(),
      .is_constant = rise == 0 && fall == 0,
      .trend = fall == 0   ? int{rise > 0}
               : rise == 0 ? -1
                           : 0,
      .goes_to_and_fro = greatest > least && std::min(rise, fall) > kGoodPart * (greatest - least)};
}

/// Returns the evidence that a column has a role: 0 is none. A unit counts more than a word.
int EvidenceFor(const ColumnNames::Column& column, Role role) {
  constexpr int kUnit = 100;
  constexpr int kWord = 50;
  constexpr int kStep = 5;       // of a rank
  constexpr int kLesser = 30;    // what is commanded or raw
  constexpr int kContrary = 60;  // a unit of the role, but a word of another
  const NameEvidence& evidence = column.name.evidence;
  const bool has_word = !evidence.word.empty();
  const bool is_named = evidence.names(role);
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

/// Returns whether a column is an angle or a torque, or else a length or a force, by the unit or
/// else the name; empty where neither says.
std::optional<bool> IsAngular(const ColumnNames& names, std::size_t column, std::string_view unit) {
  const auto dimension = unit.empty() ? names[column].dimension : DimensionOf(unit);
  if (dimension == Dimension::kAngle || dimension == Dimension::kTorque) return true;
  if (dimension == Dimension::kLength || dimension == Dimension::kForce) return false;
  return names[column].name.evidence.is_angular ? std::optional(true) : std::nullopt;
}

std::string SiUnit(Dimension dimension) {
  const std::string symbols = UnitSymbols(dimension);
  return symbols.substr(0, symbols.find(','));
}

class RoleAssigner {
 public:
  RoleAssigner(const ColumnNames& names, std::vector<std::string>& notes)
      : names_(names), file_(names.table().file), notes_(notes), taken_(names.size()) {}

  Roles Assign(const RecordColumns& asked) {
    for (const Role role : kRolesOfRecord) TakeGiven(asked.*RulesOf(role).given, role);
    const bool finds_displacement = IsMissing(Role::kDisplacement);
    const bool finds_force = IsMissing(Role::kForce);
    FindPair();
    if (!asked.sample_rate && IsMissing(Role::kTime)) {
      TakeFound(Role::kTime, taken_);
      AddNanoseconds();
    }
    // A load that is fitted as a force of its own is not also the law's, unless it is asked to be.
    std::vector<bool> taken = taken_;
    for (const std::string& covariate : asked.covariates) {
      taken[names_.Chosen(covariate, Role::kOther)] = true;
    }
    TakeFound(Role::kNormalLoad, taken);
    TakeLoad(taken);
    TakeLeft();
    // A word is enough for a displacement that only grows, but for the X of a report where another
    // column may be meant; a force needs its unit.
    const bool may_be_time = names_[ColumnOf(Role::kDisplacement)].name.evidence.word == "X" &&
                             std::ranges::any_of(LeftColumns(), [&](std::size_t column) {
                               return names_[column].goes_to_and_fro;
                             });
    if (finds_displacement) RequireMoving(Role::kDisplacement, Role::kForce, may_be_time ? 100 : 1);
    if (finds_force) RequireMoving(Role::kForce, Role::kDisplacement, 100);
    RequireForce();
    RequireOneKind();
    return std::move(roles_);
  }

 private:
  bool IsMissing(Role role) { return roles_[role].terms.empty(); }
  std::size_t ColumnOf(Role role) { return roles_[role].terms.front().column; }
  void Take(std::size_t column, Role role) {
    taken_[column] = true;
    roles_[role].terms = {{column, 1.0}};
  }

  void TakeGiven(const std::string& text, Role role) {
    roles_[role] = names_.Read(text, role);
    for (const Expression::Term& term : roles_[role].terms) {
      if (taken_[term.column]) {
        Refuse("{}: {} is chosen for the {} and for another quantity: choose two columns", file_,
               names_.Label(term.column), RulesOf(role).name);
      }
      taken_[term.column] = true;
    }
  }

  void TakeFound(Role role, const std::vector<bool>& taken) {
    if (!IsMissing(role)) return;
    if (const auto found = names_.Best(role, taken)) return Take(*found, role);
    for (std::size_t named = 0; named < taken.size() && role == Role::kTime; ++named) {
      if (taken[named] || !names_[named].name.evidence.names(role)) continue;
      notes_.push_back(fmt::format(
          "{}: time {} {}: left out", file_, names_.Label(named),
          names_[named].is_numeric ? "has a unit that is none of a time" : "holds no numbers"));
    }
    const std::string& unit = roles_[role].unit;
    if (unit.empty()) return;
    Refuse("{}: {} [{}]: no column is recognised as the {}: name it", file_, RulesOf(role).option,
           unit, RulesOf(role).name);
  }

  /// Takes a "load" as the normal one beside what is a friction force by its name.
  void TakeLoad(const std::vector<bool>& taken) {
    if (!IsMissing(Role::kNormalLoad) || IsMissing(Role::kForce)) return;
    const NameEvidence& force = names_[ColumnOf(Role::kForce)].name.evidence;
    if (!force.names(Role::kForce) || force.rank > 0) return;
    for (std::size_t column = 0; column < taken.size(); ++column) {
      const ColumnNames::Column& of = names_[column];
      const NameEvidence& load = of.name.evidence;
      const bool is_load = load.names(Role::kForce) && load.rank == 2 && !load.is_angular;
      const bool is_of_unit = of.unit.empty() || of.dimension == Dimension::kForce;
      if (taken[column] || !of.is_numeric || !is_load || load.other_words > 0 || !is_of_unit) {
        continue;
      }
      return Take(column, Role::kNormalLoad);
    }
  }

  /// Adds to a stamp of whole seconds, "header.stamp.sec", the column of its nanoseconds.
  void AddNanoseconds() {
    if (IsMissing(Role::kTime)) return;
    const std::size_t seconds = ColumnOf(Role::kTime);
    const auto name = [&](std::size_t column) { return LowerCase(names_[column].name.name); };
    const std::string stamp = name(seconds);
    if (!stamp.ends_with("sec") && !stamp.ends_with("secs")) return;
    const std::string stem = stamp.substr(0, stamp.rfind("sec"));
    for (std::size_t column = 0; column < taken_.size(); ++column) {
      const bool is_of_stamp = name(column) == stem + "nano" + stamp.substr(stem.size()) ||
                               name(column) == stem + "n" + stamp.substr(stem.size());
      if (!is_of_stamp || taken_[column] || !names_[column].is_numeric) continue;
      taken_[column] = true;
      roles_[Role::kTime].terms.push_back({column, 1e-9});
      notes_.push_back(fmt::format("{}: time {} with the nanoseconds of {}", file_,
                                   names_.Label(seconds), names_.Label(column)));
      return;
    }
  }

  struct Candidate {
    std::optional<std::size_t> column;
    int evidence = 0;
    std::optional<bool> is_angular;
  };

  /// Returns the columns that may have a role: the one that is given, else those with evidence; of
  /// these, those that go to and fro, if any does. There is always one, perhaps without a column.
  std::vector<Candidate> CandidatesFor(Role role) {
    const auto candidate = [&](std::size_t column, int evidence) {
      return Candidate{column, evidence, IsAngular(names_, column, roles_[role].unit)};
    };
    if (!IsMissing(role)) return {candidate(ColumnOf(role), 0)};
    std::vector<Candidate> found;
    std::vector<std::size_t> columns;
    int most_moving = 0;
    for (std::size_t column = 0; column < taken_.size(); ++column) {
      const int evidence = EvidenceFor(names_[column], role);
      if (taken_[column] || !names_[column].is_numeric || evidence <= 0) continue;
      found.push_back(candidate(column, evidence));
      columns.push_back(column);
      if (names_[column].goes_to_and_fro) most_moving = std::max(most_moving, evidence);
    }
    if (found.empty()) return {Candidate{}};
    if (most_moving == 0) return found;
    const auto rests = [&](const Candidate& of) { return !names_[*of.column].goes_to_and_fro; };
    if (std::ranges::any_of(
            found, [&](const Candidate& of) { return rests(of) && of.evidence >= most_moving; })) {
      notes_.push_back(fmt::format("{}: {}: one that goes to and fro is taken", file_,
                                   names_.MayEachBe(role, columns)));
    }
    std::erase_if(found, rests);
    return found;
  }

  /// Takes the displacement and the force of the most evidence that go together.
  void FindPair() {
    constexpr int kMismatch = 40;
    const std::vector<Candidate> displacements = CandidatesFor(Role::kDisplacement);
    const std::vector<Candidate> forces = CandidatesFor(Role::kForce);
    if (!displacements.front().column && LeftColumns().empty()) ThrowNoColumn(Role::kDisplacement);
    int most = std::numeric_limits<int>::min();
    std::array<std::set<std::size_t>, 2> best;
    for (const Candidate& x : displacements) {
      for (const Candidate& f : forces) {
        if (x.column && x.column == f.column) continue;
        const bool differs = x.is_angular && f.is_angular && x.is_angular != f.is_angular;
        const int evidence = x.evidence + f.evidence - (differs ? kMismatch : 0);
        if (evidence < most) continue;
        if (evidence > std::exchange(most, evidence)) best = {};
        if (x.column) best[0].insert(*x.column);
        if (f.column) best[1].insert(*f.column);
      }
    }
    // The only column with evidence has it of both.
    if (most == std::numeric_limits<int>::min()) best[0].insert(*displacements.front().column);
    for (const Role role : {Role::kDisplacement, Role::kForce}) {
      const std::set<std::size_t>& columns = best.at(static_cast<std::size_t>(role));
      if (!IsMissing(role) || columns.empty()) continue;
      if (columns.size() > 1) names_.ThrowAmbiguous(role, {columns.begin(), columns.end()});
      Take(*columns.begin(), role);
    }
  }

  /// Returns the columns of numbers of which neither name nor unit says anything.
  std::vector<std::size_t> LeftColumns() const {
    std::vector<std::size_t> left;
    for (std::size_t column = 0; column < taken_.size(); ++column) {
      const ColumnNames::Column& of = names_[column];
      const bool is_unknown = of.unit.empty() && of.name.evidence.word.empty();
      if (!taken_[column] && is_unknown && !of.is_clock && of.is_numeric) left.push_back(column);
    }
    return left;
  }

  /// Gives what no name or unit decides to the columns that are left, if they are as many.
  void TakeLeft() {
    std::vector<Role> missing = {Role::kDisplacement, Role::kForce};
    std::erase_if(missing, [&](Role role) { return !IsMissing(role); });
    if (missing.empty()) return;
    std::vector<std::size_t> left = LeftColumns();
    std::string why;
    if (left.size() > missing.size()) {
      std::erase_if(left, [&](std::size_t column) {
        return names_[column].is_constant || names_[column].trend != 0;
      });
      why = ", of those that neither stay nor only grow";
    }
    if (left.size() != missing.size()) ThrowNoColumn(missing.front());
    for (std::size_t k = 0; k < left.size(); ++k) {
      Take(left[k], missing[k]);
      notes_.push_back(
          fmt::format("{}: no column name is recognised as {}: taken from {}, {}{}", file_,
                      RulesOf(missing[k]).name, names_.Label(left[k]),
                      left.size() == 1 ? "the only one left" : "the two left in their order", why));
    }
  }

  /// Refuses a coefficient of friction, one by its name or else by its numbers, as the force.
  [[noreturn]] void ThrowCoefficient(std::size_t column) const {
    const bool is_named = names_[column].name.evidence.is_coefficient;
    Refuse(
        "{}:{}: {} {}: choose the force with --force, or multiply by the normal load, where that "
        "is 50 N by --force '#{}*50 [N]'{}",
        names_.Header(), column + 1, names_.Label(column),
        is_named
            ? "is a coefficient of friction and no force"
            : "without a unit and with all values below 2 looks like a coefficient of friction",
        column + 1,
        is_named ? "" : fmt::format("; if it is a force, say so by --force '{} [N]'", column + 1));
  }

  /// Refuses a coefficient of friction as the force, also a friction without a unit and below 2
  /// beside a load in newton. Whoever gives it a unit is believed.
  void RequireForce() {
    const Expression& force = roles_[Role::kForce];
    const std::size_t column = ColumnOf(Role::kForce);
    const ColumnNames::Column& of = names_[column];
    if (!force.unit.empty() || force.is_scaled || of.dimension) return;
    const auto is_load = [&](std::size_t other) {
      return names_[other].dimension == Dimension::kForce;
    };
    const bool is_low = std::ranges::none_of(names_.table().columns[column].values,
                                             [](double value) { return std::abs(value) >= 2; });
    const bool may_be =
        of.name.evidence.word == "friction" && of.unit.empty() && is_low &&
        std::ranges::any_of(std::views::iota(std::size_t{0}, names_.size()), is_load);
    if (of.name.evidence.is_coefficient || may_be) ThrowCoefficient(column);
  }

  [[noreturn]] void ThrowNoColumn(Role role) const {
    const RoleRules& rules = RulesOf(role);
    for (std::size_t column = 0; column < names_.size() && role == Role::kForce; ++column) {
      if (names_[column].name.evidence.is_coefficient) ThrowCoefficient(column);
    }
    for (std::size_t column = 0; column < names_.size(); ++column) {
      if (EvidenceFor(names_[column], role) <= 0 || names_[column].is_numeric) continue;
      const TableColumn& of = names_.table().columns[column];
      if (!of.values.empty() && !of.broken.empty()) throw InputError(of.broken);
      Refuse(
          "{}: {} holds no numbers: the {} needs one in every row, or name another column with {}",
          file_, names_.Label(column), rules.name, rules.option);
    }
    Refuse("{}: no column for the {}: {}", file_, rules.name,
           names_.size() == 1 ? "the file has 1 column"
                              : names_.Listing() +
                                    ": name the column of the displacement with --displacement "
                                    "and that of the force with --force, by name or number");
  }

  /// Refuses a column of little evidence whose numbers are those of a clock or a counter, where
  /// those of the other role go to and fro.
  void RequireMoving(Role role, Role other, int least_evidence) {
    const std::size_t column = ColumnOf(role);
    if (!roles_[role].unit.empty() || EvidenceFor(names_[column], role) >= least_evidence ||
        names_[column].trend == 0 || !names_[ColumnOf(other)].goes_to_and_fro) {
      return;
    }
    Refuse(
        "{}:{}:{}: {} only {} while {} goes to and fro, as a clock or a counter does: choose the "
        "{} with {}, by name or number: {}",
        file_, names_.table().lines.front(), column + 1, names_.Label(column),
        names_[column].trend > 0 ? "grows" : "falls", names_.Label(ColumnOf(other)),
        RulesOf(role).name, RulesOf(role).option, names_.Listing());
  }

  void RequireOneKind() {
    const std::size_t displacement = ColumnOf(Role::kDisplacement);
    const std::size_t force = ColumnOf(Role::kForce);
    const auto turns = IsAngular(names_, displacement, roles_[Role::kDisplacement].unit);
    const auto twists = IsAngular(names_, force, roles_[Role::kForce].unit);
    roles_.is_torsional = turns == true || twists == true;
    if (!roles_.is_torsional || (turns != false && twists != false)) return;
    const auto unit = [&](Role role) {
      const std::string stated =
          roles_[role].unit.empty() ? names_.UnitOf(ColumnOf(role), "") : roles_[role].unit;
      return stated.empty() ? SiUnit(RulesOf(role).angular) : stated;
    };
    Refuse(
        "{}: {} in {} and {} in {} do not match: a torque needs an angle, a force a length; "
        "choose other columns, or give their units, as in --force '{} [N]'",
        file_, names_.Label(displacement), unit(Role::kDisplacement), names_.Label(force),
        unit(Role::kForce), force + 1);
  }

  const ColumnNames& names_;
  const std::string& file_;
  std::vector<std::string>& notes_;
  std::vector<bool> taken_;
  Roles roles_;
};

}  // namespace

const RoleRules& RulesOf(Role role) { return kRules.at(static_cast<std::size_t>(role)); }

double Quantity::ValueIn(const CsvTable& table, std::size_t row) const {
  double value = sum.offset;
  for (const auto& [column, weight] : sum.terms) {
    value += weight * table.columns[column].values[row];
  }
  return value;
}

std::vector<double> Quantity::Values(const CsvTable& table) const {
  std::vector<double> values = table.columns[first_column()].values;
  for (std::size_t row = 0; row < values.size() && !sum.is_plain(); ++row) {
    values[row] = ValueIn(table, row);
  }
  return values;
}

std::vector<double> Quantity::Numbers(const CsvTable& table) const {
  for (const Expression::Term& term : sum.terms) static_cast<void>(table.Numbers(term.column));
  std::vector<double> values = Values(table);
  for (std::size_t row = 0; row < values.size(); ++row) {
    values[row] = unit.ToSi(values[row]);
    if (!std::isfinite(values[row])) throw InputError(TooLarge(table, row));
  }
  return values;
}

std::string Quantity::TooLarge(const CsvTable& table, std::size_t row) const {
  const double value = ValueIn(table, row);
  if (std::isfinite(unit.ToSi(value))) return "";
  return fmt::format("{}:{}:{}: {} = {} {} is too large: must be below 1.8e308 in SI units",
                     table.file, table.lines[row], first_column() + 1, RulesOf(role).name, value,
                     unit.symbol);
}

ColumnNames::ColumnNames(const CsvTable& table) : table_(table) {
  columns_.reserve(table.columns.size());
  for (const TableColumn& column : table.columns) {
    columns_.push_back(ObservedIn(column.values));
    Column& added = columns_.back();
    added.name = SplitColumnName(column.name);
    added.unit = added.name.unit.empty() ? WithoutBrackets(column.unit) : added.name.unit;
    added.dimension = DimensionOf(added.unit);
    added.is_clock = column.is_clock;
  }
}

std::optional<std::size_t> ColumnNames::Named(std::string_view name, Role role) const {
  const std::string lower = LowerCase(name);
  const auto matches = [&](std::size_t column, int strictness) {
    const std::string& full = table_.columns[column].name;
    if (full.empty()) return false;
    if (strictness == 0) return full == name;
    return LowerCase(strictness == 1 ? full : columns_[column].name.name) == lower;
  };
  for (int strictness = 0; strictness < 3; ++strictness) {
    std::vector<std::size_t> found;
    found.reserve(size());
    for (std::size_t column = 0; column < size(); ++column) {
      if (matches(column, strictness)) found.push_back(column);
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
  const Expression chosen = Read(text, role);
  if (!chosen.is_plain()) {
    Refuse("{}: {} {}: must be one column", table_.file, RulesOf(role).option, text);
  }
  return chosen.terms.front().column;
}

bool ColumnNames::StatesOneUnit(std::size_t column) const {
  const std::string& unit = columns_[column].name.unit;
  const std::string_view of_row = WithoutBrackets(table_.columns[column].unit);
  return unit.empty() || of_row.empty() || unit == of_row;
}

std::string ColumnNames::UnitOf(std::size_t column, std::string_view option) const {
  const std::string& unit = columns_[column].unit;
  if (StatesOneUnit(column)) return unit;
  Refuse("{}: {} has the unit '{}' in its name and '{}' below it: choose its unit{}", Header(),
         Label(column), unit, WithoutBrackets(table_.columns[column].unit),
         option.empty() ? "" : fmt::format(" with {} '{} [{}]'", option, column + 1, unit));
}

std::string ColumnNames::NameOf(std::size_t column) const {
  const std::string& name = columns_[column].name.name;
  const auto same = [&](const Column& other) { return other.name.name == name; };
  return !name.empty() && std::ranges::count_if(columns_, same) == 1 ? name
                                                                     : std::to_string(column + 1);
}

std::string ColumnNames::Label(std::size_t column) const {
  const std::string& name = table_.columns[column].name;
  if (table_.header_line == 0 || name.empty()) return fmt::format("column {}", column + 1);
  return fmt::format("'{}' (column {})", ForMessage(name), column + 1);
}

std::string ColumnNames::MayEachBe(Role role, const std::vector<std::size_t>& columns) const {
  std::vector<std::string> labels;
  labels.reserve(columns.size());
  for (const std::size_t column : columns) labels.push_back(Label(column));
  return fmt::format("{} may each be the {}", fmt::join(labels, " and "), RulesOf(role).name);
}

void ColumnNames::ThrowAmbiguous(Role role, const std::vector<std::size_t>& columns) const {
  std::vector<std::string> choices;
  choices.reserve(columns.size());
  for (const std::size_t column : columns) {
    choices.push_back(fmt::format("{} {}", RulesOf(role).option, column + 1));
  }
  Refuse("{}: {}: give {}", Header(), MayEachBe(role, columns), fmt::join(choices, " or "));
}

std::string ColumnNames::Listing() const {
  if (std::ranges::all_of(table_.columns, [](auto& column) { return column.name.empty(); })) {
    return fmt::format("the file names none of its {} columns: choose by number", size());
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

Quantity ColumnNames::InUnit(Role role, Expression sum, bool is_torsional,
                             std::vector<std::string>& notes) const {
  const auto& [name, option, linear, angular, given] = RulesOf(role);
  const Dimension dimension = is_torsional ? angular : linear;
  const std::size_t first = sum.terms.front().column;
  const auto is_of_role = [&](const std::optional<Unit>& unit) {
    return unit && (unit->dimension == linear || unit->dimension == dimension);
  };
  const auto require_no_pressure = [&](const std::string& symbol, const std::string& where) {
    if (DimensionOf(symbol) != Dimension::kPressure) return;
    Refuse(
        "{}: {} is a pressure, in {}, and no {}: choose another column; pressure times area is an "
        "additional force, for which there is --covariate",
        where, Label(first), symbol, name);
  };
  if (!sum.unit.empty()) {
    if (const auto unit = FindUnit(sum.unit); is_of_role(unit))
      return {role, std::move(sum), *unit};
    require_no_pressure(sum.unit, table_.file);
    Refuse("{}: the {} unit '{}' is not known: must be one of {}", table_.file, name,
           ForMessage(sum.unit), UnitSymbols(dimension));
  }
  const std::string stated = UnitOf(first, option);
  const std::string si = SiUnit(dimension);
  for (const Expression::Term& term : sum.terms) {
    if (UnitOf(term.column, option) == stated) continue;
    Refuse(
        "{}: {} and {} are not in one unit: scale them, and give the unit of the sum in brackets, "
        "as in {} '… [{}]'",
        table_.file, Label(first), Label(term.column), option, si);
  }
  if (const auto unit = FindUnit(stated); is_of_role(unit)) return {role, std::move(sum), *unit};
  if (!stated.empty() && !sum.is_scaled) {
    const std::string where = fmt::format("{}:{}", Header(), first + 1);
    require_no_pressure(stated, where);
    Refuse(
        "{}: the unit '{}' of {} is not known for the {}: must be one of {}, or choose the unit "
        "with {} '{} [{}]'",
        where, ForMessage(stated), Label(first), name, UnitSymbols(dimension), option, first + 1,
        si);
  }
  if (stated.empty() && (role != Role::kTime || sum.terms.size() > 1)) {
    notes.push_back(fmt::format("{}: {} {} names no unit: taken as {}; {} '{} [{}]' says so",
                                table_.file, name, Label(first), si, option, first + 1, si));
  }
  return {role, std::move(sum), *FindUnit(si)};
}

Roles AssignRoles(const ColumnNames& names, const RecordColumns& columns,
                  std::vector<std::string>& notes) {
  return RoleAssigner(names, notes).Assign(columns);
}

}  // namespace mindahl::io
