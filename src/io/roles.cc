#include "io/roles.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <set>
#include <utility>

#include "core/refuse.h"
#include "core/text.h"

namespace mindahl::io {
namespace {

constexpr std::array kPair = {Role::kDisplacement, Role::kForce};

/// Evidence of a unit, which counts more than a word; and, more still, of going to and fro.
constexpr int kUnit = 100;
constexpr int kMoving = 1000;

/// Returns the evidence that a column has a role: 0 is none.
int EvidenceFor(const Column& column, Role role) {
  constexpr int kWord = 50;
  constexpr int kStep = 5;     // of a rank
  constexpr int kLesser = 30;  // what is commanded or raw
  const bool is_named = column.names(role);
  // "N" counts cycles or rows where it only grows.
  if (column.word == "N" && column.unit.empty() && column.trend > 0) return 0;
  // A force in newton, unless there is a better one.
  if (role == Role::kForce && column.word == "f n") return 1;
  // A normal load is one by its name alone.
  if (!is_named && (role == Role::kNormalLoad || column.names(Role::kNormalLoad))) return 0;
  const bool is_of_unit = MayHaveRole(column.dimension, role);
  const bool is_clock = role == Role::kTime && column.is_clock && (is_named || column.word.empty());
  int found = is_of_unit ? kUnit : is_clock ? kUnit - kStep : 0;
  if (is_named) {
    const int others = std::min<int>(static_cast<int>(column.other_words), kStep - 1);
    const bool may_be = column.unit.empty() || is_of_unit;
    found += may_be ? kWord - kStep * column.rank - others : role <= Role::kForce ? 1 : 0;
  }
  return found > kLesser && column.is_lesser ? found - kLesser : found;
}

/// Returns how well a column suits a role, 0 not at all: what moves is a displacement or a force.
/// @param turns  whether it is to be an angle or a torque, where that is known
int ScoreFor(const Column& column, Role role, std::optional<bool> turns) {
  const int evidence = EvidenceFor(column, role);
  if (role > Role::kForce || evidence == 0) return column.is_numeric ? evidence : 0;
  // A column of text, or of the other kind, is taken where there is no other, and refused.
  const bool is_other = turns && column.IsAngular("").value_or(*turns) != *turns;
  return is_other || column.values.empty() ? 1 : evidence + (column.goes_to_and_fro ? kMoving : 0);
}

/// Returns the unit in which a number is a stamp since 1970, "" where it is none.
std::string UnitOfStamp(double number) {
  constexpr double kFrom2001 = 1e9;  // [s] since 1970, to 2100
  constexpr double kTo2100 = 4.1e9;
  for (const char* const unit : {"s", "ms", "us", "ns"}) {
    const double seconds = FindUnit(unit)->ToSi(number);
    if (seconds >= kFrom2001 && seconds <= kTo2100) return unit;
  }
  return "";
}

constexpr std::string_view kSum =
    "a sum of columns with finite factors and an offset, like raw*0.0123-4.5 [N], with #3 for the "
    "third column";

/// Returns the column of a name, or of a number from 1 behind '#'; refuses one that is not there.
std::size_t ColumnIn(std::string_view name, const CsvTable& table, std::string_view at, Role role) {
  const auto number = NumberIn<std::size_t>(name.starts_with('#') ? name.substr(1) : "");
  if (number >= 1 && number <= table.columns.size()) return *number - 1;
  if (const auto named = table.Named(name, role)) return *named;
  const std::size_t divisor = std::min(name.find('/'), name.size() - 1) + 1;
  const bool is_formula = name.starts_with('(') || NumberIn<double>(name.substr(divisor));
  Refuse("{}: no column is called '{}' (for the {}): {}{}{}", at, name, RulesOf(role).name,
         table.Listing(), is_formula ? "; a formula must be " : "", is_formula ? kSum : "");
}

/// Returns what a column is called in a sum: its name, or its number where that has a sign of a sum
/// or is another's too.
std::string NameInSum(std::size_t column, const CsvTable& table) {
  const auto is_like = [](const std::string& name) {
    return [&name](const Column& of) { return of.header == name || of.name == name; };
  };
  for (const std::string& name : {table.columns[column].header, table.columns[column].name}) {
    if (name.empty() || !IsLetter(name.front()) || name.find_first_of("+-*/([") != name.npos) {
      continue;
    }
    if (std::ranges::count_if(table.columns, is_like(name)) == 1) return name;
  }
  return fmt::format("#{}", column + 1);
}

/// Reads a sum of products, each of numbers and at most one column.
void ReadSum(std::string_view rest, const CsvTable& table, std::string_view where, Quantity& sum) {
  constexpr std::string_view kOperators = "+-*";
  const auto require = [&](bool is_sum) {
    if (is_sum) return;
    Refuse("{}: must be {}", where, kSum);
  };
  const auto take = [&](std::size_t size) { rest = Trimmed(rest.substr(size)); };
  while (!rest.empty()) {
    double factor = 1.0;
    for (; rest.starts_with('-') || rest.starts_with('+'); take(1)) {
      if (rest.front() == '-') factor = -factor;
    }
    std::optional<std::size_t> column;
    for (bool goes_on = true; goes_on;) {
      double number = 0.0;
      const char* const stop = std::from_chars(rest.data(), rest.data() + rest.size(), number).ptr;
      auto size = static_cast<std::size_t>(stop - rest.data());
      const std::string_view behind = Trimmed(rest.substr(size)).substr(0, 1);
      if (size > 0 && kOperators.find(behind) != behind.npos) {
        factor *= number;
        sum.is_scaled = true;
      } else {
        size = std::min(rest.find_first_of(kOperators), rest.size());
        require(size > 0 && !column);
        column = ColumnIn(Trimmed(rest.substr(0, size)), table, where, sum.role);
      }
      take(size);
      goes_on = rest.starts_with('*');
      if (goes_on) take(1);
    }
    require(std::isfinite(factor) && (!column || factor != 0));
    if (column) sum.terms.push_back({*column, factor});
    if (!column) sum.offset += factor;
  }
  require(!sum.terms.empty());
}

/// Reads a text of RecordColumns. One that is a name as a whole is that column; in a sum, a column
/// is called by number behind '#'.
/// @throws InputError for an unknown or ambiguous one
Quantity ReadQuantity(const std::string& given, const CsvTable& table, Role role) {
  std::string_view text = Trimmed(given);
  const auto named = NumberIn<std::size_t>(text) ? std::nullopt : table.Named(text, role);
  if (named) return {.role = role, .terms = {{*named}}};
  Quantity quantity{.role = role};
  if (const std::size_t open = text.rfind('['); text.ends_with(']') && open != text.npos) {
    quantity.given_unit = Trimmed(text.substr(open + 1, text.size() - open - 2));
    text = Trimmed(text.substr(0, open));
  }
  // A number alone is that of a column.
  const std::string sum = (NumberIn<std::size_t>(text) ? "#" : "") + std::string(text);
  const std::string where = fmt::format("{}: {} {}", table.file, RulesOf(role).option, given);
  if (!sum.empty()) ReadSum(sum, table, where, quantity);
  return quantity;
}

bool IsRatio(std::string_view unit) { return unit == kRatioUnit || unit == "-"; }

/// Finds the unit of a quantity: as given, of the header, or, with a note, that of a stamp or SI.
/// @throws InputError for a unit that is none of the role's, and for columns in several units
void FindUnitOf(Quantity& quantity, const CsvTable& table, bool is_torsional,
                std::vector<std::string>& notes) {
  const RoleRules& rules = RulesOf(quantity.role);
  const Dimension dimension = is_torsional ? rules.angular : rules.linear;
  const std::size_t first = quantity.first_column();
  const Column& of = table.columns[first];
  const std::string label = table.Label(first);
  const bool is_time = quantity.role == Role::kTime;
  const bool overrides = !quantity.given_unit.empty() && !of.unit.empty() && !quantity.is_scaled;
  std::string stamp = is_time && !quantity.is_scaled ? UnitOfStamp(of.first) : "";
  if (is_time && of.is_clock) stamp = quantity.given_unit = "s";
  const bool is_given = !quantity.given_unit.empty();
  std::set<std::string> stated;
  for (const Quantity::Term& term : quantity.terms) {
    stated.insert(is_given ? quantity.given_unit : table.columns[term.column].unit);
  }
  const std::string symbol = fmt::format("{}", fmt::join(stated, " and "));
  const std::string symbols = UnitSymbols(dimension);
  std::string assumed = symbols.substr(0, symbols.find(','));
  const auto unit = FindUnit(symbol);
  const bool may_be_linear = quantity.role > Role::kForce;  // a load of a joint may be a force
  const bool is_known =
      unit && (unit->dimension == dimension || (may_be_linear && unit->dimension == rules.linear));
  if (!is_known && (is_given || (!symbol.empty() && !quantity.is_scaled) || stated.size() > 1)) {
    const std::string where =
        is_given ? table.file : fmt::format("{}:{}", table.Header(), first + 1);
    const bool is_ratio = IsRatio(symbol);
    if (is_ratio || IsOfSignal(symbol)) {
      const bool by_load = is_ratio && quantity.role == Role::kForce && !is_torsional;
      const std::string_view factor = by_load ? "LOAD" : "GAIN";
      Refuse(
          "{}: {} is {}, no {} before it is multiplied by {}: {} '{}*{} [{}]' with its number "
          "for {}",
          where, label, is_ratio ? "a ratio" : "in " + symbol, rules.name,
          by_load ? "the load" : "a gain", rules.option, NameInSum(first, table), factor, assumed,
          factor);
    }
    Refuse(
        "{}: the unit '{}' of {} is not known for the {}: must be one of {}, as in {} '{} [{}]', "
        "or with a factor '#{}*0.001 [{}]'",
        where, symbol, label, rules.name, symbols, rules.option, first + 1, assumed, first + 1,
        assumed);
  }
  if (symbol.empty()) {
    quantity.has_no_unit = true;
    if (!stamp.empty()) assumed = stamp;
    notes.push_back(fmt::format("{}: {} {} names no unit: taken as {}; {} '{} [{}]' says so",
                                table.file, rules.name, label, assumed, rules.option, first + 1,
                                assumed));
  }
  quantity.unit = is_known ? *unit : *FindUnit(assumed);
  if (const auto stated_unit = FindUnit(of.unit);
      overrides && (!stated_unit || stated_unit->symbol != quantity.unit.symbol)) {
    notes.push_back(fmt::format(
        "{}: {} {} {}, and is taken in {}, as {} says", table.file, rules.name, label,
        IsRatio(of.unit) ? "is a ratio" : "names " + of.unit, quantity.unit.symbol, rules.option));
  }
  if (!stamp.empty() && stamp == quantity.unit.symbol) quantity.offset -= of.first;
}

class RoleAssigner {
 public:
  RoleAssigner(const CsvTable& table, std::vector<std::string>& notes)
      : table_(table), notes_(notes), taken_(table.columns.size()) {}

  std::vector<Quantity> Assign(const RecordColumns& asked) && {
    const bool has_load = asked.normal_load != "none";
    for (const Role role : {Role::kDisplacement, Role::kForce, Role::kTime, Role::kNormalLoad}) {
      const bool is_none = role == Role::kNormalLoad && !has_load;
      roles_.push_back(ReadQuantity(is_none ? "" : asked.*RulesOf(role).given, table_, role));
      for (const Quantity::Term& term : roles_.back().terms) {
        if (taken_[term.column]) {
          Refuse("{}: {} is chosen for the {} and for another quantity: choose two columns",
                 table_.file, table_.Label(term.column), RulesOf(role).name);
        }
        taken_[term.column] = true;
      }
    }
    const std::array is_found = {IsMissing(kPair[0]), IsMissing(kPair[1])};
    const bool turns = SuitAsAngleAndTorque();
    for (const Role role : kPair) TakeBest(role, turns);
    if (!asked.sample_rate) {
      TakeBest(Role::kTime);
    } else if (const auto time = BestTime(table_)) {
      Note("the times are those of --sample-rate, not of {}", table_.Label(*time));
    }
    // A load that is fitted as a force of its own is not also the law's, unless it is asked to be.
    for (const std::string& covariate : asked.covariates) {
      taken_[ReadCovariate(covariate, table_)] = true;
    }
    if (has_load) TakeBest(Role::kNormalLoad);
    Quantity& load = Of(Role::kNormalLoad);
    if (load.is_plain() && ColumnOf(Role::kNormalLoad).greatest < 0) {
      load.terms.front().weight = -1.0;
      Note("normal load {} is negative throughout: its magnitude is taken",
           table_.Label(load.first_column()));
    }
    TakeLeft();
    for (const std::size_t k : {0U, 1U}) {
      if (is_found[k]) RequireMoving(kPair[k], kPair[1 - k]);
    }
    const bool is_torsional = std::ranges::any_of(
        kPair, [this](Role role) { return ColumnOf(role).IsAngular(Of(role).given_unit) == true; });
    std::erase_if(roles_, [](const Quantity& quantity) { return quantity.terms.empty(); });
    for (Quantity& quantity : roles_) FindUnitOf(quantity, table_, is_torsional, notes_);
    return std::move(roles_);
  }

 private:
  Quantity& Of(Role role) { return roles_.at(static_cast<std::size_t>(role)); }
  bool IsMissing(Role role) { return Of(role).terms.empty(); }
  const Column& ColumnOf(Role role) { return table_.columns[Of(role).first_column()]; }
  void Take(std::size_t column, Role role) {
    taken_[column] = true;
    Of(role).terms = {{column}};
  }
  template <typename... Parts>
  void Note(fmt::format_string<Parts...> text, Parts&&... parts) {
    notes_.push_back(table_.file + ": " + fmt::format(text, std::forward<Parts>(parts)...));
  }

  /// True if the columns suit an angle and a torque better than a displacement and a force.
  bool SuitAsAngleAndTorque() {
    std::array<int, 2> scores{};
    for (const bool turns : {false, true}) {
      for (const Role role : kPair) {
        int most = 0;  // 1 is that of a column of the other kind
        for (std::size_t column = 0; column < taken_.size(); ++column) {
          if (taken_[column] || !IsMissing(role)) continue;
          most = std::max(most, ScoreFor(table_.columns[column], role, turns));
        }
        const bool is_given =
            !IsMissing(role) &&
            ColumnOf(role).IsAngular(Of(role).given_unit).value_or(turns) == turns;
        if (is_given || most > 1) scores[turns ? 1 : 0] += 10 * kMoving + most;
      }
    }
    return scores[1] > scores[0];
  }

  /// Takes the column with the best evidence, where none is given.
  void TakeBest(Role role, std::optional<bool> turns = {}) {
    if (!IsMissing(role)) return;
    const auto best = table_.Best(role, role > Role::kForce, [&](std::size_t column) {
      return taken_[column] ? 0 : ScoreFor(table_.columns[column], role, turns);
    });
    if (!best && role > Role::kForce && !Of(role).given_unit.empty()) ThrowNoColumn(role);
    if (!best) return;
    const Column& of = table_.columns[*best];
    if (role <= Role::kForce && of.goes_to_and_fro) NoteThatItMoves(*best, role);
    Take(*best, role);
    const std::size_t next = *best + 1;
    if (role == Role::kTime && next < taken_.size() && of.unit == "sec" &&
        LowerCase(table_.columns[next].name).ends_with("nanosec")) {
      Of(role).terms.push_back({next, 1e-9});  // of the same stamp
      Of(role).given_unit = "s";
      taken_[next] = true;
    }
  }

  /// Says so where a column that has as much evidence of a role is not taken, as it rests.
  void NoteThatItMoves(std::size_t taken, Role role) {
    const int evidence = EvidenceFor(table_.columns[taken], role);
    for (std::size_t column = 0; column < taken_.size(); ++column) {
      const Column& of = table_.columns[column];
      if (of.goes_to_and_fro || !of.is_numeric || taken_[column]) continue;
      if (EvidenceFor(of, role) < evidence) continue;
      return Note("the {} is {}, as {} does not go to and fro", RulesOf(role).name,
                  table_.Label(taken), table_.Label(column));
    }
  }

  /// Gives roles that no name or unit decides to the columns that are left, if they are as many.
  void TakeLeft() {
    std::vector<Role> missing(kPair.begin(), kPair.end());
    std::erase_if(missing, [&](Role role) { return !IsMissing(role); });
    if (missing.empty()) return;
    std::vector<std::size_t> left, moving;
    for (std::size_t column = 0; column < taken_.size(); ++column) {
      const Column& of = table_.columns[column];
      const bool is_unknown = of.unit.empty() && of.word.empty() && !of.is_clock;
      if (taken_[column] || !is_unknown || !of.is_numeric) continue;
      left.push_back(column);
      if (of.trend == 0 && of.greatest > of.least) moving.push_back(column);
    }
    if (left.size() > missing.size()) left = moving;
    if (left.size() != missing.size()) ThrowNoColumn(missing.front());
    for (std::size_t k = 0; k < left.size(); ++k) {
      Take(left[k], missing[k]);
      Note("no column name is recognised as {}: taken from {}{}", RulesOf(missing[k]).name,
           table_.Label(left[k]), left.size() > 1 ? ", of two in their order" : "");
    }
  }

  [[noreturn]] void ThrowNoColumn(Role role) {
    Refuse("{}: no column for the {}: {}: choose it with {}, by name or number", table_.file,
           RulesOf(role).name, table_.Listing(), RulesOf(role).option);
  }

  /// Refuses a column without a unit that only grows or falls, where the other goes to and fro.
  void RequireMoving(Role role, Role other) {
    const Column& of = ColumnOf(role);
    const bool has_unit = !Of(role).given_unit.empty() || EvidenceFor(of, role) >= kUnit;
    if (has_unit || of.trend == 0 || !ColumnOf(other).goes_to_and_fro) return;
    const std::size_t column = Of(role).first_column();
    Refuse(
        "{}:{}:{}: {} only {} while {} goes to and fro, as a clock or a counter does: choose the "
        "{} with {}, by name or number: {}",
        table_.file, table_.lines.front(), column + 1, table_.Label(column),
        of.trend > 0 ? "grows" : "falls", table_.Label(Of(other).first_column()),
        RulesOf(role).name, RulesOf(role).option, table_.Listing());
  }

  const CsvTable& table_;
  std::vector<std::string>& notes_;
  std::vector<bool> taken_;
  std::vector<Quantity> roles_;  // in the order of Role
};

}  // namespace

std::size_t ReadCovariate(const std::string& text, const CsvTable& table) {
  const Quantity chosen = ReadQuantity(text, table, Role::kOther);
  if (chosen.is_plain()) return chosen.first_column();
  Refuse("{}: --covariate {}: must be one column", table.file, text);
}

Quantity ReadImposed(const std::string& text, const CsvTable& table) {
  Quantity displacement = ReadQuantity(text, table, Role::kDisplacement);
  if (displacement.terms.empty()) {
    const Column& front = table.columns.front();
    const auto is = [&](Role role) {
      return front.names(role) || MayHaveRole(front.dimension, role);
    };
    const bool is_another = is(Role::kTime) || is(Role::kForce);
    const auto best = table.Best(Role::kDisplacement, false, [&](std::size_t column) {
      return is_another ? ScoreFor(table.columns[column], Role::kDisplacement, {}) : 0;
    });
    displacement.terms = {{best.value_or(0)}};
  }
  const Column& first = table.columns[displacement.first_column()];
  std::vector<std::string> notes;  // SI is the documented default here
  FindUnitOf(displacement, table, first.IsAngular(displacement.given_unit) == true, notes);
  return displacement;
}

std::optional<std::size_t> BestTime(const CsvTable& table) {
  return table.Best(Role::kTime, true, [&](std::size_t column) {
    return ScoreFor(table.columns[column], Role::kTime, {});
  });
}

std::vector<Quantity> AssignRoles(const CsvTable& table, const RecordColumns& asked,
                                  std::vector<std::string>& notes) {
  return RoleAssigner(table, notes).Assign(asked);
}

}  // namespace mindahl::io
