#include "cli/toml.h"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <string>

#include "mindahl/core/error.h"

namespace mindahl::cli {
namespace {

[[noreturn]] void FailAt(std::string_view file, const toml::source_region& place,
                         std::string_view what) {
  throw InputError(fmt::format("{}:{}: {}", file, place.begin.line, what));
}

std::string ValueOf(const toml::node& node, std::string_view file) {
  if (const auto* text = node.as_string()) return text->get();
  if (const auto* number = node.as_integer()) return fmt::format("{}", number->get());
  if (const auto* number = node.as_floating_point()) return fmt::format("{}", number->get());
  if (const auto* flag = node.as_boolean()) return flag->get() ? "true" : "false";
  FailAt(file, node.source(), "the value is no string, number or boolean, nor an array of such");
}

void AddItems(const toml::table& table, const std::string& section, std::string_view file,
              std::vector<TomlItem>& items) {
  for (const auto& [key, node] : table) {
    const std::string name(key.str());
    if (const toml::table* inner = node.as_table()) {
      AddItems(*inner, section.empty() ? name : fmt::format("{}.{}", section, name), file, items);
      continue;
    }
    TomlItem& item = items.emplace_back();
    item.section = section;
    item.key = name;
    item.line = key.source().begin.line;
    if (const toml::array* array = node.as_array()) {
      for (const toml::node& value : *array) item.values.push_back(ValueOf(value, file));
    } else {
      item.values.push_back(ValueOf(node, file));
    }
  }
}

}  // namespace

std::vector<TomlItem> ReadToml(std::string_view text, std::string_view file) {
  std::vector<TomlItem> items;
  try {
    AddItems(toml::parse(text), "", file, items);
  } catch (const toml::parse_error& error) {
    FailAt(file, error.source(), error.description());
  }
  std::ranges::stable_sort(items, {}, &TomlItem::line);
  return items;
}

}  // namespace mindahl::cli
