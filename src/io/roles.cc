#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <utility>

#include "core/refuse.h"
#include "core/text.h"
#include "io/columns.h"

namespace mindahl::io {
namespace {

constexpr std::array kPair = {Role::kDisplacement, Role::kForce};

/// Evidence of a unit, which counts more than a word; and of numbers that go to and fro, more
/// still.
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
  int found = 0;
  if (is_of_unit) {
    found = kUnit;
  } else if (role == Role::kTime && column.is_clock && (is_named || column.word.empty())) {
    found = kUnit - kStep;
  }
  if (is_named) {
    const int others = std::min<int>(static_cast<int>(column.other_words), kStep - 1);
    const bool may_be = column.unit.empty() || is_of_unit;
    found += may_be ? kWord - kStep * column.rank - others : role <= Role::kForce ? 1 : 0;
  }
  return found > kLesser && column.is_lesser ? found - kLesser : found;
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
  RoleAssigner(const Columns& columns, std::vector<std::string>& notes)
      : columns_(columns), file_(columns.table().file), notes_(notes), taken_(columns.size()) {}

  std::vector<Quantity> Assign(const RecordColumns& asked) && {
    const bool has_load = asked.normal_load != "none";
    for (const Role role : {Role::kDisplacement, Role::kForce, Role::kTime, Role::kNormalLoad}) {
      const bool is_none = role == Role::kNormalLoad && !has_load;
      roles_.push_back(ReadQuantity(is_none ? "" : asked.*RulesOf(role).given, columns_, role));
      for (const Quantity::Term& term : roles_.back().terms) {
        if (taken_[term.column]) {
          Refuse("{}: {} is chosen for the {} and for another quantity: choose two columns", file_,
                 columns_.Label(term.column), RulesOf(role).name);
        }
        taken_[term.column] = true;
      }
    }
    const std::array is_found = {IsMissing(kPair[0]), IsMissing(kPair[1])};
    FindPair();
    if (!asked.sample_rate) TakeTime();
    // A load that is fitted as a force of its own is not also the law's, unless it is asked to be.
    for (const std::string& covariate : asked.covariates) {
      taken_[ReadCovariate(covariate, columns_)] = true;
    }
    if (has_load) TakeLoad();
    TakeLeft();
    for (const std::size_t k : {0U, 1U}) {
      if (is_found[k]) RequireMoving(kPair[k], kPair[1 - k]);
    }
    RequireNoCoefficient(is_found[1]);
    const bool is_torsional = RequireOneKind();
    std::erase_if(roles_, [](const Quantity& quantity) { return quantity.terms.empty(); });
    for (Quantity& quantity : roles_) FindUnitOf(quantity, columns_, is_torsional, notes_);
    return std::move(roles_);
  }

 private:
  Quantity& Of(Role role) { return roles_.at(static_cast<std::size_t>(role)); }
  bool IsMissing(Role role) { return Of(role).terms.empty(); }
  const Column& ColumnOf(Role role) { return columns_[Of(role).first_column()]; }
  void Take(std::size_t column, Role role) {
    taken_[column] = true;
    Of(role).terms = {{column}};
  }
  template <typename... Parts>
  void Note(fmt::format_string<Parts...> text, Parts&&... parts) {
    notes_.push_back(file_ + ": " + fmt::format(text, std::forward<Parts>(parts)...));
  }

  /// Takes the column with the best evidence, where none is given.
  void TakeBest(Role role) {
    if (!IsMissing(role)) return;
    if (const auto found = BestColumn(columns_, role, taken_)) return Take(*found, role);
    if (!Of(role).given_unit.empty()) ThrowNoColumn(role);
  }

  /// Takes the time; of a stamp of whole seconds, "header.stamp.sec", with that of its nanoseconds.
  void TakeTime() {
    const bool is_given = !IsMissing(Role::kTime);
    TakeBest(Role::kTime);
    if (is_given || IsMissing(Role::kTime)) return;
    const std::string stamp = LowerCase(ColumnOf(Role::kTime).name);
    const std::size_t at = stamp.rfind("sec");
    for (const std::string_view prefix : {"nano", "n"}) {
      if (at == stamp.npos) return;
      const auto column = columns_.Named(std::string(stamp).insert(at, prefix), Role::kTime);
      if (column && !taken_[*column]) return Of(Role::kTime).terms.push_back({*column, 1e-9});
    }
  }

  /// Takes the normal load; beside what is a friction force by its name a "load" is one too. Of one
  /// that is negative throughout the magnitude is taken.
  void TakeLoad() {
    TakeBest(Role::kNormalLoad);
    const bool is_beside_friction = !IsMissing(Role::kForce) &&
                                    ColumnOf(Role::kForce).names(Role::kForce) &&
                                    ColumnOf(Role::kForce).rank == 0;
    for (std::size_t column = 0; column < taken_.size() && is_beside_friction; ++column) {
      const Column& of = columns_[column];
      const bool is_load = of.names(Role::kForce) && of.rank == 2 && !of.is_angular &&
                           of.other_words == 0 && of.is_numeric &&
                           (of.unit.empty() || of.dimension == Dimension::kForce);
      if (is_load && !taken_[column] && IsMissing(Role::kNormalLoad)) {
        Take(column, Role::kNormalLoad);
      }
    }
    Quantity& load = Of(Role::kNormalLoad);
    if (!load.is_plain() || ColumnOf(Role::kNormalLoad).greatest >= 0) return;
    load.terms.front().weight = -1.0;
    Note("normal load {} is negative throughout: its magnitude is taken",
         columns_.Label(load.first_column()));
  }

  /// A column that may be the displacement, or the force; or none.
  struct Candidate {
    std::size_t column;
    int score = 0;  // evidence, and whether it goes to and fro
    std::optional<bool> is_angular = {};
  };
  /// A displacement and a force.
  struct Pair {
    int score = std::numeric_limits<int>::min();
    std::array<std::size_t, 2> columns = {}, rivals = {};  // of the same score
  };

  std::vector<Candidate> CandidatesFor(Role role) {
    std::vector<Candidate> candidates;
    for (std::size_t column = 0; column < columns_.size(); ++column) {
      const Column& of = columns_[column];
      const int evidence = EvidenceFor(of, role);
      const bool is_free = IsMissing(role) && !taken_[column] && of.is_numeric && evidence > 0;
      if (!is_free && (IsMissing(role) || column != Of(role).first_column())) continue;
      candidates.push_back({column, evidence + (of.goes_to_and_fro ? kMoving : 0),
                            of.IsAngular(Of(role).given_unit)});
    }
    if (IsMissing(role)) candidates.push_back({columns_.size()});
    return candidates;
  }

  /// Takes the displacement and the force of the most evidence: before all others two that go
  /// together, then two that do not, which is refused.
  void FindPair() {
    constexpr int kWeak = 60;  // two columns by words that are hardly any
    constexpr int kMixed = 1'000'000;
    enum Kind { kLinear, kAngular, kMixture };
    const std::size_t none = columns_.size();
    std::array<Pair, 3> best;  // of each kind
    const std::vector<Candidate> forces = CandidatesFor(Role::kForce);
    for (const Candidate& x : CandidatesFor(Role::kDisplacement)) {
      for (const Candidate& force : forces) {
        if (x.column == force.column && x.column != none) continue;
        const bool is_mixed = x.is_angular && force.is_angular && x.is_angular != force.is_angular;
        const bool is_angular = x.is_angular.value_or(force.is_angular.value_or(false));
        const bool is_whole = x.column != none && force.column != none;
        const int score =
            x.score + force.score - (is_mixed ? kMixed : 0) - (is_whole ? 0 : 2 * kMixed);
        Pair& pair = best.at(is_mixed ? kMixture : is_angular ? kAngular : kLinear);
        const std::array columns = {x.column, force.column};
        if (score > pair.score) pair = {score, columns, columns};
        if (score == pair.score) pair.rivals = columns;
      }
    }
    const auto& [line, turn, mixture] = best;
    if (std::min(line.score, turn.score) > kWeak && std::abs(line.score - turn.score) < kMoving &&
        line.columns[0] != turn.columns[0] && line.columns[1] != turn.columns[1]) {
      columns_.ThrowAmbiguous(Role::kDisplacement, line.columns[0], turn.columns[0]);
    }
    const Pair& pair = *std::ranges::max_element(best, {}, &Pair::score);
    for (const std::size_t k : {0U, 1U}) {
      const auto [column, rival] = std::pair(pair.columns[k], pair.rivals[k]);
      if (rival != column) columns_.ThrowAmbiguous(kPair[k], column, rival);
      if (!IsMissing(kPair[k]) || column == none) continue;
      NoteThatItMoves(column, kPair[k]);
      Take(column, kPair[k]);
    }
  }

  /// Says so where a column that has as much evidence of a role is not taken, as it rests.
  void NoteThatItMoves(std::size_t taken, Role role) {
    const int evidence = EvidenceFor(columns_[taken], role);
    for (std::size_t column = 0; column < taken_.size(); ++column) {
      const Column& of = columns_[column];
      const bool rests = columns_[taken].goes_to_and_fro && !of.goes_to_and_fro;
      if (!rests || taken_[column] || !of.is_numeric || EvidenceFor(of, role) < evidence) continue;
      return Note("the {} is {}, as {} does not go to and fro", RulesOf(role).name,
                  columns_.Label(taken), columns_.Label(column));
    }
  }

  /// Gives what no name or unit decides to the columns of numbers that are left, if they are as
  /// many.
  void TakeLeft() {
    std::vector<Role> missing(kPair.begin(), kPair.end());
    std::erase_if(missing, [&](Role role) { return !IsMissing(role); });
    std::vector<std::size_t> left;
    for (std::size_t column = 0; column < taken_.size(); ++column) {
      const Column& of = columns_[column];
      const bool is_unknown = of.unit.empty() && of.word.empty() && !of.is_clock;
      if (!taken_[column] && is_unknown && of.is_numeric) left.push_back(column);
    }
    if (left.size() > missing.size()) {
      std::erase_if(left, [&](std::size_t column) {
        return columns_[column].trend != 0 || !(columns_[column].greatest > columns_[column].least);
      });
    }
    if (missing.empty()) return;
    if (left.size() != missing.size()) ThrowNoColumn(missing.front());
    for (std::size_t k = 0; k < left.size(); ++k) {
      Take(left[k], missing[k]);
      Note("no column name is recognised as {}: taken from {}{}", RulesOf(missing[k]).name,
           columns_.Label(left[k]), left.size() > 1 ? ", of two in their order" : "");
    }
  }

  /// Refuses a coefficient of friction as the force: one by its name, or a friction without a unit
  /// and below 2 beside a load in newton; and that load, where it never changes its sign. Whoever
  /// gives a unit is believed.
  void RequireNoCoefficient(bool finds_force) {
    constexpr double kGreatest = 2;
    const Quantity& force = Of(Role::kForce);
    if (!force.given_unit.empty() || force.is_scaled) return;
    const Column& taken = ColumnOf(Role::kForce);
    const auto loads = std::ranges::count_if(columns_, [](const Column& of) {
      return of.dimension == Dimension::kForce || of.names(Role::kNormalLoad);
    });
    const bool is_load = finds_force && (taken.least > 0 || taken.greatest < 0) && loads < 2;
    for (const Column& of : columns_) {
      const bool is_named = of.names(Role::kFrictionCoefficient);
      const bool may_be = (of.word == "friction" || of.word == "f") && of.unit.empty() &&
                          of.least > -kGreatest && of.greatest < kGreatest;
      const bool is_taken = &of == &taken;
      if (!(is_taken ? is_named || (may_be && loads > 0) : is_load && (is_named || may_be))) {
        continue;
      }
      const auto column = static_cast<std::size_t>(&of - columns_.data());
      Refuse(
          "{}:{}: {} is a coefficient of friction, or looks like one, and no force: choose the "
          "force with --force, or multiply by the normal load, where that is 50 N by --force "
          "'#{}*50 [N]'; if it is a force, say so by --force '{} [N]'",
          columns_.Header(), column + 1, columns_.Label(column), column + 1, column + 1);
    }
  }

  [[noreturn]] void ThrowNoColumn(Role role) {
    for (std::size_t column = 0; column < columns_.size(); ++column) {
      const bool is_named = !columns_.table().columns[column].name.empty();
      const bool is_other = is_named && EvidenceFor(columns_[column], role) == 0;
      if (columns_[column].is_numeric || is_other) continue;
      static_cast<void>(columns_.table().Numbers(column));  // throws
    }
    Refuse("{}: no column for the {}: {}: choose it with {}, by name or number", file_,
           RulesOf(role).name, columns_.Listing(), RulesOf(role).option);
  }

  /// Refuses a column without a unit whose numbers are those of a clock or a counter, where those
  /// of the other role go to and fro.
  void RequireMoving(Role role, Role other) {
    const Column& of = ColumnOf(role);
    if (!Of(role).given_unit.empty() || EvidenceFor(of, role) >= kUnit || of.trend == 0 ||
        !ColumnOf(other).goes_to_and_fro) {
      return;
    }
    const std::size_t column = Of(role).first_column();
    Refuse(
        "{}:{}:{}: {} only {} while {} goes to and fro, as a clock or a counter does: choose the "
        "{} with {}, by name or number: {}",
        file_, columns_.table().lines.front(), column + 1, columns_.Label(column),
        of.trend > 0 ? "grows" : "falls", columns_.Label(Of(other).first_column()),
        RulesOf(role).name, RulesOf(role).option, columns_.Listing());
  }

  /// @returns true for a torque against an angle
  bool RequireOneKind() {
    const auto turns = ColumnOf(kPair[0]).IsAngular(Of(kPair[0]).given_unit);
    const auto twists = ColumnOf(kPair[1]).IsAngular(Of(kPair[1]).given_unit);
    const bool is_torsional = turns == true || twists == true;
    if (!is_torsional || (turns != false && twists != false)) return is_torsional;
    const std::size_t force = Of(Role::kForce).first_column();
    Refuse(
        "{}: {} and {} do not match: a torque needs an angle, a force a length: choose other "
        "columns, or give their units, as in --force '{} [N]'",
        file_, columns_.Label(Of(Role::kDisplacement).first_column()), columns_.Label(force),
        force + 1);
  }

  const Columns& columns_;
  const std::string& file_;
  std::vector<std::string>& notes_;
  std::vector<bool> taken_;
  std::vector<Quantity> roles_;  // in the order of Role
};

/// Returns the column of a number from 1.
/// @param where  it stands, for the refusal of one that there is not
std::size_t Numbered(std::size_t number, const Columns& columns, const std::string& where) {
  if (number >= 1 && number <= columns.size()) return number - 1;
  Refuse("{}: there is no column {}: the file has {} column{}", where, number, columns.size(),
         columns.size() == 1 ? "" : "s");
}

/// Reads a sum of products, each of numbers and at most one column.
void ReadSum(std::string_view rest, const Columns& columns, const std::string& where,
             Quantity& sum) {
  constexpr std::string_view kOperators = "+-*";
  const auto require = [&](bool is_sum) {
    if (is_sum) return;
    Refuse(
        "{}: must be a sum of columns with finite factors and an offset, like raw*0.0123-4.5 [N], "
        "with #3 for the third column",
        where);
  };
  const auto take = [&](std::size_t size) { rest = Trimmed(rest.substr(size)); };
  do {
    double factor = 1.0;
    for (; rest.starts_with('-') || rest.starts_with('+'); take(1)) {
      if (rest.front() == '-') factor = -factor;
    }
    std::optional<std::size_t> column;
    for (;; take(1)) {
      double number = 0.0;
      const auto [stop, error] = std::from_chars(rest.data(), rest.data() + rest.size(), number);
      auto size = static_cast<std::size_t>(stop - rest.data());
      const std::string_view after = Trimmed(rest.substr(size));
      const bool ends = after.empty() || kOperators.find(after.front()) != after.npos;
      if (error == std::errc() && size > 0 && ends) {
        factor *= number;
        sum.is_scaled = true;
      } else {
        size = std::min(rest.find_first_of(kOperators), rest.size());
        const std::string_view name = Trimmed(rest.substr(0, size));
        require(!name.empty() && !column);
        const auto behind = NumberIn<std::size_t>(Trimmed(name.substr(1)));
        column = name.starts_with('#') && behind ? Numbered(*behind, columns, where)
                                                 : columns.Named(name, sum.role);
        if (!column) {
          Refuse("{}: no column is called '{}' (for the {}): {}", where, name,
                 RulesOf(sum.role).name, columns.Listing());
        }
      }
      take(size);
      if (!rest.starts_with('*')) break;
    }
    require(std::isfinite(factor) && (!column || factor != 0));
    if (column) {
      sum.terms.push_back({*column, factor});
    } else {
      sum.offset += factor;
    }
  } while (!rest.empty());
  require(!sum.terms.empty());
}

}  // namespace

std::vector<double> Quantity::Numbers(const CsvTable& table) const {
  for (const Term& term : terms) static_cast<void>(table.Numbers(term.column));
  std::vector<double> values(table.rows());
  for (std::size_t row = 0; row < values.size(); ++row) {
    values[row] = unit.ToSi(ValueIn(table, row));
  }
  return values;
}

Quantity ReadQuantity(const std::string& given, const Columns& columns, Role role) {
  Quantity quantity{.role = role};
  std::string_view text = Trimmed(given);
  if (text.empty()) return quantity;
  const std::string where =
      fmt::format("{}: {} {}", columns.table().file, RulesOf(role).option, given);
  const auto named = NumberIn<std::size_t>(text) ? std::nullopt : columns.Named(text, role);
  if (named) {
    quantity.terms = {{*named}};
    return quantity;
  }
  if (const std::size_t open = text.rfind('['); text.ends_with(']') && open != text.npos) {
    quantity.given_unit = Trimmed(text.substr(open + 1, text.size() - open - 2));
    text = Trimmed(text.substr(0, open));
  }
  if (const auto number = NumberIn<std::size_t>(text)) {
    quantity.terms = {{Numbered(*number, columns, where)}};
  } else if (!text.empty()) {
    ReadSum(text, columns, where, quantity);
  }
  return quantity;
}

std::size_t ReadCovariate(const std::string& text, const Columns& columns) {
  const Quantity chosen = ReadQuantity(text, columns, Role::kOther);
  if (chosen.is_plain()) return chosen.first_column();
  Refuse("{}: --covariate {}: must be one column", columns.table().file, text);
}

std::optional<std::size_t> BestColumn(const Columns& columns, Role role,
                                      const std::vector<bool>& taken) {
  std::optional<std::size_t> best;
  int most = 0;
  for (std::size_t column = 0; column < columns.size(); ++column) {
    if ((!taken.empty() && taken[column]) || !columns[column].is_numeric) continue;
    const int evidence = EvidenceFor(columns[column], role);
    if (evidence <= most) continue;
    most = evidence;
    best = column;
  }
  return best;
}

void FindUnitOf(Quantity& quantity, const Columns& columns, bool is_torsional,
                std::vector<std::string>& notes) {
  const auto& [name, option, linear, angular, given, chosen, values] = RulesOf(quantity.role);
  const std::string& file = columns.table().file;
  const Dimension dimension = is_torsional ? angular : linear;
  const std::size_t first = quantity.first_column();
  const Column& of = columns[first];
  const bool is_time = quantity.role == Role::kTime;
  const bool is_clock = is_time && of.is_clock;
  const std::string of_stamp = is_time && !quantity.is_scaled ? UnitOfStamp(of.first) : "";
  std::string symbol = is_clock ? "s" : quantity.given_unit;
  const bool is_given = !symbol.empty();
  if (!is_given) symbol = columns.UnitOf(first, quantity.role);
  const std::string symbols = UnitSymbols(dimension);
  std::string assumed = symbols.substr(0, symbols.find(','));
  for (const Quantity::Term& term : quantity.terms) {
    if (is_given || columns.UnitOf(term.column, quantity.role) == symbol) continue;
    Refuse(
        "{}: {} and {} are not in one unit: scale them, and give the unit of the sum in brackets, "
        "as in {} '… [{}]'",
        file, columns.Label(first), columns.Label(term.column), option, assumed);
  }
  const auto unit = FindUnit(symbol);
  if (unit && (unit->dimension == linear || unit->dimension == dimension)) {
    quantity.unit = *unit;
  } else if (is_given || (!symbol.empty() && !quantity.is_scaled)) {
    Refuse(
        "{}: the unit '{}' of {} is not known for the {}: must be one of {}, as in {} '{} [{}]', "
        "or with a factor '#{}*0.001 [{}]'",
        is_given ? file : fmt::format("{}:{}", columns.Header(), first + 1), symbol,
        columns.Label(first), name, symbols, option, first + 1, assumed, first + 1, assumed);
  } else {
    if (symbol.empty()) {
      quantity.has_no_unit = true;
      if (!of_stamp.empty()) assumed = of_stamp;
      notes.push_back(fmt::format("{}: {} {} names no unit: taken as {}; {} '{} [{}]' says so",
                                  file, name, columns.Label(first), assumed, option, first + 1,
                                  assumed));
    }
    quantity.unit = *FindUnit(assumed);
  }
  if (!is_clock && (of_stamp.empty() || of_stamp != quantity.unit.symbol)) return;
  quantity.offset -= of.first;
  notes.push_back(fmt::format("{}: time {} holds dates or times of day: counted from the first",
                              file, columns.Label(first)));
}

std::vector<Quantity> AssignRoles(const Columns& columns, const RecordColumns& asked,
                                  std::vector<std::string>& notes) {
  return RoleAssigner(columns, notes).Assign(asked);
}

}  // namespace mindahl::io
