"""The time derivative of plain data by the definition of the field, in plain Python."""

import math

import numpy as np

from liepoisson.compile.field import QuadraticField, TopField

FUNCTIONS = {
    "sqrt": math.sqrt,
    "exp": math.exp,
    "log": math.log,
    "sin": math.sin,
    "cos": math.cos,
    "sinh": math.sinh,
    "cosh": math.cosh,
    "tanh": math.tanh,
    "asin": math.asin,
    "acos": math.acos,
    "atan": math.atan,
}


def derivative(field, x):
    """The time derivative at one state."""
    if isinstance(field, TopField):
        inertia, a, b = (np.array(v) for v in (field.inertia, field.a, field.b))
        l, alpha, beta = x[:3], x[3:6], x[6:]
        omega = l / inertia
        dl = np.cross(l, omega) + np.cross(alpha, a) + np.cross(beta, b)
        return np.concatenate([dl, np.cross(alpha, omega) + field.epsilon * np.cross(beta, a), np.cross(beta, omega)])
    result = np.zeros(field.n_components)
    if isinstance(field, QuadraticField):
        for i, c in field.constant:
            result[i] += c
        for i, j, c in field.linear:
            result[i] += c * x[j]
        for i, j, k, c in field.quadratic:
            result[i] += c * x[j] * x[k]
        return result
    registers = list(x)
    for name, read, numbers in field.instructions:
        values = [registers[r] for r in read]
        if name == "linear":
            registers.append(sum((c * v for c, v in zip(numbers[:-1], values, strict=True)), numbers[-1]))
        elif name == "product":
            registers.append(values[0] * values[1])
        elif name == "quotient":
            registers.append(values[0] / values[1])
        elif name == "power":
            registers.append(values[0] ** numbers[0])
        else:
            registers.append(FUNCTIONS[name](values[0]))
    return np.array([registers[output] for output in field.outputs])
