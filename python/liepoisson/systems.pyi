# Each name of this chapter, once: what type checkers read and, at run time, what is loaded on first use.
from liepoisson.exact.canonical_system import CanonicalSystem as CanonicalSystem
from liepoisson.exact.describe import Report as Report
from liepoisson.exact.describe import inspect as inspect
from liepoisson.exact.discrete_symmetries import DiscreteSymmetry as DiscreteSymmetry
from liepoisson.exact.discrete_symmetries import discrete_symmetries as discrete_symmetries
from liepoisson.exact.phase_functions import PhaseFunction as PhaseFunction
from liepoisson.exact.system import System as System
from liepoisson.exact.system_file import Integral as Integral
from liepoisson.exact.system_file import Reference as Reference
from liepoisson.exact.system_file import SystemFile as SystemFile
from liepoisson.exact.system_file_reader import read_system as read_system
from liepoisson.exact.system_file_reader import read_system_file as read_system_file
from liepoisson.exact.system_text import write_system as write_system
from liepoisson.tops import Top as Top
