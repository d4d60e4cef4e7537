# Each name of this chapter, once: what type checkers read and, at run time, what is loaded on first use.
from liepoisson.noise.first_passages import first_passages as first_passages
from liepoisson.noise.noisy_exponents import noisy_exponents as noisy_exponents
from liepoisson.noise.noisy_orbits import noisy_orbits as noisy_orbits
from liepoisson.noise.noisy_system import NoisySystem as NoisySystem
from liepoisson.noise.noisy_system import read_noisy_system as read_noisy_system
from liepoisson.noise.stationary_law import stationary_law as stationary_law
