#include "cli/command.h"

namespace mindahl::cli {

namespace {

/// Adds a quantity that there is, with what it is for the text.
void Add(Json& rows, const char* name, const std::optional<contact::UncertainValue>& value,
         const char* unit, const char* meaning) {
  if (!value) return;
  rows[name] = {{"value", NumberOrNull(value->value)},
                {"standard_error", NumberOrNull(value->standard_error)},
                {"unit", unit},
                {"meaning", meaning}};
}

void RunContact(const ContactOptions& given, Console& console) {
  Validate(given);
  const contact::PredictedContact made = contact::PredictContact(given.known);
  Json quantities = Json::object();
  Add(quantities, "friction_coefficient", given.known.friction_coefficient, "-", "mu");
  Add(quantities, "normal_load", given.known.normal_load, "N", "N");
  Add(quantities, "effective_modulus", made.effective_modulus, "Pa", "E*");
  Add(quantities, "equivalent_radius", made.equivalent_radius, "m", "rho");
  Add(quantities, "compliance", made.tangential_compliance, "1/Pa",
      "G* = (2-nu1)/G1 + (2-nu2)/G2, a compliance");
  Add(quantities, "contact_radius", made.contact_radius, "m", "a");
  Add(quantities, "maximum_pressure", made.maximum_pressure, "Pa", "p0 = 3N/(2 pi a^2)");
  Add(quantities, "gross_slip_displacement", made.gross_slip_displacement, "m",
      "delta_c = 3 mu N G*/(16 a)");
  Json parameters = Json::object();
  Add(parameters, "sigma", made.tangential_stiffness, "N/m", "8a/G*");
  Add(parameters, "alpha", contact::kMindlinShapeExponent, "-", "1/3, Mindlin");
  Add(parameters, "slip_force", made.slip_force, "N", "Tc = mu N");
  Say("contact: warning", contact::DoubtsAbout(given.known), console);
  Json rows = quantities;
  rows.update(parameters);
  // G* is said wherever it is used: many texts write it for the inverse.
  WriteAnswer(console,
              report::Document("mindahl.contact/1",
                               {{"compliance_definition", "G* = (2-nu1)/G1 + (2-nu2)/G2"},
                                {"compliance_unit", "1/Pa"},
                                {"contact", std::move(quantities)},
                                {"parameters", std::move(parameters)}}),
              report::TableText(rows, /*digits=*/17));
}

}  // namespace

void AddContactCommand(CLI::App& app, Console& console) {
  const auto [command, options] = AddCommand(
      app, console, "contact",
      "Computes sigma = 8a/G*, alpha = 1/3 and Tc = mu N of a contact from\n"
      "materials, radii, load and friction, or from contact radius and\n"
      "compliance, by Hertz and Mindlin.",
      {"mindahl contact --friction 0.3 --normal-load 50±0.5 --radius-1 0.05 --radius-2 inf \\",
       "    --youngs-modulus-1 210e9 --poisson-1 0.3 --youngs-modulus-2 210e9 --poisson-2 0.3",
       "mindahl contact --friction 0.3 --normal-load 50 --contact-radius 2.5e-4 --compliance "
       "4.2e-11"},
      &RunContact);
  AddContactOptions(command, options, /*has_friction=*/true);
  OptionGroup(command, kPlainGroup).AddJson(console);
}

}  // namespace mindahl::cli
