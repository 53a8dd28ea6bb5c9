#include "mindahl/identification/thresholds.h"

#include <array>

namespace mindahl::identification {
namespace {

constexpr std::array kTable = {
    ThresholdRow{"significance", &Thresholds::significance, "p",
                 "Mindlin's exponent is rejected below it",
                 "the usual two-sided convention; a rig is looked for on rejection only"},
    ThresholdRow{"shape_effect", &Thresholds::shape_effect, "α",
                 "from Mindlin's exponent, for a rig to be looked for in its place",
                 "the branches then depart by 1 % of Tc: less is not worth a rig, however sure"},
    ThresholdRow{"indistinguishable", &Thresholds::indistinguishable, "ΔAICc",
                 "fits less apart are not distinguished from each other",
                 "an evidence of e² to 1; noise makes a superfluous parameter look better by more "
                 "with a chance of P(χ²₁ > 6) = 1.4 %"},
    ThresholdRow{"rigid_beside_rig", &Thresholds::rigid_beside_rig, "σ/k",
                 "a contact that much stiffer than the rig is rigid",
                 "3 % of the travel of stick is then the contact's: the loop is that of Jenkins' "
                 "element, whatever α"},
    ThresholdRow{"poor_misfit", &Thresholds::poor_misfit, "rms over half gap or T*",
                 "from here on a repeatable misfit is reported",
                 "two per cent of the force are visible next to the loop's line in a plot"},
    ThresholdRow{"quantitative_misfit", &Thresholds::quantitative_misfit,
                 "missed over half gap or T*",
                 "a model that misses more is indicative, not quantitative",
                 "what repeated tests of one seal differ by, run to run"},
    ThresholdRow{"failing_misfit", &Thresholds::failing_misfit, "missed over half gap or T*",
                 "from here on no parameters of the shape are given",
                 "where the law carries half of Tc, an error of 0.15 is a third of the force: the "
                 "knee is then somewhere else"},
    ThresholdRow{
        "repeats_when_poor", &Thresholds::repeats_when_poor, "fraction of variance",
        "of a poor misfit, what repeats from stroke to stroke to be called systematic",
        "noise of the same rms leaves 1 − 0.3 of the variance: the systematic part is then "
        "√(0.3/0.7) = 0.65 of it"},
    ThresholdRow{"repeats_when_failing", &Thresholds::repeats_when_failing, "fraction of variance",
                 "the same of a failing misfit",
                 "a failing misfit with 10 % that repeat is 3 % of the force by itself: poor"},
    ThresholdRow{"repeat_chance", &Thresholds::repeat_chance, "p",
                 "chance at which white noise passes for repeatable",
                 "one loop in a thousand, since its standard errors are then widened for nothing"},
    ThresholdRow{"noise_differs", &Thresholds::noise_differs, "p",
                 "records whose residuals' variances noise makes so unlike less often have a noise "
                 "of their own each",
                 "of records of one noise one set in a hundred is weighed by variances that it "
                 "has by chance, which costs it nothing that is seen"},
    ThresholdRow{"slope_scatter", &Thresholds::slope_scatter, "p",
                 "residuals whose scatter noise of the force makes less often as large where the "
                 "loop is steep are tried with noise of the displacement",
                 "what is found must also be no more than the readings themselves scatter, and "
                 "the fit with it adequate"},
    ThresholdRow{"main_stroke", &Thresholds::main_stroke, "of the longest",
                 "strokes at least so long are compared with each other",
                 "shorter ones are nested loops, run-in or run-out; the same as for X and T*"},
    ThresholdRow{"same_directions", &Thresholds::same_directions, "correlation",
                 "two directions of the stroke have the same residual, or opposite ones",
                 "20 places of a stroke: by chance beyond 0.6 once in 200"},
    ThresholdRow{"early_in_stroke", &Thresholds::early_in_stroke, "of the stroke",
                 "a residual that peaks before it follows the reversal",
                 "stick ends there in a loop of twice gross slip"},
    ThresholdRow{
        "path_excess", &Thresholds::path_excess, "of the strokes",
        "way between the samples beyond that of the strokes, to be warned of",
        "white noise makes so much where its deviation is 0.8 of a step between samples: one "
        "step in five then goes backward, which the contact takes for a reversal"},
    ThresholdRow{"sliding_energy_ratio", &Thresholds::sliding_energy_ratio, "W/(4XT*)",
                 "a measured loop that loses more slides over most of its stroke",
                 "Mindlin's contact loses as much at twice its gross slip, from where on the gap "
                 "in the middle of the stroke is that of the slip force"},
    ThresholdRow{"energy_difference", &Thresholds::energy_difference, "of the larger",
                 "between measured energy and the model's, for the two to contradict each other",
                 "a loop of which the model takes a fifth for something else is not the model's: "
                 "Tc would be off by as much"},
    ThresholdRow{"energy_errors", &Thresholds::energy_errors, "standard errors",
                 "of the measured energy, that the contradiction is beyond",
                 "far from slip the loop is thin, and noise alone makes a fifth of its energy"},
    ThresholdRow{"trend_size", &Thresholds::trend_size, "of the mean a cycle",
                 "a trend that is smaller is not said in words",
                 "of ten cycles the first and the last then differ by a tenth"},
    ThresholdRow{"trend_chance", &Thresholds::trend_chance, "p",
                 "a trend that the scatter of cycles makes more often is not said in words",
                 "of two that are looked at, one record in fifty has one by chance"},
    ThresholdRow{"widest_ratio", &Thresholds::widest_ratio, "upper over lower end",
                 "of a 95 % interval of σ or Tc that still counts as known",
                 "a factor of three either way: the order of magnitude"},
    ThresholdRow{"widest_shape", &Thresholds::widest_shape, "α, or of α where that is larger",
                 "width of a 95 % interval of α that still counts as known",
                 "0 to 1 holds Jenkins', Mindlin's and Dahl's own law alike"},
    ThresholdRow{"open_slip_force", &Thresholds::open_slip_force, "2 ln Λ",
                 "a slip force twenty times the largest force that loses less is not excluded",
                 "five standard errors: by the 95 % test alone one loop in twenty far from slip "
                 "would pass for one that slips"},
    ThresholdRow{"parabola_error", &Thresholds::parabola_error, "half interval of ln Tc",
                 "beyond it the likelihood is profiled, not taken for a parabola",
                 "exp(0.1) − 1 departs from 0.1 by a twentieth: the ends of the interval by the "
                 "like"},
    ThresholdRow{"parabola_departure", &Thresholds::parabola_departure, "fraction of 2 ln Λ",
                 "deviation from the parabola, at its 95 % ends of Tc, that asks for a profile",
                 "15 % of 2 ln Λ are 7 % of the interval's width"},
    ThresholdRow{"parabola_mobilised", &Thresholds::parabola_mobilised, "T* over Tc",
                 "a loop that reaches less is always profiled",
                 "below it the valley of α and Tc may be left by the parabola unseen"},
    ThresholdRow{"rigid_error", &Thresholds::rigid_error, "half interval of ln σ",
                 "a σ that is known worse is tried against a rigid contact",
                 "by the parabola a contact a thousand times stiffer is then 45 standard errors "
                 "away: beyond it the parabola is not trusted"},
    ThresholdRow{"turning_point_chance", &Thresholds::turning_point_chance, "p",
                 "chance at which turning points between samples are fitted for nothing",
                 "they cost a parameter a reversal; a record that needs them shows it by far"},
    ThresholdRow{"turning_point_shift", &Thresholds::turning_point_shift, "standard errors",
                 "turning points where the motion has them are tried where they may move a "
                 "parameter by more",
                 "a bias of that size leaves a 95 % interval 94.5 %"},
    ThresholdRow{"force_noise_share", &Thresholds::force_noise_share, "of a residual's variance",
                 "samples with less are left out of the model of the force's noise",
                 "where the displacement's noise prevails, residuals are as autocorrelated as its "
                 "errors are, which are drawn apart"},
    ThresholdRow{
        "most_absorbed", &Thresholds::most_absorbed, "of the samples",
        "of autocorrelated noise a fit is taken to absorb no more",
        "beyond it the residuals no longer determine the noise: its variance is at most doubled"},
    ThresholdRow{"redundant_gain", &Thresholds::redundant_gain, "2 ln Λ",
                 "a model that gains less on a simpler one is that one",
                 "ten times what the solver may leave"},
    ThresholdRow{"jenkins_shape", &Thresholds::jenkins_shape, "α",
                 "at its bound and below, a shape exponent is that of Jenkins' element",
                 "the branches depart by less than 1 % of Tc"},
    ThresholdRow{"known_together", &Thresholds::known_together, "correlation",
                 "from here on two parameters are known only together",
                 "either alone is then 1/√(1 − 0.99²) = 7 times less certain than with the other "
                 "known"},
    ThresholdRow{"doubt", &Thresholds::doubt, "p",
                 "residuals that noise alone makes less often are not noise alone",
                 "one adequate loop in two hundred is doubted"},
    ThresholdRow{"cause", &Thresholds::cause, "p",
                 "an omitted term that noise alone makes less often is a cause",
                 "of the 23 that are tried, one loop in forty then has one by chance"},
    ThresholdRow{"rival_cause", &Thresholds::rival_cause, "of what the best explains",
                 "a cause that explains so much is one that intervals cover",
                 "omitted terms are taken to first order: of two imperfect models the better need "
                 "not be the true one"},
    ThresholdRow{
        "simpler_cause", &Thresholds::simpler_cause, "of what the other explains",
        "a cause that is part of another and explains so much is named in its place",
        "likewise one that can be tried in place of one that cannot: the rest is less than "
        "15 % of the residuals' variance, 40 % of their rms"},
    ThresholdRow{"noise_memory", &Thresholds::noise_memory, "strokes",
                 "a poor misfit whose residuals remember for longer is not taken for noise",
                 "within half a stroke the force does all that a law says of it: noise of that "
                 "length and a misfit are one"},
    ThresholdRow{"rival_past", &Thresholds::rival_past, "ΔAICc",
                 "virgin and steady are both covered by the intervals if less apart",
                 "an evidence of e⁵ = 150 to 1: the two differ in a few samples only, where one "
                 "odd reading decides"},
    ThresholdRow{"fewest_places", &Thresholds::fewest_places, "places of the loop",
                 "where fewer are sampled again and again, σ and α are not believed",
                 "four each for σ, α, Tc and for where the motion turns between them"},
    ThresholdRow{"starts_unloaded", &Thresholds::starts_unloaded, "of X",
                 "a contact unloaded that near to the first sample was at rest before it",
                 "as near as a record's end counts as a turn of the motion"},
    ThresholdRow{"mobilised_by_asymptote", &Thresholds::mobilised_by_asymptote, "T* over Tc",
                 "a loop of α >= 1 that reaches less has its slip force from the law alone",
                 "the last tenth of the way is the longest: for α = 1 as long as all before it "
                 "once more"},
    ThresholdRow{"one_amplitude", &Thresholds::one_amplitude, "of the narrowest",
                 "swings that are wider by less are of one amplitude",
                 "Masing's loops of two amplitudes and Dahl's with one σ and Tc then part by less "
                 "than 0.3 % of Tc"},
    ThresholdRow{"rival_law", &Thresholds::rival_law, "ΔAICc",
                 "Masing's law and Dahl's own are not distinguished by less",
                 "an evidence of e⁵ = 150 to 1, as of the two pasts: what either misses of a real "
                 "loop can be worth less"},
    ThresholdRow{"memory_chance", &Thresholds::memory_chance, "p",
                 "branches whose differences noise makes less often are not of a memory",
                 "one loop in a hundred is denied the memory that it has, where none but noise "
                 "makes its branches differ"},
    ThresholdRow{
        "seen_loop", &Thresholds::seen_loop, "R²",
        "a loop that explains less of the force is not seen, and none of it believed",
        "the rest of the force is three times the loop: a tenth of it that is regular is a "
        "third of the loop"},
    ThresholdRow{"load_difference", &Thresholds::load_difference, "of the smaller",
                 "mean loads of records further apart are a load series",
                 "Tc then differs by as much, which a fit of one Tc sees; σ by a third of it"},
    ThresholdRow{"load_variation", &Thresholds::load_variation, "of the mean",
                 "amplitude of a sine of the load's standard deviation, white noise of its "
                 "readings taken off, from which on the law follows the load",
                 "the force differs by as much where the contact slips"},
    ThresholdRow{"visible_noise", &Thresholds::visible_noise, "of X",
                 "noise of the displacement from which on the channels are compared",
                 "the third differences of a clean sine of 31 samples a cycle are as large"},
    ThresholdRow{"noisier_displacement", &Thresholds::noisier_displacement, "of the force's share",
                 "a displacement whose noise over X is so many times that of the force over T* is "
                 "the channel to fit",
                 "along the loop's diagonal the force then makes 1/(1 + 5²) = 4 % of the "
                 "residuals' variance"},
    ThresholdRow{
        "never_slips", &Thresholds::never_slips, "of Tc",
        "a steady loop that leaves more of the slip force unreached determines no asymmetry",
        "what never slips keeps a force between its limits, of which nothing is known: it "
        "moves the asymmetry by as much"},
    ThresholdRow{"prior_distance", &Thresholds::prior_distance, "standard deviations",
                 "a prior further from what the records say without it contradicts them",
                 "of a right prior that happens once in 370 fits"},
};

}  // namespace

std::span<const ThresholdRow> ThresholdTable() { return kTable; }

}  // namespace mindahl::identification
