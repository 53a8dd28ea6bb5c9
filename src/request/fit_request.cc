#include "mindahl/request/fit_request.h"

#include <algorithm>

#include "core/refuse.h"
#include "mindahl/identification/terms.h"

namespace mindahl::request {

using identification::FitOptions;
using identification::Term;

namespace {

/// Fits the terms of a group that are not given.
void AddGroup(const identification::TermGroup& group, FitOptions& fit) {
  for (const std::string_view name : group.terms) {
    const std::string term(name);
    if (fit.fixed.contains(term) || std::ranges::count(fit.terms, term) > 0) continue;
    fit.terms.push_back(term);
  }
}

/// Returns the group that has a term; nullptr where there is none.
const identification::TermGroup* GroupOf(const Term& term) {
  for (const identification::TermGroup& group : identification::TermGroups()) {
    if (std::ranges::count(group.terms, term.name) > 0) return &group;
  }
  return nullptr;
}

/// A start, a bound or a prior of what the fit does not move would be taken without a word.
void RequireFitted(std::string_view option, const std::string& name, const FitOptions& fit) {
  const Term* term = identification::FindTerm(identification::TermNameOf(name));
  if (term == nullptr) return;  // the fit knows all names
  const bool is_added =
      GroupOf(*term) == nullptr || term->of_column || std::ranges::count(fit.terms, term->name) > 0;
  const bool is_prescribed = name == "alpha" && fit.model->shape_exponent;
  if (is_added && !is_prescribed && !fit.fixed.contains(name)) return;
  Refuse("{}: {} is not fitted, so this has no effect: leave it out, or add --terms NAME", option,
         name);
}

}  // namespace

FitOptions MakeFitOptions(const FitRequest& request) {
  FitOptions fit = request.fit;
  if (fit.model == nullptr) fit.model = FitOptions().model;
  const bool is_of_force = fit.response() == loop::Channel::kForce;
  if (!is_of_force && (request.chooses_terms || request.compare)) {
    Refuse(
        "{} cannot be combined with --noise-in displacement: it needs a fit of the "
        "force; leave one of the two out",
        request.compare ? "--compare" : "--terms auto");
  }
  for (const contact::UncertainValue& load : request.contact.normal_loads) {
    fit.normal_loads.push_back(load.value);
  }
  for (const std::string& name : request.terms) {
    if (!is_of_force) {
      fit.terms.push_back(name);
    } else if (const auto* group = identification::FindTermGroup(name)) {
      AddGroup(*group, fit);
    } else {
      fit.covariates.push_back(name);
    }
  }
  // A term that is held at a value has no meaning without others, as a ripple without its factors.
  for (const auto& [name, value] : fit.fixed) {
    const Term* term = identification::FindTerm(name);
    if (term == nullptr || (term->needs.empty() && term->shapes.empty())) continue;
    if (const auto* group = GroupOf(*term)) AddGroup(*group, fit);
  }
  Validate(fit);
  for (const auto& [name, value] : request.fit.priors) RequireFitted("--prior", name, fit);
  for (const auto& [name, value] : fit.start) RequireFitted("--start", name, fit);
  for (const auto& [name, interval] : fit.bounds) {
    if (!request.chooses_terms) RequireFitted("--bound", name, fit);  // else it may come to be
  }
  return fit;
}

FitOptions MakeCycleFitOptions(const FitRequest& request) {
  FitOptions fit = MakeFitOptions(request);
  const std::string column = fit.covariates.empty() ? "" : fit.covariates.front();
  // A cycle of gross slip does not distinguish an asymmetry from an offset of the force.
  for (const auto& [is_given, option] :
       {std::pair(request.compare, std::string("--compare")),
        {!request.fit.covariates.empty(), "--covariate"},
        {!column.empty(), fmt::format("--terms: '{}' is no term: that of a column", column)},
        {request.fit.response() == loop::Channel::kDisplacement, "--noise-in displacement"},
        {std::ranges::count(fit.terms, "asymmetry") > 0, "--terms asymmetry"}}) {
    if (!is_given) continue;
    Refuse("{} is not available in track: fit a part of the record with fit --select cycles=LO:HI",
           option);
  }
  return fit;
}

}  // namespace mindahl::request
