"""The minimax polynomials of src/elementary, by the exchange of Remez in 60 digits.

Each polynomial p stands in f(x) = lead(x) + factor(x)·p(x), where the factor is small: |p − wanted| is made least, the
coefficients are rounded to double precision, and the error of the whole is measured with the rounded ones.
"""
from mpmath import mp, mpf, matrix, lu_solve, log, cos, pi, polyval, sqrt

mp.dps = 60


def remez(f, low, high, count):
    """Coefficients, lowest first, of the polynomial with the least largest distance from f on [low, high]."""
    middle, half = (low + high) / 2, (high - low) / 2
    nodes = [middle - half * cos(pi * i / count) for i in range(count + 1)]
    grid = [middle - half * cos(pi * i / 1000) for i in range(1001)]
    wanted = [f(x) for x in grid]
    for _ in range(10):
        rows, right = matrix(count + 1, count + 1), matrix(count + 1, 1)
        for i, x in enumerate(nodes):
            for k in range(count):
                rows[i, k] = x ** k
            rows[i, count] = (-1) ** i
            right[i] = f(x)
        p = list(lu_solve(rows, right))[:count]
        errors = [polyval(p[::-1], x) - y for x, y in zip(grid, wanted)]
        extremes = []
        for x, e in zip(grid, errors):
            if not extremes or (extremes[-1][1] > 0) != (e > 0):
                extremes.append((x, e))
            elif abs(e) > abs(extremes[-1][1]):
                extremes[-1] = (x, e)
        assert len(extremes) == count + 1, "not as many extremes as the theorem of Chebyshev asks for"
        sizes = [abs(e) for _, e in extremes]
        nodes = [x for x, _ in extremes]
        if max(sizes) < min(sizes) * mpf("1.001"):
            break
    return p


def show(name, series, factor, low, high, count):
    """`series(n)` is the coefficient of xⁿ in what is approximated; `factor` is what multiplies it, relative to the result."""
    terms = [mpf(series(n)) for n in range(160)]
    wanted = lambda x: polyval(terms[::-1], x)
    found = [float(c) for c in remez(wanted, mpf(low), mpf(high), count)]
    grid = [low + (high - low) * (i + mpf(1) / 3) / 2000 for i in range(2000)]
    error = max(abs((polyval([mpf(c) for c in found[::-1]], x) - wanted(x)) * factor(x)) for x in grid)
    print(f"{name}: |error| < 2^{float(log(error, 2)):.1f} of the result, {low} to {high}")
    for c in found:
        print(f"    {c!r},")


show("(e^r - 1 - r - r^2/2)/r^3", lambda n: 1 / mp.factorial(n + 3), lambda r: abs(r) ** 3, -0.34659, 0.34659, 10)
MOST = float(((sqrt(2) - 1) / (sqrt(2) + 1)) ** 2) * 1.0000001
show("(2 artanh(s)/s - 2)/z", lambda n: mpf(2) / (2 * n + 3), lambda z: z / 2, 0, MOST, 7)
show("((2 artanh(s)/s - 2)/z - 2/3)/z", lambda n: mpf(2) / (2 * n + 5), lambda z: z * z / 2, 0, MOST, 8)
show("(arctan(t)/t - 1)/z", lambda n: mpf((-1) ** (n + 1)) / (2 * n + 3), lambda z: z, 0, 0.171573, 12)
ASIN = lambda n: mp.binomial(2 * n + 2, n + 1) / mpf(4) ** (n + 1) / (2 * n + 3)
show("(arcsin(s)/s - 1)/z", ASIN, lambda z: z, 0, 0.25, 13)
show("(sinh(x)/x - 1)/z", lambda n: 1 / mp.factorial(2 * n + 3), lambda z: z, 0, 1, 8)
TANH = lambda n: mpf(4) ** (n + 2) * (mpf(4) ** (n + 2) - 1) * mp.bernoulli(2 * n + 4) / mp.factorial(2 * n + 4)
show("(tanh(x)/x - 1)/z", TANH, lambda z: z, 0, 0.390626, 13)
show("(sin(r)/r - 1)/z", lambda n: mpf((-1) ** (n + 1)) / mp.factorial(2 * n + 3), lambda z: z, 0, 0.616851, 7)
show("(cos(r) - 1 + z/2)/z^2", lambda n: mpf((-1) ** n) / mp.factorial(2 * n + 4), lambda z: z * z, 0, 0.616851, 6)
