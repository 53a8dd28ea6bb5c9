#include "io/expression.h"

#include <fmt/format.h>

#include <cmath>
#include <system_error>
#include <utility>

#include "core/from_chars.h"
#include "io/cells.h"
#include "mindahl/core/error.h"

namespace mindahl::io {
namespace {

constexpr std::string_view kOperators = "+-*/";

class ExpressionReader {
 public:
  ExpressionReader(std::string_view text, std::size_t columns, const FindColumn& find,
                   const std::string& where, const DescribeUnknown& unknown)
      : rest_(text), columns_(columns), find_(find), where_(where), unknown_(unknown) {}

  Expression Read() {
    Expression expression;
    double sign = TakeSign();
    for (bool is_first = true;; is_first = false) {
      const Product product = TakeProduct(is_first);
      const double factor = sign * product.factor;
      if (product.column) {
        expression.terms.push_back({*product.column, factor});
        expression.is_scaled = expression.is_scaled || product.is_scaled;
      } else {
        expression.offset += factor;
        expression.is_scaled = true;
      }
      if (rest_.empty()) break;
      sign = rest_.front() == '-' ? -1.0 : 1.0;
      Take(1);
      sign *= TakeSign();
    }
    if (expression.terms.empty()) Throw("names no column: write it like raw*0.0123-4.5 [N]");
    for (const Expression::Term& term : expression.terms) {
      if (!std::isfinite(term.weight) || term.weight == 0)
        Throw("has a factor that is 0 or infinite");
    }
    return expression;
  }

 private:
  struct Product {
    std::optional<std::size_t> column;
    double factor = 1.0;
    bool is_scaled = false;
  };
  struct Number {
    double value;
    bool may_be_column;
    std::string_view text;
  };

  [[noreturn]] void Throw(std::string_view rule) const {
    throw InputError(fmt::format("{}: {}", where_, rule));
  }
  void Take(std::size_t size) {
    rest_.remove_prefix(size);
    rest_ = Trimmed(rest_);
  }
  double TakeSign() {
    if (!rest_.starts_with('-') && !rest_.starts_with('+')) return 1.0;
    const double sign = rest_.front() == '-' ? -1.0 : 1.0;
    Take(1);
    return sign;
  }

  Product TakeProduct(bool is_first) {
    Product product;
    std::optional<Number> first;
    for (bool divides = false;;) {
      if (const auto column = TakeColumn()) {
        if (product.column || divides) Throw("multiplies columns: it must be a sum of them");
        product.column = column;
      } else {
        const Number number = TakeNumber();
        if (!first) first = number;
        product.factor = divides ? product.factor / number.value : product.factor * number.value;
      }
      if (rest_.empty() || (rest_.front() != '*' && rest_.front() != '/')) break;
      divides = rest_.front() == '/';
      Take(1);
    }
    product.is_scaled = first.has_value();
    if (product.column || !first->may_be_column) return product;
    if (is_first) {
      numbered_ = true;
      product.is_scaled = product.factor != first->value;
      product.factor /= first->value;
      product.column = static_cast<std::size_t>(first->value) - 1;
    } else if (numbered_) {
      Throw(fmt::format(
          "has {0}, which may be a column or a number: write #{0} for the column, {0}.0 "
          "for the number",
          first->text));
    }
    return product;
  }

  /// Takes the longest name before an operator or the end, or # and a number.
  std::optional<std::size_t> TakeColumn() {
    if (rest_.starts_with('#')) {
      Take(1);
      const Number number = TakeNumber();
      if (!number.may_be_column)
        Throw(fmt::format("has #{}: there are {} columns", number.text, columns_));
      return static_cast<std::size_t>(number.value) - 1;
    }
    for (std::size_t end = rest_.size(); end != std::string_view::npos && end > 0;
         end = rest_.find_last_of(kOperators, end - 1)) {
      const std::string_view name = Trimmed(rest_.substr(0, end));
      const auto column = name.empty() ? std::nullopt : find_(name);
      if (column) {
        Take(end);
        return column;
      }
      if (end == 0) break;
    }
    return std::nullopt;
  }

  Number TakeNumber() {
    double value = 0.0;
    const auto [stop, error] = FromChars(rest_.data(), rest_.data() + rest_.size(), value);
    const auto size = static_cast<std::size_t>(stop - rest_.data());
    const std::string_view after = Trimmed(rest_.substr(size));
    const bool ends = after.empty() || kOperators.find(after.front()) != std::string_view::npos;
    if (error != std::errc() || size == 0 || !std::isfinite(value) || !ends) {
      const std::string_view name = Trimmed(rest_.substr(0, rest_.find_first_of(kOperators)));
      Throw(name.empty() ? "is incomplete: write it like raw*0.0123-4.5 [N]" : unknown_(name));
    }
    const std::string_view text = rest_.substr(0, size);
    const bool is_whole = text.find_first_not_of("0123456789") == std::string_view::npos;
    Take(size);
    return {value, is_whole && value >= 1 && value <= static_cast<double>(columns_), text};
  }

  std::string_view rest_;
  std::size_t columns_;
  const FindColumn& find_;
  const std::string& where_;
  const DescribeUnknown& unknown_;
  bool numbered_ = false;  // the first column is given by its number
};

}  // namespace

Expression ReadExpression(std::string_view text, std::size_t columns, const FindColumn& find,
                          const std::string& where, const DescribeUnknown& unknown) {
  text = Trimmed(text);
  if (text.empty()) return {};
  const bool is_number = NumberIn<std::size_t>(text).has_value();
  const auto named = is_number ? std::nullopt : find(text);
  if (named) return {.terms = {{*named, 1.0}}, .unit = ""};
  Expression expression;
  std::string unit;
  if (const std::size_t open = text.rfind('['); text.ends_with(']') && open != text.npos) {
    unit = Trimmed(text.substr(open + 1, text.size() - open - 2));
    text = Trimmed(text.substr(0, open));
  }
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
