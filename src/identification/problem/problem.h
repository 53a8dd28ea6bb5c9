#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <map>
#include <span>
#include <vector>

#include "identification/problem/motion.h"
#include "identification/problem/parameters.h"
#include "identification/problem/scaled_records.h"
#include "mindahl/models/friction_model.h"
#include "mindahl/models/loading_path.h"
#include "models/loaded_response.h"
#include "models/normalized_response.h"

namespace mindahl::identification {

/// Holds what is to be solved, which does not change meanwhile.
struct Problem {
  Problem(const ScaledRecords& records, const FitOptions& options, models::InitialState initial)
      : data(&records),
        model(options.model),
        initial_state(initial),
        parameters(records, options, initial) {}

  [[nodiscard]] std::size_t size() const { return data->samples(); }
  [[nodiscard]] bool is_virgin() const { return initial_state == models::InitialState::kVirgin; }
  /// True of Masing's law: its loading path depends on an asymmetry, and its elements on the load.
  /// Dahl's own reads both from its state z, that of a joint (models/joint_friction.h).
  [[nodiscard]] bool is_masing() const { return model->memory == models::Memory::kReturnPoint; }

  const ScaledRecords* data;
  const models::FrictionModel* model;
  models::InitialState initial_state;
  Parameters parameters;
};

/// Returns the log of the factor of t: ln Tc, or ln(Tc/σ) of a displacement.
double LogScaleAt(const Problem& problem, std::span<const double> theta);

/// Derivatives of t, a column each of all samples, by term: an empty one is not wanted. That of σ
/// is by ln(σ/Tc), that of a rig by ln(Tc/k), that of the origin by where the contact is unloaded.
struct ResponseColumns : std::array<std::span<double>, RowOf(TermId::kDisplacementDrift) + 1> {
  [[nodiscard]] std::span<double>& operator[](TermId id) { return data()[RowOf(id)]; }
  [[nodiscard]] std::span<double> operator[](TermId id) const { return data()[RowOf(id)]; }
  /// Returns those of a record's samples.
  [[nodiscard]] ResponseColumns Of(const ScaledRecord& record) const;
};

/// A problem near one point.
struct Linearization {
  Eigen::MatrixXd jacobian;  // weighted
  Eigen::VectorXd residual;  // weighted, model − measured
};

/// t = T/Tc of all samples, one record after the other, Tc that of the mean load: by the branch law
/// where a record is under one load, by the elements' (models/load_zones.h) where it varies. Of
/// a contact whose force is imposed t = σδ/Tc by the branch law's inverse, NaN of a whole record
/// that has a force beyond slip. Keeps the loading paths, which depend on the point only where a
/// contact is unloaded, by its lag, its gap and its asymmetry, and its buffers.
class Response {
 public:
  /// @param problem  must outlive this; it may not change, the weights of its samples may
  explicit Response(const Problem& problem);

  void Evaluate(std::span<const double> theta, std::span<double> t,
                const ResponseColumns& columns = {});
  /// Computes t and the derivatives of scale·t by parameters, without weights; those by linear ones
  /// are 0.
  /// @param t        of all samples
  /// @param columns  a column a parameter; resized
  void Differentiate(std::span<const double> theta, std::span<const std::size_t> parameters,
                     Eigen::VectorXd& t, Eigen::MatrixXd& columns);
  /// Returns the residual of the whole model and its derivatives by parameters.
  Linearization LinearizeAt(std::span<const double> theta, std::span<const std::size_t> parameters);
  /// Returns where the contact of a record is.
  const Motion& MotionOf(std::size_t record, std::span<const double> theta);

 private:
  /// Evaluates one record by its path, over the slip force of the path.
  void EvaluatePath(std::span<const double> theta, std::size_t record, std::span<double> t,
                    const ResponseColumns& columns);
  void EvaluateBehindGap(const models::NormalizedLaw& law, const Motion& motion,
                         std::span<double> t, const models::NormalizedGradient& gradient);
  /// Multiplies t and its derivatives by the slip force at each sample, where it varies, and adds
  /// the drag.
  void ScaleBySlipForce(const ScaledRecord& record, std::span<const double> theta,
                        std::span<double> response, const ResponseColumns& columns) const;
  [[nodiscard]] models::NormalizedGradient GradientOf(const ResponseColumns& columns) const;
  [[nodiscard]] bool Has(TermId id) const { return !problem_.parameters[RowOf(id)].absent; }

  const Problem& problem_;
  std::size_t moves_;                              // of the parameter that moves the contact
  std::vector<std::vector<models::Turn>> turns_;   // of each record's motion
  std::vector<Motion> motions_;                    // of each record
  std::vector<models::LoadedHistory> histories_;   // of records under a load that varies
  std::map<TermId, Eigen::VectorXd> derivatives_;  // of t; a search resizes none
};

/// Computes the response of the whole model at θ, of every sample [units of the data]; no weight.
Eigen::VectorXd Predict(const Problem& problem, std::span<const double> theta);

/// Adds a multiple of the column of a linear parameter, of every sample; no weight.
/// @param derivative  adds the column's derivative by the parameter that shapes it instead
void AddColumn(const Problem& problem, std::size_t parameter, std::span<const double> theta,
               double factor, Eigen::Ref<Eigen::VectorXd> to, bool derivative = false);

/// Adds a multiple of Σ θ_q·column_q of all linear parameters, of every sample; no weight.
void AddLinearTerms(const Problem& problem, std::span<const double> theta, double factor,
                    Eigen::VectorXd& to);

/// Adds ∂(Σ θ_q·column_q)/∂θ by parameters, of every sample, no weight: the own column of a linear
/// one, else those of the columns that it shapes.
/// @param theta    of all parameters, the linear ones included
/// @param columns  one a parameter
void AddDerivativesOfColumns(const Problem& problem, std::span<const std::size_t> parameters,
                             std::span<const double> theta, Eigen::MatrixXd& columns);

}  // namespace mindahl::identification
