"""One task for every program that the fractional streams are compared with."""

from __future__ import annotations

import importlib
import time
from contextlib import suppress
from functools import partial
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from fotsmc_pin.fractional import FractionalDerivative
from tests.fractional.oracles import Wave, instants

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    Array: TypeAlias = NDArray[np.float64]

ORDER, DT, COUNT = 0.5, 1e-3, 10_000
T = np.arange(COUNT + 1) * DT
SINE = Wave(-1j, 1j)
FEW = 20


def stream(scheme: str) -> Array:
    one = FractionalDerivative(order=ORDER, dt=DT, scheme=scheme).stream(1)
    return np.array([one.update(x)[0] for x in np.sin(T)[:, None]])


def full_grunwald_letnikov() -> Array:
    x = np.sin(T)
    weights = np.cumprod(np.append(1.0, 1 - (ORDER + 1) / np.arange(1, COUNT + 1))) / DT**ORDER
    return np.array([weights[: n + 1] @ x[n::-1] for n in range(COUNT + 1)])


def oustaloup() -> Array:
    """21 poles between 1e-3 and 2e3 rad/s, Tustin's rule."""
    signal = importlib.import_module("scipy.signal")
    low, high, number = 1e-3, 2e3, 21
    places = (2 * np.arange(1, number + 1) - 1) / number
    zeros = low * (high / low) ** ((places - ORDER / number) / 2)
    poles = low * (high / low) ** ((places + ORDER / number) / 2)
    analog = -zeros, -poles, high**ORDER
    gain = np.abs(signal.freqs_zpk(*analog, [1.0])[1][0])
    digital = signal.bilinear_zpk(-zeros, -poles, high**ORDER / gain, 1 / DT)
    return signal.sosfilt(signal.zpk2sos(*digital), np.sin(T))


def pycaputo() -> Array:
    differentiation = importlib.import_module("pycaputo.differentiation")
    caputo = importlib.import_module("pycaputo.differentiation.caputo")
    grid = importlib.import_module("pycaputo.grid")
    points = grid.make_uniform_points(COUNT + 1, a=0.0, b=T[-1])
    return np.asarray(differentiation.diff(caputo.L1(alpha=ORDER), np.sin, points))


def differint() -> Array:
    module = importlib.import_module("differint.differint")
    return np.asarray(module.GL(ORDER, np.sin, 0.0, T[-1], COUNT + 1))


def numfracpy() -> Array:
    """At few instants: each evaluation sums over the whole history in Python."""
    module = importlib.import_module("numfracpy")
    values = np.full(COUNT + 1, np.nan)
    for n in np.linspace(COUNT / FEW, COUNT, FEW).astype(int):
        values[n] = module.Caputo_der1(np.sin, T[n] + 0.1 * DT, DT, ORDER)
    return values


def fracmem() -> Array:
    module = importlib.import_module("fracmem")
    rng = np.random.default_rng(0)
    training = [np.cumsum(rng.normal(size=3000)) * 0.01 for _ in range(8)]
    fitted = module.CompressedFractionalFilter(alpha=ORDER, h=DT, L=32, p=16)
    fitted.fit(training, j_max=COUNT)
    fitted.reset_stream()
    return np.array([fitted.step(x) for x in np.sin(T)])


PROGRAMS: list[tuple[str, str, Callable[[], Array], float]] = [
    ("this library, linear", "yes", partial(stream, "linear"), 1.0),
    ("this library, quadratic", "yes", partial(stream, "quadratic"), 1.0),
    ("this library, grunwald-letnikov", "yes", partial(stream, "grunwald-letnikov"), 1.0),
    ("full-history Grünwald-Letnikov, numpy", "cost grows", full_grunwald_letnikov, 1.0),
    ("Oustaloup filter, 21 poles, scipy", "yes", oustaloup, 1.0),
    ("pycaputo, L1", "no", pycaputo, 1.0),
    ("differint, GL", "no", differint, 1.0),
    (f"numfracpy, L1 (from {FEW} instants)", "no", numfracpy, COUNT / FEW),
    ("fracmem, 32 taps and 16 modes", "yes", fracmem, 1.0),
]

MODULES = (
    "scipy.signal",
    "pycaputo.differentiation.caputo",
    "differint.differint",
    "numfracpy",
    "fracmem",
)


def compare() -> list[list[str]]:
    """Return one row per program: name, whether it streams, time, max |err| / max |exact|."""
    chosen = instants(COUNT, FEW * 25)
    exact = SINE.derivative(ORDER, T[chosen])
    stream("linear")  # compiles
    for module in MODULES:
        with suppress(ImportError):
            importlib.import_module(module)
    rows = []
    for name, streams, program, share in PROGRAMS:
        start = time.perf_counter()
        try:
            values = np.ravel(program())
        except Exception as problem:
            rows.append([name, streams, "-", f"failed: {type(problem).__name__}: {problem}"])
            continue
        spent = (time.perf_counter() - start) * share
        if values.size < T.size:
            values = np.append(values, np.full(T.size - values.size, np.nan))
        error = np.nanmax(np.abs(values[chosen] - exact)) / np.max(np.abs(exact))
        rows.append([name, streams, f"{spent:.2g}", f"{error:.1e}"])
    return rows
