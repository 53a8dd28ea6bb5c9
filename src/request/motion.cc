#include "mindahl/request/motion.h"

#include <fmt/format.h>

#include <cmath>
#include <cstddef>
#include <numeric>
#include <utility>

#include "mindahl/core/error.h"
#include "mindahl/io/record_reader.h"

namespace mindahl::request {
namespace {

/// Time counts rows.
std::vector<double> CountRows(std::size_t rows) {
  std::vector<double> time(rows);
  std::iota(time.begin(), time.end(), 0.0);
  return time;
}

ImposedMotion MotionFromFile(const DriveRequest& request) {
  ImposedMotion motion;
  const io::ColumnChoice displacement{.column = "", .unit = request.path_unit};
  if (request.load_column.empty()) {
    motion.displacement = io::ReadDisplacementPath(request.path, displacement);
  } else {
    io::LoadedPath loaded = io::ReadLoadedPath(
        request.path, displacement, {.column = request.load_column, .unit = request.load_unit});
    motion.displacement = std::move(loaded.displacement);
    motion.normal_load = std::move(loaded.normal_load);
  }
  motion.time = CountRows(motion.displacement.size());
  return motion;
}

ImposedMotion MotionFromWaveform(const DriveRequest& request, const models::BranchLaw& law) {
  models::ExcitationOptions excitation = request.excitation;
  excitation.waveform = *models::FindWaveform(request.waveform);
  excitation.seed = request.seed;
  if (request.lambda.has_value() == request.amplitude.has_value()) {
    throw InputError("--lambda or --amplitude, one of the two, must be given (or --path)");
  }
  if (request.lambda) {
    RequirePositive("--lambda [-]", *request.lambda);
    const double gross_slip = GrossSlipDisplacement(law);
    if (!std::isfinite(gross_slip)) {
      throw InputError(fmt::format(
          "--lambda needs a finite gross-slip displacement, which does not exist for alpha = {} >= "
          "1: give --amplitude",
          law.shape_exponent));
    }
    excitation.amplitude = *request.lambda * gross_slip;
  } else {
    RequirePositive("--amplitude [m]", *request.amplitude);
    excitation.amplitude = *request.amplitude;
  }
  models::Excitation made = models::MakeExcitation(excitation);
  ImposedMotion motion{std::move(made.time), std::move(made.displacement), {}, {}};
  if (excitation.waveform == models::Waveform::kGrowingSine)
    motion.envelope = std::move(made.envelope);
  return motion;
}

}  // namespace

ImposedForce ReadImposedForce(const DriveRequest& request, const models::BranchLaw& law) {
  io::ForcePath path =
      io::ReadForcePath(request.force_path, {.column = "", .unit = request.force_path_unit});
  for (std::size_t i = 0; i < path.force.size(); ++i) {
    if (std::abs(path.force[i]) < law.slip_force) continue;
    throw InputError(fmt::format(
        "{}:{}: a force of {} N is not within the slip force, {} N, at which the contact slides "
        "any distance: keep forces below it, or impose the displacement with --path",
        request.force_path, path.lines[i], path.force[i], law.slip_force));
  }
  return {CountRows(path.force.size()), std::move(path.force)};
}

ImposedMotion MakeMotion(const DriveRequest& request, const models::BranchLaw& law) {
  return request.path.empty() ? MotionFromWaveform(request, law) : MotionFromFile(request);
}

}  // namespace mindahl::request
