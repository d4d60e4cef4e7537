# Each name of this chapter, once: what type checkers read and, at run time, what is loaded on first use.
from liepoisson.indicators.estimates import Resampling as Resampling
from liepoisson.indicators.finite_time_fit import EnsembleReduction as EnsembleReduction
from liepoisson.indicators.finite_time_fit import finite_time_fit as finite_time_fit
from liepoisson.indicators.finite_time_fit import log_fit as log_fit
from liepoisson.indicators.finite_time_fit import mean_curve as mean_curve
from liepoisson.indicators.finite_time_fit import window_grid as window_grid
from liepoisson.indicators.finite_time_fit import window_scan as window_scan
from liepoisson.indicators.fit_goodness import fit_goodness as fit_goodness
from liepoisson.observations.observations import Observations as Observations
from liepoisson.observations.orbit_fit import orbit_fit as orbit_fit
