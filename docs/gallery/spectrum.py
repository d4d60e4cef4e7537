r"""The Lyapunov spectrum of one orbit.

Nine running exponents of an orbit of the twisted Kovalevskaya top. The bracket prescribes their structure: they come
in pairs $\pm\lambda$ (open circles are the mirror images), and five are zero, three for the Casimirs and two for the
energy and the flow. The band is $3\ln(t/T)/t$: what is inside is consistent with zero at that time.

Read on: [the spectrum and its check](../spectrum.md#the-spectrum-and-its-check); [benettin1980](../references.md).
"""

import liepoisson as lp

top = lp.Top.twisted_kovalevskaya()
start = lp.sample_states(top, 1, seed=5)
spectrum = lp.lyapunov_spectrum(top, start, t_end=8_000, transient=100, method=lp.Taylor(tol=1e-9))
figure = lp.plot.spectrum(spectrum)
figure.set_size_inches(6, 5)
figure.savefig("spectrum.png")
