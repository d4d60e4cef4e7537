# Each name of this chapter, once: what type checkers read and, at run time, what is loaded on first use.
from liepoisson.indicators.alignment import alignment as alignment
from liepoisson.indicators.exponents_by_energy import exponents_by_energy as exponents_by_energy
from liepoisson.indicators.finite_time_exponents import finite_time_exponents as finite_time_exponents
from liepoisson.indicators.lyapunov_exponent import lyapunov_exponent as lyapunov_exponent
from liepoisson.indicators.megno import megno as megno
from liepoisson.indicators.spectrum import lyapunov_spectrum as lyapunov_spectrum
from liepoisson.indicators.structural_zeros import PoissonStructure as PoissonStructure
from liepoisson.indicators.verdict import Rule as Rule
from liepoisson.indicators.verdict import agreement as agreement
from liepoisson.indicators.verdict import decide as decide
from liepoisson.tori.frequencies import frequency_drift as frequency_drift
