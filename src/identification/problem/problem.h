#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "identification/problem/moved_samples.h"
#include "identification/problem/parameters.h"
#include "identification/problem/scaled_records.h"
#include "mindahl/models/friction_model.h"
#include "mindahl/models/loading_path.h"
#include "models/normalized_response.h"

namespace mindahl::identification {

/// Holds what is to be solved: records, a model, their initial state and the parameters. Nothing of
/// it changes during the solution.
struct Problem {
  const ScaledRecords* data;
  const models::FrictionModel* model;
  RecordStates state;
  Parameters parameters;

  [[nodiscard]] std::size_t size() const { return data->samples(); }
};

/// Holds what the normalized response t depends on, in units of the data: all but its factor.
struct LawPoint {
  double log_rate = 0.0;       // ln(σ/Tc); of an imposed force −ln Tc
  double shape = 0.0;          // α
  double log_travel = 0.0;     // ln(Tc/k) of the rig; ignored without one
  double load_exponent = 1.0;  // p; 1 where the records are under one load
  // All parameters, for where each record is unloaded, the lag and the asymmetry.
  std::span<const double> theta;
};

/// Returns the point of the law at θ.
LawPoint PointAt(const Problem& problem, std::span<const double> theta);

/// Returns the log of the factor of t: ln Tc, or ln(Tc/σ) of a displacement.
double LogScaleAt(const Problem& problem, std::span<const double> theta);

/// The law over the slip force of one record, under its mean load: σ/Tc ∝ N^{p−1}, Tc/k ∝ N.
models::NormalizedLaw LawUnder(const Problem& problem, const LawPoint& at,
                               const ScaledRecord& record);

/// Derivatives of t, a column each of all samples; an empty one is not wanted.
struct ResponseColumns {
  std::span<double> log_rate;
  std::span<double> shape_exponent;
  std::span<double> unloaded;  // where the contact is unloaded, in the channel that is imposed
  std::span<double> log_spring_travel;
  std::span<double> moved;      // by θ of the term that moves the contact; where there is one
  std::span<double> asymmetry;  // likewise
  std::span<double> slip_slope;
  std::span<double> slip_curvature;
  std::span<double> slip_speed;
  std::span<double> slip_speed_exponent;
  std::span<double> slip_trend;
  std::span<double> drag_fraction;
  std::span<double> drag_exponent;
};
inline constexpr std::array kResponseColumns = {
    &ResponseColumns::log_rate,     &ResponseColumns::shape_exponent,
    &ResponseColumns::unloaded,     &ResponseColumns::log_spring_travel,
    &ResponseColumns::moved,        &ResponseColumns::asymmetry,
    &ResponseColumns::slip_slope,   &ResponseColumns::slip_curvature,
    &ResponseColumns::slip_speed,   &ResponseColumns::slip_speed_exponent,
    &ResponseColumns::slip_trend,   &ResponseColumns::drag_fraction,
    &ResponseColumns::drag_exponent};

/// One summand of ∂(scale·t)/∂θ over the scale: factor·column, where no column stands for t itself.
struct Sensitivity {
  std::span<double> ResponseColumns::*column = nullptr;
  double factor = 1.0;
  bool by_log_load = false;  // times ln(N/N₀) of the record
};

/// How the response depends on a parameter that is not linear: the summands of ∂(scale·t)/∂θ over
/// the scale, and how far a search may move θ in one step. A parameter of the law or the path is a
/// row of the table in problem.cc.
struct LawSensitivity {
  std::array<Sensitivity, 3> summands;
  std::size_t count = 0;
  double longest_step = 1.5;           // of θ
  bool step_grows_with_theta = false;  // times θ, where that is beyond 1

  [[nodiscard]] std::span<const Sensitivity> all() const {
    return std::span(summands).first(count);
  }
};

/// Returns the sensitivity to a parameter; it is empty for one that is linear, and for one that the
/// problem does not have.
LawSensitivity SensitivityTo(const Problem& problem, std::size_t parameter);

/// t = T/Tc of all samples, one record after the other, Tc that of the mean load: by the branch law
/// where a record is under one load, by the elements' (models/variable_load.h) where it varies. Of
/// a contact whose force is imposed t = σδ/Tc by the branch law's inverse, NaN of a whole record
/// that has a force beyond slip. Keeps the loading paths, which depend on the point only where a
/// contact is unloaded, by its lag and its asymmetry, and its buffers.
class Response {
 public:
  void Bind(const Problem& problem);
  void Evaluate(const LawPoint& at, std::span<double> t);
  void Differentiate(const LawPoint& at, std::span<double> t, const ResponseColumns& columns);
  /// Differentiates one record by its branches' starts, for fits of turning points.
  void DifferentiateByOrigins(const LawPoint& at, std::size_t record,
                              models::OriginSensitivity& sensitivity);
  /// Returns the loading path of a record of the problem that is bound, of its samples.
  const models::LoadingPath& PathOf(std::size_t record, std::span<const double> theta);
  /// Returns the slip force over Tc at a sample of the problem that is bound.
  [[nodiscard]] double SlipFactor(const ScaledRecord& record, const LawPoint& at,
                                  std::size_t sample) const;
  /// Columns for derivatives on their way to a Jacobian; valid until the next call.
  std::span<double> Scratch(std::size_t size) {
    if (scratch_.size() < size) scratch_.resize(size);
    return std::span(scratch_).first(size);
  }

 private:
  void DifferentiateRecord(const LawPoint& at, std::size_t r, std::span<double> t,
                           const ResponseColumns& columns);
  [[nodiscard]] models::InitialContact InitialOf(std::size_t record,
                                                 std::span<const double> theta) const;
  /// Multiplies t and its derivatives by SlipFactor() at each sample.
  void ScaleBySlipForce(std::size_t record, const LawPoint& at, std::span<double> t,
                        const ResponseColumns& columns) const;
  void ScaleSensitivity(std::size_t record, const LawPoint& at,
                        models::OriginSensitivity& sensitivity) const;
  /// Returns the unit of the amount by which a record's samples are moved.
  [[nodiscard]] double UnitOfAmount(std::size_t record) const;
  MovedSamples& MovedOf(std::size_t record, std::span<const double> theta);
  /// Returns them as they are under the forces at this point.
  MovedSamples& MovedUnderForces(const LawPoint& at, std::size_t record);
  /// Returns a buffer of a value for each place.
  std::span<double> PlacesOf(const MovedSamples& moved, std::size_t column);
  void DifferentiateForced(const LawPoint& at, std::size_t r, std::span<double> t,
                           const ResponseColumns& columns);
  void DifferentiateMoved(const LawPoint& at, std::size_t record, std::span<double> t,
                          const ResponseColumns& columns);

  struct CachedPath {
    models::LoadingPath path;
    double unloaded = 0.0;
    double asymmetry = 0.0;
    bool valid = false;
  };

  const Problem* problem_ = nullptr;
  std::vector<CachedPath> paths_;
  std::vector<std::size_t> unloaded_;  // position of each record's origin
  models::NormalizedResponse response_;
  models::NormalizedDisplacement displacement_;
  std::vector<double> scratch_;
  std::size_t asymmetry_ = 0;   // position of the parameter
  std::size_t slip_slope_ = 0;  // likewise
  std::size_t slip_curvature_ = 0;
  std::size_t slip_speed_ = 0;
  std::size_t slip_speed_exponent_ = 0;
  std::size_t slip_trend_ = 0;
  std::size_t drag_fraction_ = 0;
  std::size_t drag_exponent_ = 0;
  bool slip_varies_ = false;  // over positions, speeds or time
  bool slip_goes_by_speed_ = false;
  bool has_drag_ = false;
  // For a problem with a term that moves the contact:
  std::size_t moves_ = 0;  // its position
  bool has_moved_ = false;
  std::vector<std::unique_ptr<MovedSamples>> motions_;  // of each record
  std::vector<double> moved_;                           // columns of all places of one
  models::OriginSensitivity sensitivity_;
  std::vector<models::LoadedHistory> histories_;  // of records under a load that varies
  models::NormalizedLoadedResponse loaded_response_;
};

/// Computes the response of the whole model at θ, of every sample [units of the data]; no weight.
void Predict(const Problem& problem, std::span<const double> theta, Response& response,
             std::span<double> predicted);

/// Takes what is measured off what the model predicts, of every sample; no weight.
void TakeOffMeasured(const ScaledRecords& data, std::span<double> predicted);

/// Weighted residuals, model − measured, of every sample; binds the response to the problem.
void EvaluateResidual(const Problem& problem, std::span<const double> theta, Response& response,
                      std::span<double> residual);

/// Adds a multiple of the column of a linear parameter, without weights; nothing where it is
/// another record's.
/// @param theta  of all parameters: a column may depend on some (Term::shapes)
/// @param to     of the record's samples
void AddColumn(const Problem& problem, std::size_t parameter, std::size_t record,
               std::span<const double> theta, double factor, std::span<double> to);

/// True if columns of linear parameters depend on this one.
bool ShapesColumns(const Problem& problem, std::size_t parameter);

/// Adds a multiple of ∂(Σ θ_q·column_q)/∂θ by a parameter that shapes columns, without weights.
/// @param theta  of all parameters, the linear ones included
/// @param to     of the record's samples
void AddDerivativeOfColumns(const Problem& problem, std::size_t parameter, std::size_t record,
                            std::span<const double> theta, double factor, std::span<double> to);

/// Computes the weighted residuals, model − measured, and their derivatives by the parameters at
/// `columns`. The response is bound to the problem.
/// @param residual  size() values
/// @param jacobian  column-major, size() × columns.size()
void Differentiate(const Problem& problem, std::span<const double> theta, Response& response,
                   std::span<const std::size_t> columns, std::span<double> residual,
                   std::span<double> jacobian);

}  // namespace mindahl::identification
