#include "io/expression.h"

#include <fmt/format.h>

#include <cmath>
#include <system_error>

#include "core/from_chars.h"
#include "io/cells.h"
#include "mindahl/core/error.h"

namespace mindahl::io {
namespace {

constexpr std::string_view kOperators = "+-*/";

/// Reads a sum of products, each of numbers and at most one column.
class ExpressionReader {
 public:
  ExpressionReader(std::string_view text, std::size_t columns, const FindColumn& find,
                   const std::string& where, const DescribeUnknown& unknown)
      : rest_(text), columns_(columns), find_(find), where_(where), unknown_(unknown) {}

  Expression Read() {
    Expression expression;
    do {
      double factor = 1.0;
      while (rest_.starts_with('-') || rest_.starts_with('+')) {
        if (rest_.front() == '-') factor = -factor;
        Take(1);
      }
      std::optional<std::size_t> column;
      for (bool divides = false;; Take(1)) {
        if (const auto found = TakeColumn()) {
          if (column || divides) Throw("multiplies columns: it must be a sum of them");
          column = found;
        } else {
          const double number = TakeNumber();
          factor = divides ? factor / number : factor * number;
          expression.is_scaled = true;
        }
        if (!rest_.starts_with('*') && !rest_.starts_with('/')) break;
        divides = rest_.front() == '/';
      }
      if (!std::isfinite(factor) || (column && factor == 0)) {
        Throw("has a factor that is 0 or infinite");
      }
      if (column) {
        expression.terms.push_back({*column, factor});
      } else {
        expression.offset += factor;
      }
    } while (!rest_.empty());
    if (expression.terms.empty()) {
      Throw("names no column: write it like raw*0.0123-4.5 [N], or #3 for the third column");
    }
    return expression;
  }

 private:
  [[noreturn]] void Throw(std::string_view rule) const {
    throw InputError(fmt::format("{}: {}", where_, rule));
  }
  void Take(std::size_t size) { rest_ = Trimmed(rest_.substr(size)); }

  /// Takes the longest name before an operator or the end, or # and a number.
  std::optional<std::size_t> TakeColumn() {
    for (std::size_t end = rest_.size(); end != std::string_view::npos && end > 0;
         end = rest_.find_last_of(kOperators, end - 1)) {
      const std::string_view name = Trimmed(rest_.substr(0, end));
      if (const auto column = name.empty() ? std::nullopt : find_(name)) {
        Take(end);
        return column;
      }
    }
    if (!rest_.starts_with('#')) return std::nullopt;
    Take(1);
    const double number = TakeNumber();
    if (number < 1 || number > static_cast<double>(columns_) || number != std::floor(number)) {
      Throw(fmt::format("has #{}: there are {} columns", number, columns_));
    }
    return static_cast<std::size_t>(number) - 1;
  }

  double TakeNumber() {
    double value = 0.0;
    const auto [stop, error] = FromChars(rest_.data(), rest_.data() + rest_.size(), value);
    const auto size = static_cast<std::size_t>(stop - rest_.data());
    const std::string_view after = Trimmed(rest_.substr(size));
    const bool ends = after.empty() || kOperators.find(after.front()) != std::string_view::npos;
    if (error != std::errc() || size == 0 || !std::isfinite(value) || !ends) {
      const std::string_view name = Trimmed(rest_.substr(0, rest_.find_first_of(kOperators)));
      Throw(name.empty() ? "is incomplete: write it like raw*0.0123-4.5 [N]" : unknown_(name));
    }
    Take(size);
    return value;
  }

  std::string_view rest_;
  std::size_t columns_;
  const FindColumn& find_;
  const std::string& where_;
  const DescribeUnknown& unknown_;
};

}  // namespace

Expression ReadExpression(std::string_view text, std::size_t columns, const FindColumn& find,
                          const std::string& where, const DescribeUnknown& unknown) {
  text = Trimmed(text);
  if (text.empty()) return {};
  if (!NumberIn<std::size_t>(text)) {
    if (const auto named = find(text)) return {.terms = {{*named, 1.0}}, .unit = ""};
  }
  std::string unit;
  if (const std::size_t open = text.rfind('['); text.ends_with(']') && open != text.npos) {
    unit = Trimmed(text.substr(open + 1, text.size() - open - 2));
    text = Trimmed(text.substr(0, open));
  }
  Expression expression;
  if (const auto number = NumberIn<std::size_t>(text)) {
    if (*number < 1 || *number > columns) {
      throw InputError(fmt::format("{}: there is no column {}: the file has {} column{}", where,
                                   text, columns, columns == 1 ? "" : "s"));
    }
    expression.terms = {{*number - 1, 1.0}};
  } else if (!text.empty()) {
    expression = ExpressionReader(text, columns, find, where, unknown).Read();
  }
  expression.unit = std::move(unit);
  return expression;
}

}  // namespace mindahl::io
