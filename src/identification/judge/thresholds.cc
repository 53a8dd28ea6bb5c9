#include "mindahl/identification/thresholds.h"

#include <array>

namespace mindahl::identification {
namespace {

constexpr std::array kTable = {
    ThresholdRow{"shape_effect", &Thresholds::shape_effect, "α",
                 "at a smaller difference from Mindlin's exponent no rig is tried",
                 "the branches then differ by 1 % of Tc: less does not call for a rig, however "
                 "certain"},
    ThresholdRow{"indistinguishable", &Thresholds::indistinguishable, "ΔAICc",
                 "fits that differ by less are not distinguished",
                 "evidence of e² to 1; by noise a superfluous parameter gains more with "
                 "probability P(χ²₁ > 6) = 1.4 %"},
    ThresholdRow{"rigid_beside_rig", &Thresholds::rigid_beside_rig, "σ/k",
                 "a contact stiffer than this is taken as rigid",
                 "the contact then takes 3 % of the travel before slip: the loop is that of a "
                 "Jenkins element, whatever α"},
    ThresholdRow{"poor_misfit", &Thresholds::poor_misfit, "rms over half gap or T*",
                 "a smaller misfit may be noise however long that remembers",
                 "two per cent of the force are visible next to the loop's line in a plot"},
    ThresholdRow{"quantitative_misfit", &Thresholds::quantitative_misfit,
                 "missed over half gap or T*",
                 "a model that misses more is indicative, not quantitative",
                 "repeated tests of one seal differ by as much"},
    ThresholdRow{"failing_misfit", &Thresholds::failing_misfit, "missed over half gap or T*",
                 "a model that misses more gives no parameters of the shape",
                 "where the law carries half of Tc, an error of 0.15 is a third of the force: the "
                 "knee is elsewhere"},
    ThresholdRow{"repeat_chance", &Thresholds::repeat_chance, "p",
                 "chance at which white noise passes for repeatable",
                 "in one loop in a thousand standard errors are then inflated needlessly"},
    ThresholdRow{"noise_differs", &Thresholds::noise_differs, "p",
                 "records whose residual variances equal noise makes this different less often "
                 "have each a noise level of their own",
                 "one set in a hundred of records with equal noise is then weighted by chance "
                 "variances, at no visible cost"},
    ThresholdRow{"main_stroke", &Thresholds::main_stroke, "of the longest",
                 "only strokes at least this long are compared with each other",
                 "shorter ones are nested loops, run-in or run-out; the same as for X and T*"},
    ThresholdRow{
        "path_excess", &Thresholds::path_excess, "of the strokes",
        "a warning is given if the path through the samples exceeds the strokes by more",
        "white noise of 0.8 steps between samples makes this much: one step in five then goes "
        "backward, and the fit takes it for a reversal"},
    ThresholdRow{"widest_ratio", &Thresholds::widest_ratio, "upper over lower end",
                 "σ or Tc does not count as known if its 95 % interval is wider",
                 "a factor of three either way: the order of magnitude"},
    ThresholdRow{"widest_shape", &Thresholds::widest_shape, "max(α, 1)",
                 "α does not count as known if its 95 % interval is wider",
                 "0 to 1 contains Jenkins', Mindlin's and Dahl's exponents alike"},
    ThresholdRow{"open_slip_force", &Thresholds::open_slip_force, "2 ln Λ",
                 "a slip force of far_slip_force is not excluded if it costs less",
                 "five standard errors: by the 95 % test alone one loop in twenty far from slip "
                 "would pass for one that slips"},
    ThresholdRow{"far_slip_force", &Thresholds::far_slip_force, "of the largest force",
                 "a slip force that is not excluded here leaves the interval of Tc open",
                 "the loop is then that of an elastic contact, to a twentieth of its force"},
    ThresholdRow{"parabola_error", &Thresholds::parabola_error, "half interval of ln Tc",
                 "above it the likelihood is profiled, not approximated by a parabola",
                 "exp(0.1) − 1 differs from 0.1 by a twentieth, and so do the ends of the "
                 "interval"},
    ThresholdRow{"parabola_departure", &Thresholds::parabola_departure, "fraction of 2 ln Λ",
                 "a larger deviation from the parabola, at its 95 % ends of Tc, calls for a "
                 "profile",
                 "15 % of 2 ln Λ are 7 % of the interval's width"},
    ThresholdRow{"parabola_mobilised", &Thresholds::parabola_mobilised, "T* over Tc",
                 "a loop that reaches less is always profiled",
                 "below it the parabola may miss the curved valley of α and Tc"},
    ThresholdRow{"turning_point_shift", &Thresholds::turning_point_shift, "standard errors",
                 "turning points of the motion between samples are tried if they may move a "
                 "parameter by more",
                 "with a bias of this size a 95 % interval covers 94.5 %"},
    ThresholdRow{
        "most_absorbed", &Thresholds::most_absorbed, "of the samples",
        "a fit is assumed to absorb no more of autocorrelated noise",
        "beyond it the residuals no longer determine the noise: its variance is at most doubled"},
    ThresholdRow{"jenkins_shape", &Thresholds::jenkins_shape, "α",
                 "a smaller shape exponent at its bound is that of a Jenkins element",
                 "the branches differ by less than 1 % of Tc"},
    ThresholdRow{"doubt", &Thresholds::doubt, "p",
                 "residuals that noise alone makes less often are not noise alone",
                 "one adequate loop in two hundred is doubted"},
    ThresholdRow{"above_noise", &Thresholds::above_noise, "rms over noise",
                 "larger residuals are not noise, whatever the tests of omitted terms say",
                 "noise by pure error or by neighbours is known to a few per cent: half as much "
                 "again is what no column explains"},
    ThresholdRow{"samples_a_column", &Thresholds::samples_a_column, "samples",
                 "columns of omitted terms are looked for if so many samples pay for each",
                 "with fewer the columns together explain much of any noise"},
    ThresholdRow{"cause", &Thresholds::cause, "p",
                 "an omitted term that noise alone makes less often is a cause",
                 "22 are tried, so one loop in forty has one by chance"},
    ThresholdRow{"rival_cause", &Thresholds::rival_cause, "of what the best explains",
                 "intervals also include causes that explain at least this much",
                 "omitted terms are tried to first order: the better of two imperfect models need "
                 "not be the true one"},
    ThresholdRow{"noise_memory", &Thresholds::noise_memory, "strokes",
                 "a poor misfit whose residuals stay correlated for longer is not taken for noise",
                 "within half a stroke the force passes through the whole law: noise of that "
                 "length cannot be distinguished from a misfit"},
    ThresholdRow{"undecided", &Thresholds::undecided, "ΔAICc",
                 "Masing's law and Dahl's own, and a record of several that is virgin or steady "
                 "unlike the others, are not distinguished if they differ by less",
                 "evidence of e⁵ = 150 to 1: initial states differ in a few samples only, where a "
                 "single odd reading decides, and what either law misses of a real loop can be "
                 "worth less"},
    ThresholdRow{"fewest_places", &Thresholds::fewest_places, "places of the loop",
                 "if every cycle samples fewer, σ and α are not identifiable",
                 "four each for σ, α, Tc and for where the motion turns between them"},
    ThresholdRow{"same_place", &Thresholds::same_place, "of X",
                 "samples of the loop that are closer are at the same place",
                 "the force then differs by a hundredth of σX at most"},
    ThresholdRow{"one_cycle", &Thresholds::one_cycle, "of the range",
                 "a record of two strokes that ends this near to its beginning, in both channels, "
                 "is a closed cycle",
                 "a step of 300 samples a cycle is as long, and noise of one per cent"},
    ThresholdRow{"starts_inside", &Thresholds::starts_inside, "of the range",
                 "a record that starts nearer to the end of its strokes has turned there",
                 "a virgin curve that is cut shorter shows no difference from a steady loop"},
    ThresholdRow{"starts_unloaded", &Thresholds::starts_unloaded, "of X",
                 "a contact unloaded this near to the first sample was unloaded before it",
                 "the end of a record counts as a turning point within the same distance"},
    ThresholdRow{"starts_without_force", &Thresholds::starts_without_force, "of half its range",
                 "a record without reversals whose first force is as small began at both zeros",
                 "noise of the first reading is less: a force that was cut off is more"},
    ThresholdRow{"hopeless_past", &Thresholds::hopeless_past, "sums of squares",
                 "an initial state that fits the thinned record worse by this factor is given up",
                 "a rms twice as large is n_eff·ln 4 of likelihood: more than the one parameter by "
                 "which they differ, however few samples the whole record adds"},
    ThresholdRow{"similar_misfit", &Thresholds::similar_misfit, "of the last rms",
                 "a fit that goes on from the last one and leaves more starts again from a scan",
                 "similar cycles leave the same noise: half as much again is another minimum"},
    ThresholdRow{"mobilised_by_asymptote", &Thresholds::mobilised_by_asymptote, "T* over Tc",
                 "a slip force of a loop that slides, and reaches less of it, ran away",
                 "a loop that slides has carried its slip force, but for the last of an asymptote"},
    ThresholdRow{"one_amplitude", &Thresholds::one_amplitude, "of the narrowest",
                 "strokes that are wider by less have the same amplitude",
                 "Masing's and Dahl's loops of the two amplitudes, with one σ and Tc, then differ "
                 "by less than 0.3 % of Tc"},
    ThresholdRow{
        "seen_loop", &Thresholds::seen_loop, "R²",
        "a loop that explains less of the force is not seen, and no parameter is given",
        "the rest of the force is three times the loop: if a tenth of it is regular, that is a "
        "third of the loop"},
    ThresholdRow{"load_difference", &Thresholds::load_difference, "of the smaller",
                 "records whose mean loads differ by more are a load series",
                 "Tc then differs by as much, which a fit of one Tc sees; σ by a third of it"},
    ThresholdRow{"load_variation", &Thresholds::load_variation, "of the mean",
                 "the law follows a load that varies by more: the amplitude of a sine with its "
                 "standard deviation, without the white noise of its readings",
                 "the force differs by as much where the contact slips"},
    ThresholdRow{
        "never_slips", &Thresholds::never_slips, "of Tc",
        "a steady loop that leaves more of the slip force unreached determines no asymmetry",
        "the part that never slips may bear any force between its limits, which moves the "
        "asymmetry by as much"},
    ThresholdRow{"prior_distance", &Thresholds::prior_distance, "standard deviations",
                 "a prior further from the estimate without it contradicts the records",
                 "a correct prior lies that far once in 370 fits"},
};

}  // namespace

std::span<const ThresholdRow> ThresholdTable() { return kTable; }

}  // namespace mindahl::identification
