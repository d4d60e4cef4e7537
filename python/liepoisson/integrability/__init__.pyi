# Each name of this chapter, once: what type checkers read and, at run time, what is loaded on first use.
from liepoisson.integrability.certificates import certificate as certificate
from liepoisson.integrability.certificates import load_certificate as load_certificate
from liepoisson.integrability.certificates import save_certificate as save_certificate
from liepoisson.integrability.darboux import darboux_polynomials as darboux_polynomials
from liepoisson.integrability.families import integrable_families as integrable_families
from liepoisson.integrability.galois.linear_systems import linear_system as linear_system
from liepoisson.integrability.galois.monodromy import monodromy as monodromy
from liepoisson.integrability.galois.obstruction import galois_obstruction as galois_obstruction
from liepoisson.integrability.galois.solutions import particular_solution as particular_solution
from liepoisson.integrability.galois.solutions import particular_solutions as particular_solutions
from liepoisson.integrability.galois.variational import variational_equations as variational_equations
from liepoisson.integrability.hamiltonian_forms import general_system as general_system
from liepoisson.integrability.integral_scan import scan_integrals as scan_integrals
from liepoisson.integrability.polynomial_integrals import first_integrals as first_integrals
from liepoisson.integrability.report import integrability_report as integrability_report
from liepoisson.integrability.saved_reports import load_report as load_report
