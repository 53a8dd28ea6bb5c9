#include "mindahl/methods/operations.h"

#include <array>

namespace mindahl::methods {

std::string_view NameOf(Operation operation) {
  constexpr std::array<std::string_view, kOperations> kNames = {
      "sample",    "place",      "reversal",   "linear",      "root",     "power",
      "narrowing", "element",    "sum",        "look_up",     "step",     "stage",
      "trial",     "cubic_root", "rate_power", "exponential", "iteration"};
  return kNames[static_cast<std::size_t>(operation)];
}

OperationCount CountOperations(const Method& method, const models::FrictionModel& model,
                               const models::BranchLaw& law, const Resolution& resolution,
                               const Drive& drive) {
  OperationCount count;
  // Prepare() checks the arguments.
  const Evaluator evaluate = Prepare(method, model, law, resolution);
  method.count(model, law, resolution, drive, count);
  count.Add(Operation::kSample, static_cast<double>(drive.displacement.size()));
  return count;
}

}  // namespace mindahl::methods
