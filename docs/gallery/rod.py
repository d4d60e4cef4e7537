"""An elastic rod with a current in a magnetic field.

Kirchhoff's analogy: with arclength for time a top is a thin rod, and the twisted Lagrange top is one that carries a
current. Left its shape; the stripe follows a director and shows the twist. Right curvature, twist and tension along
it; for equal bending stiffnesses the twist is constant.

Read on: [frames and rods](../frames.md#the-rod); [sinden2007](../references.md), [kirchhoff1859](../references.md).
"""

import liepoisson as lp

top = lp.Top.twisted_lagrange(transverse=1, axial="2/3", a3=1, epsilon=1)
start = [0.9, 0.2, 0.6, 0.5, 0, 0.3, 0, 0.3, 1]  # moment, force, field in the frame of the rod
rod = lp.orbits.rod(top, start, length=24, n_points=601, attitude="beta")
figure = lp.plot.rod(rod)
figure.savefig("rod.png")
