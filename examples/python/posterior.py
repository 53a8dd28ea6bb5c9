"""Samples the posterior of sigma, alpha and Tc by emcee, and compares it with the profile intervals.

    posterior.py loop.csv [posterior.png]    one record: its posterior, with the intervals of the fit
    posterior.py --loops 20 [posterior.png]  so many simulated loops in partial slip: a table

Needs emcee, and matplotlib for the picture (Debian: python3-emcee, python3-matplotlib).
"""

import sys
import warnings

import emcee
import numpy as np

import mindahl

LAW = {"sigma": 5e7, "alpha": 1 / 3, "slip_force": 20.0}
WALKERS, STEPS, BURN_IN = 32, 1500, 500


def sample(result, seed, log_prior=lambda values: 0.0):
    """Draws from the posterior: flat in every parameter within the bounds of the fit, unless
    log_prior says more of a dict of values. With them, by columns, their names."""
    likelihood = result.log_likelihood()
    free = [result.parameters[name] for name in likelihood.names]
    values = np.array([parameter.value for parameter in free])
    spread = np.array([parameter.standard_error or 1e-3 * abs(parameter.value) for parameter in free])
    rng = np.random.default_rng(seed)
    start = values + 0.1 * spread * rng.standard_normal((WALKERS, len(spread)))

    def log_posterior(values):
        of_data = likelihood(values)
        if not np.isfinite(of_data):
            return -np.inf
        return of_data + log_prior(dict(zip(likelihood.names, values)))

    sampler = emcee.EnsembleSampler(WALKERS, len(spread), log_posterior)
    sampler.random_state = np.random.RandomState(seed).get_state()
    sampler.run_mcmc(start, STEPS)
    return sampler.get_chain(discard=BURN_IN, flat=True), likelihood.names


def compare(result, chain, names):
    """The 95 % interval of the fit and the central 95 % of the posterior, of each parameter."""
    for name in LAW:
        drawn = np.percentile(chain[:, names.index(name)], [2.5, 97.5])
        yield name, result.parameters[name].interval, drawn


def draw(result, chain, names, path):
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    figure, axes = pyplot.subplots(1, 2, figsize=(10, 4.5), layout="constrained")
    for ax, name in zip(axes, ("sigma", "slip_force")):
        first, second = (chain[::20, names.index(key)] for key in (name, "alpha"))
        ax.plot(first, second, ".", markersize=2, alpha=0.3, color="#4878a8", label="posterior")
        ax.axvspan(*result.parameters[name].interval, color="#d1495b", alpha=0.2,
                   label="interval of the fit")
        ax.set_xlabel(f"{name} [{result.parameters[name].unit}]")
        ax.set_ylabel("alpha [-]")
        ax.legend()
    figure.savefig(path, dpi=120)


def one_record(path, picture):
    result = mindahl.fit(path, terms="none")
    chain, names = sample(result, seed=1)
    for name, interval, drawn in compare(result, chain, names):
        print(f"{name:<12} fit {interval[0]:.5g} … {interval[1]:.5g}   "
              f"posterior {drawn[0]:.5g} … {drawn[1]:.5g}")
    if picture:
        draw(result, chain, names, picture)


def many_loops(count, picture):
    """Of each end: distance of the posterior's from the fit's, in half widths of the interval."""
    apart = {name: [] for name in LAW}
    ratio = {name: [] for name in LAW}
    for seed in range(1, count + 1):
        rng = np.random.default_rng(seed)
        _, displacement = mindahl.excitation("sine", amplitude=5.5e-7, cycles=3,
                                             samples_per_cycle=200)
        force = mindahl.simulate(displacement, **LAW)
        force = force + 0.01 * np.max(np.abs(force)) * rng.standard_normal(force.size)
        result = mindahl.fit(displacement, force, initial_state="virgin", displacement_noise=0.0,
                             terms="none")
        chain, names = sample(result, seed)
        for name, interval, drawn in compare(result, chain, names):
            if None in interval:
                continue
            half = (interval[1] - interval[0]) / 2
            apart[name].append(np.subtract(drawn, interval) / half)
            ratio[name].append((drawn[1] - drawn[0]) / (2 * half))
        if seed == count and picture:
            draw(result, chain, names, picture)
    print("parameter    loops  lower end        upper end        width over the interval's")
    for name in LAW:
        ends = np.array(apart[name])
        print(f"{name:<12} {len(ends):5}  {ends[:, 0].mean():+.3f} ± {ends[:, 0].std():.3f}   "
              f"{ends[:, 1].mean():+.3f} ± {ends[:, 1].std():.3f}   "
              f"{np.mean(ratio[name]):.3f} ± {np.std(ratio[name]):.3f}")


def main(arguments):
    warnings.simplefilter("ignore", mindahl.FitWarning)
    if arguments and arguments[0] == "--loops":
        many_loops(int(arguments[1]), arguments[2] if len(arguments) > 2 else None)
    else:
        one_record(arguments[0], arguments[1] if len(arguments) > 1 else None)


if __name__ == "__main__":
    main(sys.argv[1:])
