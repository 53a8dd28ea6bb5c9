#include <memory>
#include <string>
#include <vector>

#include "cli/app.h"
#include "cli/contact_options.h"
#include "cli/options.h"
#include "cli/output.h"
#include "mindahl/core/version.h"
#include "mindahl/request/contact_request.h"
#include "report/table.h"

namespace mindahl::cli {

using report::Json;
using report::NumberOrNull;

namespace {

struct ContactCommandOptions {
  ContactOptions contact;
  std::string json_path;
};

struct ContactAnswer : request::ContactParameters {};

/// Returns the quantities of a section: as rows of the text, with what they are.
Json SectionOf(const ContactAnswer& contact, std::string_view section) {
  Json rows = Json::object();
  for (const request::ContactQuantity& quantity : contact.quantities) {
    if (quantity.section != section) continue;
    rows[quantity.name] = {{"value", NumberOrNull(quantity.value.value)},
                           {"standard_error", NumberOrNull(quantity.value.standard_error)},
                           {"unit", quantity.unit},
                           {"meaning", quantity.meaning}};
  }
  return rows;
}

// G* is said wherever it is used: many texts write it for the inverse.
std::string ToJson(const ContactAnswer& contact) {
  return report::Dump({{"schema", "mindahl.contact/1"},
                       {"version", Version()},
                       {"compliance_definition", "G* = (2-nu1)/G1 + (2-nu2)/G2"},
                       {"compliance_unit", "1/Pa"},
                       {"contact", SectionOf(contact, "contact")},
                       {"parameters", SectionOf(contact, "parameters")}});
}

std::string ToText(const ContactAnswer& contact) {
  Json rows = SectionOf(contact, "contact");
  rows.update(SectionOf(contact, "parameters"));
  constexpr int kEveryDigit = 17;
  return report::TableText(rows, kEveryDigit);
}

void RunContact(const ContactCommandOptions& options, Console& console) {
  Validate(options.contact);
  RequireOutputPaths({{"--json", options.json_path, /*dash_is_stdout=*/true}}, console);
  const ContactAnswer contact{ResolveContact(options.contact)};
  WarnOfDoubts(options.contact, "contact", console);
  WriteAnswer(options.json_path, console, contact);
}

}  // namespace

void AddContactCommand(CLI::App& app, Console& console) {
  const auto options = std::make_shared<ContactCommandOptions>();
  CLI::App& command = AddCommand(
      app, "contact",
      "Computes sigma = 8a/G*, alpha = 1/3 and Tc = mu N of a contact from\n"
      "materials, radii, load and friction, or from contact radius and\n"
      "compliance, by Hertz and Mindlin.",
      {"mindahl contact --friction 0.3 --normal-load 50±0.5 --radius-1 0.05 --radius-2 inf \\",
       "    --youngs-modulus-1 210e9 --poisson-1 0.3 --youngs-modulus-2 210e9 --poisson-2 0.3",
       "mindahl contact --friction 0.3 --normal-load 50 --contact-radius 2.5e-4 --compliance "
       "4.2e-11"});
  AddContactOptions(command, options->contact);
  AddFrictionOption(command, options->contact);
  OptionGroup(command, kPlainGroup)
      .Add("--json", options->json_path, "result as JSON; - for standard output", "PATH");
  command.callback([options, &console] { RunContact(*options, console); });
}

}  // namespace mindahl::cli
