#include "mindahl/report/page.h"

#include "mindahl/identification/fit.h"
#include "mindahl/models/friction_model.h"
#include "report/made_report.h"
#include "report/template.h"
#include "support/histories.h"
#include "support/prelude.h"
#include "support/text.h"

namespace mindahl::report::page_test {
namespace {

using identification::AdequacyVerdict;
using identification::Identifiability;

/// What the reader sees: without the rules of style.
std::string BodyOf(const std::string& page) { return page.substr(page.find("<body>")); }

std::string PageOf(ReportInput input, const Provenance& provenance = {}) {
  return testing::Unbroken(BodyOf(ToPage(MakeReport(std::move(input)), provenance)));
}

ReportInput JudgedInput(AdequacyVerdict verdict) {
  ReportInput input = MadeInput();
  input.fit.adequacy.tried = 15;
  input.fit.adequacy.verdict = verdict;
  return input;
}

/// A figure from its first tag to its last.
std::string FigureOf(const std::string& page, const std::string& id) {
  const std::size_t begin = page.find("<figure id=\"" + id + "\"");
  if (begin == std::string::npos) return "";
  return page.substr(begin, page.find("</figure>", begin) - begin);
}

TEST(Page, BreaksNoOptionAndNoNameWithinAWord) {
  Provenance provenance;
  provenance.command = "mindahl fit -- a--b.csv --rig-stiffness fit";
  const std::string page = ToPage(MakeReport(MadeInput()), provenance);
  EXPECT_THAT(page, HasSubstr("<pre><code>mindahl fit -- a--b.csv "
                              "<span class=\"option\">--rig-stiffness</span> fit</code></pre>"));
  provenance.options = {{"a_b", "1"}};
  EXPECT_THAT(ToPage(MakeReport(MadeInput()), provenance),
              HasSubstr("<th scope=\"row\">a_<wbr>b</th>"));
}

TEST(Page, BeginsWithTheFileAndTheVerdict) {
  const std::string page = PageOf(JudgedInput(AdequacyVerdict::kDoubtful));
  EXPECT_THAT(page, HasSubstr("<h1>loop_1.csv: doubtful</h1>"));
  EXPECT_LT(page.find("class=\"verdict poor\""), page.find("<h2>Parameters</h2>"));
  EXPECT_LT(page.find("<figure id=\"loop\""), page.find("<h2>Warnings and what to do</h2>"));
}

TEST(Page, SaysItsSectionsInTheOrderInWhichTheyAreRead) {
  const std::string page = PageOf(JudgedInput(AdequacyVerdict::kAdequate));
  std::size_t last = 0;
  for (const char* heading :
       {"class=\"verdict good\"", "<h2>Parameters</h2>", "<h2>Warnings and what to do</h2>",
        "<h2>What the record says without a model</h2>", "<h2>Residuals</h2>",
        "<h2>Loop of the model</h2>", "<h2>The contact</h2>", "<h3>Is it Mindlin's contact?</h3>",
        "<h2>The record</h2>", "<h2>How to reproduce this page</h2>"}) {
    const std::size_t at = page.find(heading);
    ASSERT_NE(at, std::string::npos) << heading;
    EXPECT_GT(at, last) << heading;
    last = at;
  }
}

TEST(Page, ForbidsWhatItDoesNotNeed) {
  const std::string page = ToPage(MakeReport(MadeInput()));
  EXPECT_THAT(page, HasSubstr("content=\"default-src 'none'; style-src 'unsafe-inline'; img-src "
                              "data:\""));
  for (const char* what : {"<script", "http://", "https://", "{{", "}}}"}) {
    EXPECT_THAT(page, Not(HasSubstr(what)));
  }
}

TEST(Template, EscapesTextAndKeepsOptionsWhole) {
  const std::string page = RenderPage("verdict", {{"title", "<a> & --lag"},
                                                  {"class", "bad"},
                                                  {"word", "<b>"},
                                                  {"sentence", "use --lag & 'x_y.csv'"}});
  EXPECT_THAT(page, HasSubstr("<title>&lt;a&gt; &amp; --lag</title>"));
  EXPECT_THAT(page, HasSubstr("<p class=\"verdict bad\"><strong>&lt;b&gt;</strong>: use <span "
                              "class=\"option\">--lag</span> &amp; &#39;x_y.csv&#39;</p>"));
}

TEST(Template, ShowsOfAListThatIsEmptyNothing) {
  const Json one = {{"id", "f"}, {"width", 2}, {"height", 1}, {"elements", "<g/>"}};
  for (const bool is_empty : {false, true}) {
    Json data = one;
    data["title"] = "";
    data["legend"] = is_empty ? Json::array() : Json{{{"symbol", "<g/>"}, {"label", "a < b"}}};
    const std::string page = RenderPage("drawing", data);
    EXPECT_THAT(page, HasSubstr("viewBox=\"0 0 2 1\""));
    EXPECT_EQ(page.find("<ul") == std::string::npos, is_empty);
    EXPECT_EQ(page.find("<g/></svg>a &lt; b</li>") == std::string::npos, is_empty);
  }
}

TEST(Template, NamesAMemberThatTheDataDoNotHave) {
  try {
    RenderPage("verdict", {{"title", "a"}, {"class", "bad"}, {"word", "failed"}});
    FAIL() << "a template without its data was shown";
  } catch (const std::logic_error& error) {
    EXPECT_STREQ(error.what(), "the data of the page 'verdict' have no 'sentence'");
  }
  EXPECT_THROW(RenderPage("no_such_page", {{"title", "a"}}), std::logic_error);
}

TEST(Page, DrawsEveryFigureOfAFit) {
  const std::string page = PageOf(JudgedInput(AdequacyVerdict::kAdequate));
  for (const std::string id : {"loop", "residual-stroke", "residual-time", "residual-distribution",
                               "residual-autocorrelation"}) {
    const std::string figure = FigureOf(page, id);
    EXPECT_THAT(figure, ::testing::ContainsRegex("class=\"(line|dots|bars) [hs][0-7]\" d=\"M[0-9]"))
        << id;
    for (const std::string part : {"-title", "-text"}) {  // by which it is read aloud
      EXPECT_THAT(figure, HasSubstr(" id=\"" + (id + part) + "\">"));
    }
    EXPECT_THAT(figure, HasSubstr("labelledby=\"" + id + "-title " + id + "-text\""));
  }
}

TEST(Page, WritesParametersWithPrefixesAndIntervals) {
  const std::string page = PageOf(JudgedInput(AdequacyVerdict::kAdequate));
  // σ = 4e7 ± 4e5 N/m, to 2 of the error's digits; the made interval is two errors to either side.
  EXPECT_THAT(page, HasSubstr("40.00 ± 0.40 N/µm</td>"
                              "<td class=\"number\">39.20 … 40.80</td>"));
  EXPECT_THAT(page, HasSubstr("<th scope=\"row\">slip force Tc</th>"));
}

TEST(Page, HasNoValueOfUnidentifiableParameters) {
  ReportInput input = JudgedInput(AdequacyVerdict::kAdequate);
  // Digits that nothing else has.
  identification::ParameterEstimate& sigma = input.fit.parameters[0];
  sigma.value = 7.6543e7;
  sigma.lower95 = 7.5432e7;
  sigma.upper95 = 7.8765e7;
  sigma.identifiability = Identifiability::kNotIdentifiable;
  identification::ParameterEstimate& alpha = input.fit.parameters[1];
  alpha.value = 0.34567;
  alpha.identifiability = Identifiability::kNotIdentifiable;
  identification::ParameterEstimate& slip_force = input.fit.parameters[2];
  slip_force.value = 98.765;
  slip_force.lower95 = 12.5;
  slip_force.upper95.reset();
  slip_force.standard_error.reset();
  slip_force.identifiability = Identifiability::kBoundedBelow;
  input.fit.law = {7.6543e7, 0.34567, 98.765};
  input.fit.residuals.normalized_rms = 0.013579;
  input.known.normal_load = 123.0;
  const std::string page = PageOf(std::move(input));
  // Places in figures have one decimal.
  for (const char* digits : {"76.54", "7.654", "75.43", "78.76", "0.3456", "0.3457", "98.76",
                             "98.77", "0.0135", "0.803"}) {  // and μ = 98.765/123
    EXPECT_THAT(page, Not(HasSubstr(digits)));
  }
  EXPECT_THAT(page, HasSubstr("&gt; 12.5"));
}

TEST(Page, OfAnInadequateModelHasNoContactAndNoLikelihood) {
  ReportInput input = JudgedInput(AdequacyVerdict::kInadequate);
  input.fit.slip_force_profile = {.critical = 4.0,
                                  .points = {{{4e7, 0.3, 30}, 9.0}, {{4e7, 0.3, 40}, 0.0}}};
  const std::string page = PageOf(std::move(input));
  EXPECT_THAT(page, HasSubstr("the model does not describe this record"));
  EXPECT_THAT(page, Not(HasSubstr("Mindlin-Dahl mapping")));
  EXPECT_EQ(FigureOf(page, "likelihood"), "");
}

TEST(Page, ComparesWithHertzOnlyAStiffnessThatIsKnown) {
  ReportInput input = JudgedInput(AdequacyVerdict::kAdequate);
  input.known.normal_load = 50.0;
  for (contact::KnownBody* body : {&input.known.body_1, &input.known.body_2}) {
    *body = {.youngs_modulus = 2e11, .poisson_ratio = 0.3, .radius = 0.1};
  }
  const auto table = HasSubstr("what Hertz and Mindlin predict from materials, radii and load");
  const std::string page = PageOf(input);
  EXPECT_THAT(page, table);
  // The stiffness and its contact radius have one ratio of measured to predicted value; the
  // displacement has its inverse.
  const auto last_cell = [&](std::string_view row) {
    const std::size_t begin = page.find(row);
    const std::size_t end = page.find("</td></tr>", begin);
    const std::size_t cell = page.rfind('>', end - 1) + 1;
    return page.substr(cell, end - cell);
  };
  const std::string ratio = last_cell("contact radius a</th>");
  EXPECT_EQ(last_cell("tangential stiffness 8a/G*</th>"), ratio);
  EXPECT_NEAR(std::stod(ratio) * std::stod(last_cell("gross slip at α = 1/3</th>")), 1, 0.05);
  EXPECT_GT(std::abs(std::stod(ratio) - 1), 0.1) << "the case needs it";
  input.fit.parameters[0].identifiability = Identifiability::kNotIdentifiable;
  EXPECT_THAT(PageOf(std::move(input)), Not(table));
}

TEST(Page, HasTheColourOfItsVerdict) {
  EXPECT_THAT(PageOf(MadeInput()), HasSubstr("class=\"verdict poor\"")) << "not judged";
  EXPECT_THAT(PageOf(JudgedInput(AdequacyVerdict::kAdequate)), HasSubstr("class=\"verdict good\""));
  EXPECT_THAT(PageOf(JudgedInput(AdequacyVerdict::kDoubtful)), HasSubstr("class=\"verdict poor\""));
  EXPECT_THAT(PageOf(JudgedInput(AdequacyVerdict::kInadequate)),
              HasSubstr("class=\"verdict bad\""));
  EXPECT_THAT(PageOf(testing::FailedInput()), HasSubstr("class=\"verdict bad\""));
}

TEST(Page, DrawsARegionWhereBothParametersAreIdentified) {
  ReportInput input = JudgedInput(AdequacyVerdict::kAdequate);
  EXPECT_EQ(FigureOf(PageOf(input), "region-sigma"), "");
  input.fit.regions = {
      {{.parameters = {"sigma", "alpha"}, .boundary = {{3.9e7, 0.3}, {4.1e7, 0.32}, {4e7, 0.36}}}}};
  EXPECT_THAT(FigureOf(PageOf(input), "region-sigma"), HasSubstr("<circle class=\"marker"));
  EXPECT_EQ(FigureOf(PageOf(input), "region-slip-force"), "");
  input.fit.parameters[1].identifiability = identification::Identifiability::kNotIdentifiable;
  EXPECT_EQ(FigureOf(PageOf(input), "region-sigma"), "");
}

TEST(Page, DrawsTheLikelihoodThatTheFitLookedAt) {
  ReportInput input = JudgedInput(AdequacyVerdict::kAdequate);
  EXPECT_EQ(FigureOf(PageOf(input), "likelihood"), "");
  input.fit.slip_force_profile = {
      .critical = 4.0,
      .points = {{{4e7, 0.3, 30}, 9.0}, {{4e7, 0.33, 40}, 0.0}, {{4e7, 0.5, 80}, 2.0}}};
  EXPECT_THAT(FigureOf(PageOf(input), "likelihood"), HasSubstr("<circle class=\"marker"));
}

TEST(Page, GivesTheCommandToTryNext) {
  ReportInput input = JudgedInput(AdequacyVerdict::kDoubtful);
  input.fit.adequacy.causes = {{.code = "channel_lag",
                                .delta_aicc = -50,
                                .explains = 0.5,
                                .size = 0.01,
                                .unit = "s",
                                .option = "--lag fit"}};
  Provenance provenance;
  provenance.command = "mindahl fit 'my loop.csv'";
  EXPECT_THAT(PageOf(input, provenance),
              HasSubstr("<pre><code>mindahl fit &#39;my loop.csv&#39; --lag fit</code></pre>"));
  provenance.options = {{"--lag", "0.001"}};  // tried already
  EXPECT_THAT(PageOf(input, provenance), Not(HasSubstr("--lag fit</code>")));
}

TEST(Page, SaysWhatItTakesToMakeItAgain) {
  Provenance provenance;
  provenance.command = "mindahl fit loop.csv --model mindlin";
  provenance.inputs = {{.name = "loop.csv", .sha256 = std::string(64, 'a')},
                       {.name = "/dev/stdin", .sha256 = std::nullopt}};
  provenance.options = {{"--model", "mindlin"}};
  const std::string page = PageOf(MadeInput(), provenance);
  EXPECT_THAT(page, HasSubstr("<pre><code>mindahl fit loop.csv --model mindlin</code></pre>"));
  EXPECT_THAT(page, HasSubstr(std::string(64, 'a')));
  EXPECT_THAT(page, HasSubstr("not a regular file"));
  EXPECT_THAT(page, HasSubstr("<th scope=\"row\">--model</th>"));
}

TEST(Page, EscapesWhateverComesFromOutside) {
  const std::string attack = "<script>alert(1)</script>\"'&";
  ReportInput input = JudgedInput(AdequacyVerdict::kAdequate);
  input.files = {attack};
  input.records[0].displacement.unit = attack;
  input.records[0].displacement.name = attack;
  Provenance provenance;
  provenance.command = attack;
  provenance.inputs = {{.name = attack, .sha256 = attack}};
  provenance.options = {{attack, attack}};
  const std::string page = ToPage(MakeReport(input), provenance);
  EXPECT_THAT(page, Not(HasSubstr("<script")));
  EXPECT_THAT(page, HasSubstr("&lt;script&gt;"));
}

TEST(Page, DistinguishesRecordsOfAJointFit) {
  ReportInput input = MadeInput({MadeRecord(1e-6), MadeRecord(2e-6)}, 2e-6);
  const std::string page = PageOf(std::move(input));
  EXPECT_THAT(page, HasSubstr("<h1>loop_1.csv and 1 more: not judged</h1>"));
  const std::string loop = FigureOf(page, "loop");
  EXPECT_THAT(loop, HasSubstr("measured loop_1.csv"));
  EXPECT_THAT(loop, HasSubstr("measured loop_2.csv"));
}

TEST(Page, NamesTheFirstAndTheLastOfManyRecords) {
  const std::string loop =
      FigureOf(PageOf(MadeInput(std::vector<loop::Record>(10, MadeRecord(2e-6)), 2e-6)), "loop");
  for (int r = 1; r <= 10; ++r) {
    const std::string name = "measured loop_" + std::to_string(r) + ".csv";
    EXPECT_EQ(loop.find(name) != std::string::npos, r == 1 || r == 10) << name;
  }
}

TEST(Page, OfAFitThatFailedSaysWhy) {
  const std::string page = PageOf(FailedInput());
  EXPECT_THAT(page, HasSubstr("class=\"verdict bad\""));
  EXPECT_THAT(page, HasSubstr("no start led anywhere"));
  EXPECT_THAT(page, Not(HasSubstr("<figure")));
}

TEST(Page, HasASizeThatDoesNotGrowWithTheRecord) {
  constexpr std::size_t kSamples = 200'000;
  // Five figures of 6000 points at most, the longest of them below 30 bytes, and the words.
  constexpr std::size_t kMost = 5 * 6000 * 30 + 100'000;
  EXPECT_LT(PageOf(MadeInput({MadeRecord(2e-6, kSamples)}, 2e-6)).size(), kMost);
}

TEST(Page, OfARealFitDrawsItsCycles) {
  // A loop of three cycles, sampled without noise but for a ripple.
  loop::Record record;
  for (int i = 0; i <= 600; ++i) {
    record.displacement.push_back(2e-6 * std::sin(2 * M_PI * i / 200.0));
  }
  record.force = mindahl::testing::Respond(*models::FindFrictionModel("mindlin-dahl"),
                                           {4e7, 1.0 / 3, 40.0}, record.displacement);
  for (std::size_t i = 0; i < record.force.size(); ++i) {
    record.force[i] += 0.05 * std::sin(1.7 * static_cast<double>(i));
  }
  ReportInput input = MadeInput({record}, 2e-6);
  input.fit = identification::Fit(std::vector<loop::Record>{input.records[0].record});
  const std::string page = PageOf(std::move(input));
  EXPECT_THAT(FigureOf(page, "loop"), HasSubstr("measured, cycle 3"));
  EXPECT_THAT(page, HasSubstr("<th scope=\"row\">half gap</th>"));
  EXPECT_THAT(page, HasSubstr("<th scope=\"row\">gross slip (α = 1/3)</th>"));
}

}  // namespace
}  // namespace mindahl::report::page_test
