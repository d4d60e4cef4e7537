"""A charge in a magnetic bottle, and its guiding centre.

The field is twice as strong at z = 2 as at z = 0 and turns the charge back before it gets there. Grey is the full orbit
by the bracket of place and velocity, red the mean motion by Littlejohn's bracket in the place and the velocity along
the field, a system of four equations whose steps need not follow the gyration.

Read on: [Your bracket is not linear](../nonlinear-brackets.md).
"""

import matplotlib.pyplot as plt
import numpy as np

import liepoisson as lp

charge, x, v = 12, np.array([0.6, 0.0, 0.0]), np.array([0.7, 0.0, 0.4])
field = ["-x*z/4", "-y*z/4", "1 + z^2/4"]
full = lp.System(lp.brackets.magnetic(field, charge=charge), "(v_x^2 + v_y^2 + v_z^2)/2")
orbit = lp.integrate(full, [*x, *v], times=np.linspace(0, 40, 4001))

size = "sqrt((x*z/4)^2 + (y*z/4)^2 + (1 + z^2/4)^2)"  # |B|, which is 1 at the start, where B is along z
mean = lp.System(lp.brackets.guiding_centre(field, charge=charge), f"u^2/2 + mu*{size}", {"mu": "49/200"})
centre = lp.integrate(mean, [*(x + np.cross(v, [0, 0, 1]) / charge), v[2]], times=np.linspace(0, 40, 401))

with lp.plot.house_style():
    figure, (above, along) = plt.subplots(1, 2, figsize=(7.2, 3.4), layout="constrained")
    for run, colour, width in ((orbit, "#9aa0a6", 0.5), (centre, "#d1571b", 1.6)):
        above.plot(*run.state[0, :, :2].T, color=colour, lw=width)
        along.plot(run.time, run.state[0, :, 2], color=colour, lw=width)
    above.set(xlabel="$x$", ylabel="$y$", aspect="equal")
    along.set(xlabel="$t$", ylabel="$z$")
figure.savefig("magnetic-bottle.png")
