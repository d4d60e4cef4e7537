# Each name of this chapter, once: what type checkers read and, at run time, what is loaded on first use.
from liepoisson.integrability.certificates import certificate as certificate
from liepoisson.integrability.certificates import load_certificate as load_certificate
from liepoisson.integrability.certificates import save_certificate as save_certificate
from liepoisson.integrability.darboux import darboux_polynomials as darboux_polynomials
from liepoisson.integrability.families import integrable_families as integrable_families
from liepoisson.integrability.hamiltonian_forms import general_system as general_system
from liepoisson.integrability.integral_scan import scan_integrals as scan_integrals
from liepoisson.integrability.lax.families import lax_families as lax_families
from liepoisson.integrability.lax.known import known_lax_pair as known_lax_pair
from liepoisson.integrability.lax.pair import lax_pair as lax_pair
from liepoisson.integrability.lax.search import search_lax_pairs as search_lax_pairs
from liepoisson.integrability.painleve.singularity_analysis import painleve_test as painleve_test
from liepoisson.integrability.polynomial_integrals import first_integrals as first_integrals
from liepoisson.integrability.report import integrability_report as integrability_report
from liepoisson.integrability.saved_reports import load_report as load_report
