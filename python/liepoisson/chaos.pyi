# Each name of this chapter, once: what type checkers read and, at run time, what is loaded on first use.
from liepoisson.numeric.alignment import alignment as alignment
from liepoisson.numeric.exponents_by_energy import exponents_by_energy as exponents_by_energy
from liepoisson.numeric.finite_time_exponents import finite_time_exponents as finite_time_exponents
from liepoisson.numeric.frequencies import frequency_drift as frequency_drift
from liepoisson.numeric.lyapunov_exponent import lyapunov_exponent as lyapunov_exponent
from liepoisson.numeric.megno import megno as megno
from liepoisson.numeric.spectrum import lyapunov_spectrum as lyapunov_spectrum
from liepoisson.numeric.structural_zeros import PoissonStructure as PoissonStructure
from liepoisson.numeric.verdict import Rule as Rule
from liepoisson.numeric.verdict import agreement as agreement
from liepoisson.numeric.verdict import decide as decide
