// Each struct that a user of the library fills in, with its first or one of its later members set.
#include "mindahl/campaign/tracker.h"
#include "mindahl/contact/mindlin_dahl_mapping.h"
#include "mindahl/convert/conversion.h"
#include "mindahl/identification/fit_options.h"
#include "mindahl/identification/mapping_validation.h"
#include "mindahl/identification/model_comparison.h"
#include "mindahl/identification/plan.h"
#include "mindahl/identification/term_selection.h"
#include "mindahl/io/plot.h"
#include "mindahl/io/record_reader.h"
#include "mindahl/loop/preparation.h"
#include "mindahl/loop/record.h"
#include "mindahl/models/contact_state.h"
#include "mindahl/models/excitation.h"
#include "mindahl/report/report.h"
#include "mindahl/request/fit_request.h"

namespace mindahl {

const campaign::TrackOptions kTrack{.threads = 2};
const contact::KnownBody kBody{.poisson_ratio = 0.3};
const contact::KnownContact kContact{.contact_radius = 1e-3};
const convert::ConversionOptions kConversion{.tolerance = 0.05};
const identification::Expectation kExpectation{.law = {}, .force_noise = 0.1};
const identification::FitOptions kFit{.force_noise = 0.1};
const identification::FitOptions kFitWithBounds{.fixed = {{"alpha", 0.0}}};
const identification::ValidationOptions kValidation{.cases = 3};
const io::Plot kPlot{.title = "loop"};
const io::PlotPanel kPanel{.y_label = "force [N]"};
const io::RecordColumns kColumns{.force = "Fx"};
const loop::Covariate kCovariate{.name = "cubic"};
const loop::PreparationOptions kPreparation{.cycles = loop::CountRange{.first = 2}};
const loop::Record kRecord{.displacement = {0.0, 1.0}, .force = {0.0, 1.0}};
const models::ContactStateOptions kState{.unloaded_displacement = 1e-6};
const models::ExcitationOptions kExcitation{.cycles = 2.0};
const request::ContactOptions kContactOptions{.normal_loads = {}};
const request::FitRequest kRequest{.files = {"loop.csv"}};
const request::LawRequest kLaw{.slip_force = 15.0};

}  // namespace mindahl
