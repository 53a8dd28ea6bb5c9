
#include "cli/command.h"
#include "mindahl/identification/terms.h"
#include "mindahl/models/friction_model.h"

namespace mindahl::cli {

using contact::UncertainValue;
using identification::Interval;
using identification::Term;

namespace {

constexpr const char* kColumnGroup = "Columns and units";

/// Returns what was read of a text, or refuses it and says how to write it.
template <typename Value>
Value Read(const std::optional<Value>& value, std::string_view option, std::string_view text,
           std::string_view form) {
  if (value) return *value;
  Refuse("{}: '{}' is invalid: write {}", option, text, form);
}

/// Returns what is on the left and on the right of a separator; nothing right where there is none.
std::pair<std::string_view, std::string_view> Split(std::string_view text, char separator) {
  const std::size_t at = std::min(text.find(separator), text.size());
  return {text.substr(0, at), text.substr(std::min(at + 1, text.size()))};
}

std::optional<Interval> ParseInterval(std::string_view text, std::string_view unit) {
  const auto [low, high] = Split(text, ':');
  const std::optional<double> lower = ParseQuantity(low, unit);
  const std::optional<double> upper = ParseQuantity(high, unit);
  if (!lower || !upper || !(*lower < *upper)) return std::nullopt;
  return Interval{*lower, *upper};
}

std::optional<loop::CountRange> ParseCountRange(std::string_view text) {
  const auto [from, to] = Split(text, ':');
  const auto first = NumberIn<std::size_t>(from);
  const auto last = NumberIn<std::size_t>(to);
  if (!first || !last || *first < 1) return std::nullopt;
  return loop::CountRange{.first = *first, .last = *last};
}

/// Gives a parameter a value, unless it has one.
template <typename Values, typename Value>
void GiveOnce(std::string_view option, std::string_view name, const Value& value, Values& values) {
  if (values.emplace(name, value).second) return;
  Refuse("{}: '{}' is given twice: give it once", option, name);
}

/// Reads COL, COL=fit or COL=C.
void ReadCovariate(const std::string& text, identification::FitOptions& fit) {
  const std::size_t at = std::min(text.rfind('='), text.size());
  fit.covariates.push_back(text.substr(0, at));
  if (at == text.size() || text.substr(at) == "=fit") return;
  GiveOnce("--covariate", identification::NameOfCovariate(fit.covariates.back()),
           Read(ParseQuantity(text.substr(at + 1), "-"), "--covariate", text,
                "COL[=C|fit], e.g. pressure=50"),
           fit.fixed);
}

/// Reads fit, a number, or a number with its standard uncertainty.
void ReadRig(const std::string& text, identification::FitOptions& fit) {
  constexpr const char* kRig = "rig_stiffness";
  if (text == "fit") {
    fit.terms.emplace_back(kRig);
    return;
  }
  const UncertainValue stated = ParseUncertainValue(text, "--rig-stiffness", "N/m");
  RequirePositive("--rig-stiffness [N/m]", stated.value);
  if (stated.standard_error == 0) return GiveOnce("--rig-stiffness", kRig, stated.value, fit.fixed);
  fit.terms.emplace_back(kRig);
  fit.priors[kRig] = {stated.value, stated.standard_error};
}

/// Reads "cycles=2:9" and the like, of `--select`.
void ReadSelection(std::string_view text, std::string_view option, FitRequest& request) {
  const auto [what, range] = Split(text, '=');
  constexpr std::string_view kForm =
      "cycles=LO:HI or samples=LO:HI, counted from 1, time=LO:HI [s] or load=LO:HI [N]";
  loop::PreparationOptions& preparation = request.fit.preparation;
  if (what == "time") {
    request.time_window = Read(ParseInterval(range, "s"), option, text, kForm);
  } else if (what == "load") {
    preparation.load_window = Read(ParseInterval(range, "N"), option, text, kForm);
  } else {
    const bool is_of_cycles = what == "cycles";
    const auto counts = is_of_cycles || what == "samples" ? ParseCountRange(range) : std::nullopt;
    (is_of_cycles ? preparation.cycles : preparation.samples) = Read(counts, option, text, kForm);
  }
}

std::string DescribeTerms(bool of_cycles) {
  std::string text =
      "terms that are fitted in addition to the law; auto: those that the\nrecord requires";
  text += of_cycles ? "; or" : ". A column's name, or";
  for (const identification::TermGroup& group : identification::TermGroups()) {
    if (of_cycles && group.name == "asymmetry") continue;
    text += fmt::format("\n{}: {}", group.name, group.meaning);
  }
  return text + "\ndefault none";
}

/// Refuses a name that no parameter of any fit has.
void RequireParameter(std::string_view option, std::string_view name) {
  if (name.empty() || identification::TermOfParameter(name) != nullptr) return;
  std::vector<std::string_view> names;
  for (const Term& term : identification::Terms()) {
    if (!term.of_column) names.push_back(term.name);
  }
  Refuse("{}: parameter {}", option, UnknownAmong(name, names));
}

std::string DescribeParameters() {
  std::vector<std::string> words;
  for (const Term& term : identification::Terms()) {  // --covariate takes a column's value
    if (!term.of_column) words.push_back(fmt::format("{} [{}]", term.name, term.unit));
  }
  constexpr std::size_t kWidth = 69;  // of a help text
  return fmt::format(
      "hold a parameter at a value in its unit, and add its term:\n{}\n"
      "offsets and drifts of several files are numbered, force_offset_2",
      fmt::join(LinesOf({words.begin(), words.end()}, kWidth), "\n"));
}

}  // namespace

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

UncertainValue ParseUncertainValue(std::string_view text, std::string_view option,
                                   std::string_view unit) {
  std::string stated(text);
  std::string_view magnitude = "0";
  for (const std::string_view separator : {"±", "+/-", "+-"}) {
    const std::size_t at = text.find(separator);
    if (at == std::string_view::npos) continue;
    stated = text.substr(0, at);
    magnitude = Trimmed(text.substr(at + separator.size()));
    break;
  }
  const bool is_percentage = magnitude.ends_with('%');
  if (is_percentage) magnitude.remove_suffix(1);
  // A unit at the end is that of the value too.
  if (Trimmed(std::string_view(stated).substr(BeginOfUnit(stated))).empty()) {
    stated += magnitude.substr(BeginOfUnit(magnitude));
  }
  const std::optional<double> value = ParseQuantity(stated, unit);
  std::optional<double> standard_error = ParseQuantity(magnitude, is_percentage ? "-" : unit);
  if (value && standard_error && is_percentage) *standard_error *= 0.01 * std::abs(*value);
  if (value && standard_error && std::isfinite(*standard_error) && *standard_error >= 0) {
    return {*value, *standard_error};
  }
  Refuse(
      "{}: '{}' is not a number{}, nor one with its standard uncertainty: write 50, 50±0.5, "
      "50+-0.5, 50+/-0.5 or 50±1%",
      option, text, unit == "-" ? "" : fmt::format(" or a quantity in {}", unit));
}

void AddContactOptions(CLI::App& command, ContactOptions& options, bool has_friction) {
  const auto read = [&options](const std::string& text) {
    std::vector<UncertainValue> each;
    for (const std::string_view load : PartsOf(text, ',')) {
      each.push_back(ParseUncertainValue(load, "--normal-load", "N"));
    }
    SetNormalLoads(options, each);
  };
  const OptionGroup group(command, "What is known of the contact");
  group.AddRead("--normal-load", read,
                "normal load N [N]; in fit one for all files or one a file: 25,50,100;\nlike all "
                "below exact, or with a standard uncertainty: 50±0.5, 50+-0.5,\n50+/-0.5, 50±1%",
                "N[+-U],...");
  const auto add = [&group](const std::string& name, std::optional<UncertainValue>& target,
                            const std::string& help, const std::string& unit,
                            const std::string& type) {
    const auto read_known = [&target, name, unit](const std::string& text) {
      target = ParseUncertainValue(text, name, unit);
    };
    group.AddRead(name, read_known, help, type + "[+-U]");
  };
  for (const auto& [body, number] :
       {std::pair(&options.known.body_1, 1), {&options.known.body_2, 2}}) {
    add(fmt::format("--youngs-modulus-{}", number), body->youngs_modulus,
        fmt::format("Young's modulus of body {} [Pa]", number), "Pa", "PA");
    add(fmt::format("--poisson-{}", number), body->poisson_ratio,
        fmt::format("Poisson's ratio of body {} [-], in (-1, 0.5]", number), "-", "NU");
    add(fmt::format("--radius-{}", number), body->radius,
        fmt::format("radius of body {} [m]; inf is a plane, negative a concave seat", number), "m",
        "M");
  }
  add("--contact-radius", options.known.contact_radius, "contact radius a [m]", "m", "M");
  add("--compliance", options.known.tangential_compliance,
      "G* = (2-nu1)/G1 + (2-nu2)/G2 [1/Pa], a compliance", "1/Pa", "1/PA");
  if (!has_friction) return;
  add("--friction", options.known.friction_coefficient, "friction coefficient mu [-]", "-", "MU");
}

void AddLawParameters(const OptionGroup& group, LawRequest& law) {
  group.AddQuantity("--sigma", law.sigma, "tangential stiffness sigma [N/m]", "N/M", "N/m");
  group.Add("--alpha", law.alpha, "shape exponent [-], default 1/3 where the model leaves it free",
            "ALPHA");
  group.AddQuantity("--slip-force", law.slip_force, "slip force Tc [N]", "N", "N");
}

double SlipReach(const models::BranchLaw& law, const models::SeriesSpring& rig) {
  return std::min(models::GrossSlipDisplacement(law),
                  3 * law.slip_force / law.tangential_stiffness) +
         law.slip_force / rig.stiffness;
}

void AddColumnOptions(CLI::App& command, io::RecordColumns& columns) {
  const OptionGroup group(command, kColumnGroup);
  group.Add("--displacement", columns.displacement,
            "displacement column: header name or number from 1, with its unit if\nthe header has "
            "none, \"3 [mm]\"; or a sum of columns with factors and an\noffset, "
            "\"raw*0.0123-4.5 [mm]\"; found by default; mm, um, in, deg …",
            "COL");
  group.Add("--force", columns.force,
            "force column, likewise: \"cell1+cell2\"; N, mN, uN, kN, lbf, kgf, N m", "COL");
  group.Add("--time", columns.time, "time column, likewise; optional", "COL");
  group.Add("--normal-load-column", columns.normal_load,
            "normal load column, likewise; none: leave it out", "COL");
  group.Add("--sample-rate", columns.sample_rate, "samples a second [Hz], where there is no time",
            "HZ");
  group.Add("--encoding", columns.encoding,
            "encoding of the files, as iconv names it [latin1]; default found", "NAME");
}

void AddModelOptions(CLI::App& command, FitRequest& options, bool of_cycles) {
  const OptionGroup group(command, "Model");
  identification::FitOptions& fit = options.fit;
  std::vector<std::pair<std::string, const models::FrictionModel*>> models = {{"auto", nullptr}};
  std::string titles = "law of the friction; auto: mindlin-dahl";
  if (!of_cycles) titles += " or dahl, by the record";
  for (const models::FrictionModel& model : models::FrictionModels()) {
    models.emplace_back(model.name, &model);
    titles += fmt::format("\n{}: {}", model.name, model.title);
  }
  group.AddChoice("--model", fit.model, std::move(models), titles);
  group.AddFlag("--compare", options.compare,
                "list all models, with and without a rig, by AICc and held-out cycles");
  group.AddChoice("--initial-state", fit.initial_state,
                  {{"auto", {}},
                   {"virgin", models::InitialState::kVirgin},
                   {"steady", models::InitialState::kSteady}},
                  "virgin: the record starts from an unloaded contact; steady: from a\ncycled one");
  group.AddChoice("--force-sign", fit.preparation.force_sense,
                  {{"auto", {}}, {"same", 1}, {"opposite", -1}},
                  "sign of the force in the file; auto: by that of the loop's energy");
  group.AddChoice(
      "--noise-in", fit.preparation.excitation,
      {{"force", loop::Channel::kDisplacement}, {"displacement", loop::Channel::kForce}},
      "channel that has the noise and is fitted; the other one is exact");
  group.AddChoice("--offsets", fit.offsets, {{"on", true}, {"off", false}},
                  "fit offsets of force and displacement");
  group.AddRead(
      "--rig-stiffness", [&fit](const std::string& text) { ReadRig(text, fit); },
      "stiffness of the rig in series [N/m]; K+-U or K+-3% fits it about K", "K[+-U]|fit");
  group.AddEach(
      "--covariate", [&fit](const std::string& text) { ReadCovariate(text, fit); },
      "additional force C·column, C [N/unit], by default fitted; repeatable", "COL[=C|fit]");
  group
      .AddRead<std::vector<std::string>>(
          "--terms",
          [&options](const std::vector<std::string>& names) {
            for (const std::string& name : names) {
              if (names.size() > 1 && (name == "auto" || name == "none")) {
                Refuse("--terms: {} stands alone: leave it or the others out", name);
              }
            }
            options.chooses_terms = names == std::vector<std::string>{"auto"};
            if (!options.chooses_terms && names != std::vector<std::string>{"none"}) {
              options.terms = names;
            }
          },
          DescribeTerms(of_cycles), "none|auto|NAME,...")
      ->delimiter(',')
      ->allow_extra_args(false);
  // parse(text, unit) returns the value that a parameter is given, or nothing.
  const auto add_assignments = [&](const char* option, auto& target, const char* type,
                                   const char* form, auto parse, const std::string& help) {
    group.AddEach(
        option,
        [&target, option, form, parse](const std::string& text) {
          const auto [name, value] = Split(text, '=');
          const Term* term = identification::FindTerm(identification::TermNameOf(name));
          RequireParameter(option, name);
          auto parsed = parse(value, term == nullptr ? "-" : term->unit);
          if (name.empty()) parsed.reset();
          GiveOnce(option, name, Read(std::move(parsed), option, text, form), target);
        },
        help, type);
  };
  const auto to_prior = [](std::string_view text, std::string_view unit) {
    const UncertainValue prior = ParseUncertainValue(text, "--prior", unit);
    using identification::Prior;
    return prior.standard_error > 0 ? std::optional(Prior{prior.value, prior.standard_error})
                                    : std::nullopt;
  };
  constexpr const char* kValue = "NAME=VALUE, e.g. alpha=0.3333";
  add_assignments("--fix", fit.fixed, "NAME=VALUE", kValue, &ParseQuantity, DescribeParameters());
  add_assignments("--start", fit.start, "NAME=VALUE", kValue, &ParseQuantity,
                  "start the search from a value instead of the data's");
  add_assignments("--bound", fit.bounds, "NAME=LO:HI", "NAME=LO:HI, e.g. alpha=0:2", &ParseInterval,
                  "keep a parameter between two values");
  add_assignments("--prior", fit.priors, "NAME=V+-U", "NAME=VALUE±U, e.g. sigma=4e7±5%", to_prior,
                  "prior value and standard uncertainty of a parameter, in its unit [SI]");
  group.AddShown("--confidence", fit.confidence, "confidence of every interval [-]", "C");
  group.AddQuantity("--force-noise", fit.force_noise,
                    "known standard deviation of the force [N]; default from the residuals", "N",
                    "N");
  group.AddQuantity("--displacement-noise", fit.preparation.displacement_noise,
                    "known standard deviation of the displacement [m]; default its own", "M", "m");
  group.AddChoice("--loss", fit.loss,
                  {{"none", identification::Loss::kNone},
                   {"huber", identification::Loss::kHuber},
                   {"cauchy", identification::Loss::kCauchy},
                   {"tukey", identification::Loss::kTukey}},
                  "weight of residuals that are large against their scatter");
  group.AddQuantity("--reversal-gate", fit.preparation.reversal_gate,
                    "excursions up to this [m] are noise, not reversals; default from the\ndata",
                    "M", "m");
}

void AddFitOptions(CLI::App& command, FitRequest& request) {
  AddColumnOptions(command, request.columns);
  const OptionGroup group(command, kColumnGroup);
  group.AddEach(
      "--select", [&request](const std::string& text) { ReadSelection(text, "--select", request); },
      "fit only cycles=LO:HI or samples=LO:HI, counted from 1, time=LO:HI [s]\nor load=LO:HI "
      "[N]; repeatable; what is left out, but by time, still\ncounts as loading history",
      "WHAT=LO:HI");
  // Older names.
  for (const auto& [option, what] : {std::pair("--cycles", "cycles="),
                                     {"--samples", "samples="},
                                     {"--time-window", "time="},
                                     {"--load-window", "load="}}) {
    const auto read = [&request, option, what](const std::string& range) {
      ReadSelection(what + range, option, request);
    };
    OptionGroup(command, "").AddRead(option, read, "", "LO:HI");
  }
  group.AddChoice("--trim", request.trim, {{"on", true}, {"off", false}},
                  "leave out what at the ends of a record is not the test, and say which\nrows");
  io::RecordColumns& columns = request.columns;
  group.Add("--with", columns.with,
            "another file of the same test, whose columns follow those of the file", "FILE");
  group.AddChoice("--broken-rows", columns.skip_broken_rows, {{"refuse", false}, {"skip", true}},
                  "rows without a number in a needed column; skip leaves all out");
  AddModelOptions(command, request);
  AddContactOptions(command, request.contact);
}

void AddStrict(CLI::App& command, Strictness& strictness, const std::string& otherwise) {
  const auto read = [&strictness](const std::string& given) {
    strictness = given == "doubtful" ? Strictness::kDoubtful
                 : given == "false"  ? Strictness::kNone
                                     : Strictness::kAdequate;  // strict = true of a configuration
  };
  const std::string help = otherwise +
                           " unless the model is adequate and every free\n"
                           "parameter identifiable; --strict=doubtful accepts a doubtful\n"
                           "model and parameters that are effective";
  command.add_flag("--strict{adequate}", help)
      ->each(read)
      ->group("Results")
      ->check(CLI::IsMember({"adequate", "doubtful", "true", "false"}).description(""));
}

}  // namespace mindahl::cli
