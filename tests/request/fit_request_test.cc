#include "mindahl/request/fit_request.h"

#include "support/prelude.h"

namespace mindahl::request::fit_request_test {
namespace {

TEST(FitRequest, RefusesAChoiceThatIsNone) {
  for (std::string FitRequest::*member :
       {&FitRequest::model, &FitRequest::initial_state, &FitRequest::force_sign,
        &FitRequest::offsets, &FitRequest::loss, &FitRequest::trim}) {
    FitRequest request;
    request.*member = "oak";
    EXPECT_THROW(MakeFitOptions(request), InputError);
    EXPECT_THROW(Validate(request), InputError);
  }
}

TEST(FitRequest, TakesWhatItsTablesName) {
  for (const std::string_view model : ModelNames()) {
    FitRequest request;
    request.model = model;
    EXPECT_NO_THROW(MakeFitOptions(request)) << model;
  }
}

TEST(FitRequest, RefusesAValueThatIsHeldOutsideItsBound) {
  FitRequest request;
  request.bound["slip_force"] = {1.0, 5.0};
  for (const double held : {0.9, 5.1}) {
    request.fix["slip_force"] = held;
    try {
      MakeFitOptions(request);
      FAIL() << held;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr("outside its --bound 1:5"));
    }
  }
}

TEST(FitRequest, RefusesAWindowThatEndsBeforeItBegins) {
  for (auto [option, window] : {std::pair("--load-window", &FitRequest::load_window),
                                {"--time-window", &FitRequest::time_window}}) {
    FitRequest request;
    request.*window = {1.0, 2.0};
    EXPECT_NO_THROW(MakeFitOptions(request));
    request.*window = {2.0, 1.0};
    try {
      MakeFitOptions(request);
      FAIL() << option;
    } catch (const std::exception& error) {
      EXPECT_THAT(error.what(), HasSubstr(option));
    }
  }
}

TEST(FitRequest, RefusesACertaintyByTheNameOfItsOption) {
  for (const double confidence : {0.0, 1.0, std::numeric_limits<double>::quiet_NaN()}) {
    FitRequest request;
    request.confidence = confidence;
    try {
      MakeFitOptions(request);
      FAIL() << confidence;
    } catch (const InvalidArgument& error) {
      EXPECT_THAT(error.what(), HasSubstr("--confidence [-]"));
    }
  }
}

TEST(FitRequest, ChoosesNoModelForEachCycle) {
  FitRequest request;
  request.model = kAutomatic;
  EXPECT_THROW(MakeCycleFitOptions(request), InputError);
  request.model = "dahl";
  EXPECT_EQ(MakeCycleFitOptions(request).model->name, "dahl");
  request.covariates = {{.column = "pressure", .coefficient = {}}};
  EXPECT_THROW(MakeCycleFitOptions(request), InputError);
}

TEST(FitRequest, KnowsTheMeanOfSeveralNormalLoads) {
  ContactOptions options;
  const std::vector<contact::UncertainValue> loads = {{20.0, 3.0}, {40.0, 4.0}};
  SetNormalLoads(options, loads);
  EXPECT_EQ(options.known.normal_load->value, 30.0);
  EXPECT_EQ(options.known.normal_load->standard_error, 2.5);  // √(3² + 4²)/2
  SetNormalLoads(options, {});
  EXPECT_FALSE(IsAnythingGiven(options));
}

TEST(FitRecords, NeedsARecordAndANameForEach) {
  const Tell ignore = [](std::string_view) {};
  EXPECT_THROW(FitRecords({}, {}, ignore), InputError);
  EXPECT_THROW(FitRecords({}, {io::RecordFile{}}, ignore), InvalidArgument);
}

}  // namespace
}  // namespace mindahl::request::fit_request_test
