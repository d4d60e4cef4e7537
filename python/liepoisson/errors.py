"""Every way in which liepoisson refuses a call.

A message says what was wanted, what came, and what to try.  A trajectory that fails is not an error but an
*outcome* in the result; see `liepoisson.numeric`.
"""

from __future__ import annotations


class LiePoissonError(Exception):
    """Base of all errors raised on purpose by liepoisson."""


class ShapeError(LiePoissonError, ValueError):
    """An array does not have the shape its docstring asks for."""


class ParameterError(LiePoissonError, ValueError):
    """A parameter has a value outside its domain (not finite, not positive, of the wrong sign, ...)."""


class UnknownNameError(LiePoissonError, LookupError):
    """A name (of an ensemble, a study, a system, a claim) that is not in the list of known names."""


class BracketError(LiePoissonError, ValueError):
    """Structure constants or an extension tensor that do not define a Lie-Poisson bracket."""


class UnsupportedFieldError(LiePoissonError):
    """The numeric core has no kernel for this vector field."""


class OutputError(LiePoissonError, OSError):
    """A result could not be written (path below a file, no permission, disk full)."""


class DamagedFileError(LiePoissonError, OSError):
    """A file is not what it should be: truncated, altered, or not written by liepoisson."""


class InertiaWarning(UserWarning):
    """Moments of inertia that no rigid body can have (triangle inequality); the equations do not need it."""
