"""A handle that turns over and over: moments of inertia from a gyroscope, with their errors."""

import numpy as np

import liepoisson as lp

ENERGY = "dot(l, inv(I)*l)/2"
handle = lp.System(lp.so(3) @ lp.trivial(), ENERGY, {"I": [1, 2, 3]})
flight = lp.integrate(handle, [0.02, 2, 0.04], times=np.linspace(0, 30, 91))

# What the gyroscope says: angular velocities with errors of 0.05, and one channel that is silent for a while.
rates = flight.state[0] / [1, 2, 3] + 0.05 * np.random.default_rng(1).standard_normal((91, 3))
rates[26:34, 1] = np.nan
seen = lp.fits.Observations(
    {"t": flight.time, "l1/I1": rates[:, 0], "l2/I2": rates[:, 1], "l3/I3": rates[:, 2]}, errors=0.05
)

# A gyroscope tells ratios of moments: I1 is the unit.
guess = lp.System(lp.so(3) @ lp.trivial(), ENERGY, {"I": [1, "2.1", "3.1"]}, name="handle")
fit = lp.fits.orbit_fit(guess, seen, ["I2", "I3", "l"], starts=[0.02, 2, 0.04])
figure = lp.plot.orbit_fit(fit)
