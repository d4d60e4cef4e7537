"""Moments of inertia from a gyroscope that turns over.

A free body spins about its middle axis and turns over. Angular velocities with errors, of which one is not seen for a
while, give the ratios of the moments and the momenta at the start by least squares, with exact derivatives of the
orbit. Below are the residuals in units of the errors, with the band of two of them.

Read on: [fits to observed orbits](../fits-to-data.md), [tops](../tops.md).
"""

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
lp.plot.save_figure(figure, "fit", formats=["png"])
