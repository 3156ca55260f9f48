"""Writes table.txt: arguments that are hard for elementary functions, with the double nearest to the exact result.

Ends of ranges, places where formulas change, neighbours of multiples of pi/2, subnormal and overflowing results, and of
3,000 random arguments of each function those whose results lie closest to the middle between two doubles.
"""
import math
import random
from mpmath import mp, mpf

mp.prec = 240
random.seed(1)
up, down = lambda x: math.nextafter(x, math.inf), lambda x: math.nextafter(x, -math.inf)


def around(*places):
    return [y for x in places for y in (down(x), x, up(x))]


def both(places):
    return [s * x for x in places for s in (1.0, -1.0)]


def spread(low, high):
    """±2^u with u between two ends."""
    return random.choice((1, -1)) * 2 ** random.uniform(low, high)


TINY = [5e-324, 1e-310, 2.2250738585072014e-308, 1e-200, 1e-20, 1e-8]
LN_2 = math.log(2)
# Nearest to multiples of pi/2 among the doubles below 10^6.
NEAR = [45.553093477052, 91.106186954104, 1457.698991265664, 2915.397982531328, 321307.9594422229]
NEAR += [math.pi, math.pi / 2, 3 * math.pi / 2, 1e3 * math.pi, 10000.5 * math.pi, 636619 * math.pi / 2]
ANGLES = both(TINY + around(math.pi / 4, 3 * math.pi / 4) + NEAR + [1e5, 999999.0, 1e6])
UNIT = both(TINY + around(0.5) + [0.25, 0.75, 0.9999, down(1.0), 1.0])

FUNCTIONS = {
    "exp": (mp.exp, lambda: random.uniform(-745, 709), both(TINY) + around(709.782712893384, -708.3964185322641)
            + [-745.1332191019411, -745.14, -740.0, 710.0] + around(*[(k + 0.5) * LN_2 for k in (-1, 0, 1, 900)])),
    "ln": (mp.log, lambda: 2 ** random.uniform(-2, 2), TINY + around(1.0, math.sqrt(0.5), math.sqrt(2), 2.0)
           + [1 - 1e-8, 1 + 1e-8, 1e300, 1.7976931348623157e308]),
    "sin": (mp.sin, lambda: random.uniform(-1e3, 1e3), ANGLES),
    "cos": (mp.cos, lambda: random.uniform(-1e3, 1e3), ANGLES),
    "tan": (mp.tan, lambda: random.uniform(-1e3, 1e3), ANGLES),
    "asin": (mp.asin, lambda: random.uniform(-1, 1), UNIT),
    "acos": (mp.acos, lambda: random.uniform(-1, 1), UNIT),
    "atan": (mp.atan, lambda: spread(-3, 3), both(TINY + around(math.tan(math.pi / 8), 1.0, math.tan(3 * math.pi / 8))
             + [2.0 ** 60, 1e300])),
    "sinh": (mp.sinh, lambda: random.uniform(-5, 5), both(TINY + around(1.0, LN_2 / 2) + [20.0, 700.0, 710.4758600739439])),
    "cosh": (mp.cosh, lambda: random.uniform(-5, 5), both(TINY + around(1.0, LN_2 / 2) + [20.0, 700.0, 710.4758600739439])),
    "tanh": (mp.tanh, lambda: random.uniform(-2, 2), both(TINY + around(0.625, LN_2 / 4) + [1.0, 18.0, 22.0, 800.0])),
    "atanh": (mp.atanh, lambda: random.uniform(-1, 1), both(TINY + around(0.171) + [0.5, 0.999, down(1.0)])),
    "pow": (mp.power, lambda: (2 ** random.uniform(-3, 3), random.uniform(-200, 200)), [
        (2.0, 0.5), (2.0, -1074.0), (2.0, -1075.0), (2.0, 1023.0), (3.0, 2.0), (3.0, 33.0), (10.0, 22.0), (10.0, 308.0), (10.0, -308.0),
        (10.0, -320.0), (5e-324, 0.5), (5e-324, 1.0), (1e-310, -0.99), (1.7976931348623157e308, 1.0), (1.7976931348623157e308, -1.0),
        (up(1.0), 1e18), (down(1.0), 1e18), (up(1.0), -3.2e18), (1 + 1e-9, 7e11), (0.5, 1e-300), (7.0, 5e-324), (1.5, 1750.0),
        (0.7, -1990.0), (-2.0, 3.0), (-2.0, 4.0), (-1.1, 7001.0), (-3.0, -5.0), (math.e, 709.0), (math.sqrt(2), 2.0), (1e-5, 1 / 3)]),
    "atan2": (mp.atan2, lambda: (spread(-2, 2), spread(-2, 2)), [(s * y, t * x) for s in (1, -1) for t in (1, -1) for y, x in [
        (1.0, 1.0), (1.0, up(1.0)), (1e-300, 1e-300), (1e300, 1e-300), (3e-310, 1e-310), (5e-324, 5e-324), (1e308, 1.7e308),
        (1e-20, 1.0), (1.0, 1e-20), (0.4142135623730951, 1.0), (2.414213562373095, 1.0), (1e-160, 1e160)]]),
}


def nearest(value):
    """The double nearest to a number, halves to even; subnormal ones too."""
    if value == 0:
        return 0.0
    _, exponent = mp.frexp(value)
    lowest = max(exponent - 53, -1074)
    scaled = mp.nint(mp.ldexp(value, -lowest))
    try:
        return math.ldexp(int(scaled), lowest)
    except OverflowError:
        return math.copysign(math.inf, value)


def from_middle(value):
    """How far from the middle between two doubles, in their distance."""
    _, exponent = mp.frexp(value)
    part = mp.frac(abs(mp.ldexp(value, 53 - exponent)))
    return abs(part - mpf(1) / 2)


def main():
    lines = []
    for name, (exact, argument, edges) in FUNCTIONS.items():
        tuples = lambda x: x if isinstance(x, tuple) else (x,)
        value = lambda x: exact(*map(mpf, tuples(x)))
        candidates = sorted((argument() for _ in range(3000)), key=lambda x: from_middle(value(x)))
        for x in edges + candidates[:8]:
            lines.append(" ".join([name, *map(repr, tuples(x)), repr(nearest(value(x)))]))
    with open("table.txt", "w") as file:
        file.write("\n".join(lines) + "\n")


main()
