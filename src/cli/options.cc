#include "cli/command.h"

namespace mindahl::cli {

void ShowFirst(CLI::App& command, std::vector<std::string> names) {
  const auto show = [names = std::move(names)](const CLI::App* app, const std::string& name,
                                               CLI::AppFormatMode mode) {
    const CLI::Formatter all;
    if (mode == CLI::AppFormatMode::All) return all.make_help(app, name, mode);
    std::vector<const CLI::Option*> shown;
    shown.reserve(names.size());
    for (const std::string& each : names) shown.push_back(app->get_option(each));
    return all.make_description(app) + all.make_usage(app, name) + all.make_positionals(app) +
           all.make_group("Options", /*is_positional=*/false, std::move(shown)) + '\n' +
           all.make_footer(app);
  };
  command.formatter_fn(show);
}

CLI::Option* AddPath(const OptionGroup& group, std::string& path, std::string& column) {
  CLI::Option* const added =
      group.Add("--path", path, "CSV file with a displacement, any sequence", "FILE");
  group
      .Add("--displacement", column,
           "its column, by header name or number, with its unit, \"[um]\", if the\nheader has "
           "none; default by its name, else the first",
           "COL")
      ->needs(added);
  return added;
}

void AddThreads(const OptionGroup& group, std::size_t& threads, const std::string& unchanged) {
  group
      .Add("--threads", threads,
           "number of worker threads (default: one per core); they do not change\n" + unchanged)
      ->check(CLI::Range(1, 1024).description(""));
}

}  // namespace mindahl::cli
