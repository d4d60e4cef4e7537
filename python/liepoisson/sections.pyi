# Each name of this chapter, once: what type checkers read and, at run time, what is loaded on first use.
from liepoisson.orbits.return_maps import return_map as return_map
from liepoisson.poincare.default_surface import default_surface as default_surface
from liepoisson.poincare.default_surface import good_surface as good_surface
from liepoisson.poincare.first_return import first_return as first_return
from liepoisson.poincare.section import section as section
from liepoisson.poincare.section_coordinates import is_folded as is_folded
from liepoisson.poincare.surfaces import section_starts as section_starts
from liepoisson.poincare.surfaces import section_state as section_state
