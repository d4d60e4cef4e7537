# Each name of this chapter, once: what type checkers read and, at run time, what is loaded on first use.
from liepoisson.leaf.chart_orbit import chart_orbit as chart_orbit
from liepoisson.numeric.integrate import integrate as integrate
from liepoisson.numeric.time_scale import time_scale as time_scale
from liepoisson.orbits.connections import connecting_orbits as connecting_orbits
from liepoisson.orbits.guesses import periodic_orbit as periodic_orbit
from liepoisson.orbits.homoclinic import symmetric_homoclinic_orbits as symmetric_homoclinic_orbits
from liepoisson.orbits.invariant_manifolds import invariant_manifold as invariant_manifold
from liepoisson.orbits.level_orbits import periodic_orbits as periodic_orbits
from liepoisson.orbits.melnikov_integrals import melnikov as melnikov
from liepoisson.orbits.orbit_families import orbit_family as orbit_family
from liepoisson.orbits.symmetric_orbits import symmetric_periodic_orbits as symmetric_periodic_orbits
from liepoisson.rigid_body.frames import attitude as attitude
from liepoisson.rigid_body.rod import rod as rod
