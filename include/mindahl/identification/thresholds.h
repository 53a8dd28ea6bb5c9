#pragma once

namespace mindahl::identification {

/// Holds every number on which a verdict, a finding or the choice of a method depends: its unit,
/// what it decides, and why it is there; none that bounds a solver's work. A test notices when one
/// that a single result decides is changed by a factor of two.
struct Thresholds {
  /// [ΔAICc] Fits that differ by less are not distinguished. Evidence of e² to 1; by noise a
  /// superfluous parameter gains more with probability P(χ²₁ > 6) = 1.4 %.
  double indistinguishable = 4.0;
  /// [σ/k] A contact stiffer than this is taken as rigid. The contact then takes 3 % of the travel
  /// before slip: the loop is that of a Jenkins element, whatever α.
  double rigid_beside_rig = 30.0;
  /// [rms over half gap or T*] A smaller misfit may be noise however long that remembers, and does
  /// not speak against a slip force beyond the largest force. Two per cent show in a plot.
  double poor_misfit = 0.02;
  /// [missed over half gap or T*] A model that misses more is indicative, not quantitative.
  /// Repeated tests of one seal differ by as much.
  double quantitative_misfit = 0.05;
  /// [missed over half gap or T*] A model that misses more gives no parameters of the shape. Where
  /// the law carries half of Tc, an error of 0.15 is a third of the force: the knee is elsewhere.
  double failing_misfit = 0.15;
  /// [p] Residuals that repeat, and omitted terms, are not noise if white noise makes them less
  /// often. 23 terms are tried, so one loop in forty has a cause by chance.
  double rare_chance = 1e-3;
  /// [of the longest] Shorter strokes are not compared. They are nested loops, run-in or run-out.
  double main_stroke = 0.75;
  /// [upper over lower end] σ or Tc does not count as known if its 95 % interval is wider. A
  /// factor of three either way: the order of magnitude.
  double widest_ratio = 9.0;
  /// [max(α, 1)] α does not count as known if its 95 % interval is wider. 0 to 1 contains
  /// Jenkins', Mindlin's and Dahl's exponents alike.
  double widest_shape = 1.0;
  /// [2 ln Λ] A slip force of far_slip_force is not excluded if it costs less. Five standard
  /// errors: by the 95 % test one loop in twenty far from slip would pass for one that slips.
  double open_slip_force = 25.0;
  /// [of the largest force] A slip force that is not excluded here leaves the interval of Tc open.
  /// The loop is then that of an elastic contact, to a twentieth of its force.
  double far_slip_force = 20.0;
  /// [half interval of ln Tc] Above it the likelihood is profiled, not approximated by a parabola.
  /// exp(0.1) − 1 differs from 0.1 by a twentieth, and so do the ends of the interval.
  double parabola_error = 0.1;
  /// [T* over Tc] A loop that reaches less is always profiled, and if it slides its slip force ran
  /// away. Below it the parabola may miss the curved valley of α and Tc; a loop that slides has
  /// carried its slip force, but for the last of an asymptote.
  double mobilised = 0.9;
  /// [of the samples] A fit is assumed to absorb no more of autocorrelated noise. Beyond it the
  /// residuals no longer determine the noise: its variance is at most doubled.
  double most_absorbed = 0.5;
  /// [α] A smaller exponent at its bound is Jenkins'. The branches differ by less than 1 % of Tc.
  double jenkins_shape = 0.01;
  /// [p] Residuals less likely from noise are not noise. One adequate loop in 200 is doubted.
  double doubt = 0.005;
  /// [p] Intervals include what omitted terms would change if noise alone makes these less often.
  /// Between doubt and this chance the model stands, but the record does not rule them out.
  double omission_chance = 0.2;
  /// [rms over rms] Residuals larger than the noise by this factor are not noise, whatever the
  /// tests of omitted terms say; larger than the last fit's or another term's, they are of another
  /// minimum or a worse term. Noise is known to a few per cent: half as much again is more.
  double larger_rms = 1.5;
  /// [samples] Columns of omitted terms are looked for if so many samples pay for each. With fewer
  /// the columns together explain much of any noise.
  double samples_a_column = 8.0;
  /// [of what the best explains] Intervals also include causes, and alternatives to a term that is
  /// added, that explain at least this much; a simpler one is added first. Terms are tried to first
  /// order: the better of two imperfect models need not be the true one.
  double rival = 0.5;
  /// [p] The gain of a term that is added has no greater probability by chance, over all
  /// candidates of a round. One selection in twenty adds a term too many.
  double added_by_chance = 0.05;
  /// [of the rms] An added term reduces it by more. Three per cent of a misfit change no verdict.
  double worthwhile_gain = 0.03;
  /// [of the misfit] An advised term reduces it by more. Less cannot be seen in the loop.
  double advised_gain = 0.1;
  /// [mean square over the white part] Residuals that are less are nearly white: with a term that
  /// leaves no more, Tc may leave the half gap. A tenth of the rms is what the law still misses.
  double nearly_white = 1.2;
  /// [of its norm] A column whose part orthogonal to the law's is less is one of theirs. What is
  /// left of it is the law's own curvature, and would explain any misfit.
  double own_part = 0.02;
  /// [correlation] A covariate that correlates by more with the fitted force follows the contact.
  /// Its coefficient is then confounded with σ and Tc.
  double follows_contact = 0.3;
  /// [of the samples] A displacement that repeats its last reading more often may be held. Of
  /// every fifth reading that is held, noise is no explanation.
  double held_readings = 0.2;
  /// [strokes] A poor misfit whose residuals stay correlated for longer is not taken for noise. In
  /// half a stroke the force passes through the law: such noise looks like a misfit.
  double noise_memory = 0.5;
  /// [correlation] A poor misfit that correlates more from one stroke to the next of its direction
  /// is not taken for noise. Noise of so long a memory looks like a contact that changes.
  double carried_over = 0.3;
  /// [ΔAICc] Masing's law and Dahl's own are not distinguished if they differ by less. Evidence of
  /// e⁵ = 150 to 1: what either law misses of a real loop can be worth less.
  double undecided = 10.0;
  /// [places of the loop] If samples lie in fewer, σ and α are not identifiable. Four each
  /// for σ, α, Tc and for where the motion turns between them.
  double fewest_places = 16.0;
  /// [of X] Closer samples are at one place. The force differs by a hundredth of σX at most.
  double same_place = 0.01;
  /// [of the range] A record of two strokes that ends this near to its beginning, in both channels,
  /// is a closed cycle. A step of 300 samples a cycle is as long, as is noise of 1 %.
  double one_cycle = 0.02;
  /// [of the range] A record that starts nearer to the end of its strokes has turned there. A
  /// virgin curve that is cut shorter shows no difference from a steady loop.
  double starts_inside = 0.1;
  /// [of X] A record whose contact was unloaded this near to its first sample starts there. The end
  /// of a record counts as a turning point within the same distance.
  double starts_unloaded = 0.02;
  /// [of half its range] A record without reversals whose first force is as small began at both
  /// zeros. Noise of the first reading is less: a force that was cut off is more.
  double starts_without_force = 0.1;
  /// [sums of squares] An initial state that fits the thinned record worse by this factor is given
  /// up. A rms twice as large is n_eff·ln 4 of likelihood: more than the one parameter by which
  /// states differ, however few samples the whole record adds.
  double hopeless = 4.0;
  /// [of the narrowest] Strokes that are wider by less have the same amplitude. Masing's and
  /// Dahl's loops of the two amplitudes, with one σ and Tc, then differ by less than 0.3 % of Tc.
  double one_amplitude = 0.01;
  /// [of X] An encoder of larger steps shows no difference of laws, and calls for no term. Half a
  /// step is a fortieth of the stiff part of a loop, and the same in every stroke.
  double coarse_step = 0.05;
  /// [R²] A loop that explains less of the force is not seen, and no parameter is given. The rest
  /// is three times the loop: if a tenth of that is regular, it is a third of the loop.
  double seen_loop = 0.1;
  /// [of the load] Records whose mean loads differ by more are a load series, and the law follows
  /// a load that varies by more: the amplitude of a sine with its standard deviation, without the
  /// white noise of its readings. Tc differs by as much, which a fit of one Tc sees; σ by a third.
  double load_change = 0.01;
  /// [half gap] A slip force of one direction that is further from that direction's plateau is not
  /// reported. The asymmetry and the offset of the force then stand for each other.
  double off_plateau = 0.25;
  /// [half gap over half gap] Files that differ by more may be of different loads or tests.
  /// Repeated tests of one contact differ by less than a factor of two.
  double other_test = 2.0;
  /// [of Tc] A loop that leaves more of Tc unreached does not slip grossly: a steady one determines
  /// no asymmetry. What never slips may bear any force between its limits, which moves it as much.
  double never_slips = 0.01;
  /// [standard deviations] A prior further from the estimate without it contradicts the records. A
  /// correct prior lies that far once in 370 fits.
  double prior_distance = 3.0;
};

}  // namespace mindahl::identification
