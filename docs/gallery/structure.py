r"""What a bracket looks like.

The Poisson tensors of three brackets of so(3), a square for each entry $J_{ij} = \{x_i, x_j\}$ in the colour of the
field that stands there. The extensions differ in few entries: the twist puts $\beta$ into $\{\alpha_i, \alpha_j\}$;
the bracket of compressible reduced magnetohydrodynamics puts $\psi$ into $\{v_i, p_j\}$. Below, the number of
independent Casimirs.

Read on: [brackets](../brackets.md#extensions); [extensions2000](../references.md), [hazeltine1985](../references.md).
"""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import ListedColormap

import liepoisson as lp

brackets = {
    "charged top": lp.so(3) @ lp.semidirect(3),
    "twisted top": lp.so(3) @ lp.leibniz(3),
    "reduced MHD": lp.so(3) @ lp.extensions.crmhd(1).rename("omega", "v", "p", "psi"),
}
SYMBOL = {"l": r"\ell", "alpha": r"\alpha", "beta": r"\beta", "omega": r"\omega", "psi": r"\psi"}
colours = ListedColormap(["white", "#d1571b", "#1668b8", "#0b8f5f", "#b8860b"])
with lp.plot.house_style():
    figure, axes = plt.subplots(1, 3, figsize=(6.4, 2.7))
    for ax, (title, bracket) in zip(axes, brackets.items(), strict=True):
        place = {variable: k // 3 + 1 for k, variable in enumerate(bracket.variables)}
        tensor, n = bracket.poisson_tensor(), bracket.dimension
        field = [[next((place[v] for v in tensor[i, j].free_symbols), 0) for j in range(n)] for i in range(n)]
        ax.pcolormesh(np.array(field), cmap=colours, vmin=-0.5, vmax=4.5, edgecolors="#e4e1d8", linewidth=0.4)
        names = [f"${SYMBOL.get(name, name)}$" for name in bracket.field_names]
        ax.set_xticks(np.arange(len(names)) * 3 + 1.5, names)
        ax.set_yticks(np.arange(len(names)) * 3 + 1.5, names)
        ax.set(title=title, xlabel=f"{bracket.corank()} Casimirs", aspect="equal", xlim=(0, n), ylim=(n, 0))
        ax.grid(visible=False)
figure.savefig("structure.png")
