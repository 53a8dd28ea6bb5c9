#pragma once

#include <string>
#include <utility>
#include <vector>

#include "mindahl/report/report.h"
#include "report/field.h"
#include "report/fields.h"

namespace mindahl::report {

/// Every row of the report, and of the items that it lists.
struct FieldTable {
  std::vector<Field<Report>> rows;
  std::vector<FieldDescription> items;  ///< fields of the items that the rows list

  void Add(std::vector<Field<Report>> more) {
    for (Field<Report>& row : more) rows.push_back(std::move(row));
  }
  template <typename Item>
  void Describe(const std::string& prefix, const std::vector<Field<Item>>& fields) {
    for (const Field<Item>& field : fields) {
      items.push_back({prefix + field.path, field.unit, field.label});
    }
  }
};

// Each adds the rows of its subject, in the order of the JSON.
void AddAdequacyFields(FieldTable& table);
void AddMeasuredFields(FieldTable& table);
void AddParameterFields(FieldTable& table);
void AddSlipForceFields(FieldTable& table);
void AddResidualFields(FieldTable& table);
void AddSelectionFields(FieldTable& table);
void AddSolverFields(FieldTable& table);
void AddLawFields(FieldTable& table);
void AddMemoryFields(FieldTable& table);
void AddLoopFields(FieldTable& table);
void AddContactFields(FieldTable& table);
void AddMappingFields(FieldTable& table);
void AddLoadSeriesFields(FieldTable& table);
void AddBackboneFields(FieldTable& table);

/// Why there is no contact behind a torque.
inline constexpr const char* kWhyNoContact =
    "of a torque against an angle: Hertz, Mindlin and the mapping are of a force along the contact";

/// Why a load series has no ρ and no p₀.
inline constexpr const char* kWhyNoSphere =
    "of Hertz's law, σ ∝ N^(1/3), which the load series denies";

/// Returns why nothing of a fit that failed is there.
std::string WhyFailed(const Report& report);

}  // namespace mindahl::report
