"""Accuracy and cost of the fractional streams: `python -m tests.benchmarks.fractional`.

Prints the tables of docs/fractional.md in Markdown. `python -m tests.benchmarks.fractional peers`
prints the comparison with other programs, which come with `pip install -e ".[peers]"`.
"""

from __future__ import annotations

import sys
import time
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from fotsmc_pin.compiled import kernel
from fotsmc_pin.files import markdown_table
from fotsmc_pin.fractional import FractionalDerivative, FractionalIntegral, advance, power_law_sum
from tests.benchmarks.fractional_peers import compare
from tests.fractional.oracles import FUNCTIONS, instants

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    from fotsmc_pin.fractional import Stream

ORDERS = (0.1, 0.5, 0.9)


def table(title: str, head: Sequence[str], rows: Iterable[Sequence[str]]) -> None:
    sys.stdout.write(f"\n{title}\n\n{markdown_table(head, rows, 'l' * len(head))}")
    sys.stdout.flush()


def least_seconds(calls: dict[object, Callable[[], object]], rounds: int) -> dict[object, float]:
    """Least time of each call: what the machine does when it does nothing else.

    All take turns in every round, so that a machine that is slow for some seconds slows none.
    """
    least = dict.fromkeys(calls, float("inf"))
    for _ in range(rounds):
        for name, call in calls.items():
            start = time.perf_counter()
            call()
            least[name] = min(least[name], time.perf_counter() - start)
    return least


def exponential_sums() -> None:
    rows = []
    for exponent in (0.01, 0.1, 0.5, 0.9, 0.99):
        row = [f"{exponent}"]
        for tolerance in (1e-4, 1e-8, 1e-11):
            build = power_law_sum.__wrapped__
            start = time.perf_counter()
            found = build(exponent, 1e-4, 1e3, tolerance)
            spent = time.perf_counter() - start
            row.append(f"{found.modes} modes, {found.certificate:.1e}, {1e3 * spent:.0f} ms")
        rows.append(row)
    table("Sums of exponentials over seven decades", ["exponent", "1e-4", "1e-8", "1e-11"], rows)


def accuracy() -> None:
    for kind in (FractionalDerivative, FractionalIntegral):
        rows = []
        for scheme in ("linear", "quadratic", "grunwald-letnikov"):
            for order in ORDERS:
                rows += [
                    [scheme, f"{order}", f"{dt:g}", *errors(kind, scheme, order, dt)]
                    for dt in (1e-3, 1e-4)
                ]
        table(
            f"{kind.__name__}: max |err| / max |exact| on (0, 10 s] (in brackets: from the third "
            "sample on)",
            ["scheme", "order", "dt", *FUNCTIONS],
            rows,
        )


def errors(kind: type, scheme: str, order: float, dt: float) -> list[str]:
    count = round(10 / dt)
    t = np.arange(count + 1) * dt
    chosen = instants(count, 200)
    row = []
    for function in FUNCTIONS.values():
        stream = kind(order=order, dt=dt, scheme=scheme).stream(1)
        values = stream.update_many(function(t)[:, None])[chosen, 0]
        law = function.derivative if kind is FractionalDerivative else function.integral
        exact = law(order, t[chosen])
        error = np.abs(values - exact) / np.max(np.abs(exact))
        later = f" ({error[1:].max():.1e})" if scheme == "quadratic" else ""
        row.append(f"{error.max():.1e}{later}")
    return row


def growth() -> None:
    """`sin 10t` over 1 000 s at 1 ms, whose derivative has a closed form in the long run."""
    rows = []
    for scheme in ("linear", "quadratic"):
        stream = FractionalDerivative(order=0.5, dt=1e-3, scheme=scheme).stream(1)
        row = [scheme]
        for start in range(0, 1000, 100):
            t = start + np.arange(100_000) * 1e-3
            values = stream.update_many(np.sin(10 * t)[:, None])[:, 0]
            error = np.abs(values - np.sqrt(10) * np.sin(10 * t + np.pi / 4))
            if start in (100, 500, 900):
                row.append(f"{error.max() / np.sqrt(10):.2e}")
        rows.append(row)
    table("No growth", ["scheme", "100-200 s", "500-600 s", "900-1000 s"], rows)


@kernel
def _many_ticks(coefficients, memory, x, dt, y, ticks):  # type: ignore[no-untyped-def]
    for i in range(ticks):
        x[i % x.size] = -x[i % x.size]
        advance(coefficients, memory, x, dt, y)


def cost() -> None:
    samples = np.random.default_rng(0).normal(size=(500, 7))
    x, y, ticks = samples[0].copy(), np.empty(7), 1000
    calls: dict[object, Callable[[], object]] = {}
    sizes = {}
    for scheme in ("linear", "quadratic", "grunwald-letnikov"):
        for order in ORDERS:
            young, old, inner = (
                FractionalDerivative(order=order, dt=1e-3, scheme=scheme).stream(7)
                for _ in range(3)
            )
            old.update_many(np.random.default_rng(1).normal(size=(10**6, 7)))
            sizes[scheme, order] = old.memory.size

            def updates(stream: Stream) -> None:
                stream.reset()
                for sample in samples:
                    stream.update(sample)

            def more_updates(stream: Stream) -> None:
                for sample in samples:
                    stream.update(sample)

            def loop(stream: Stream, dt: float) -> None:
                _many_ticks(stream.coefficients, stream.memory, x, dt, y, ticks)

            calls |= {
                (scheme, order, "young"): partial(updates, young),
                (scheme, order, "old"): partial(more_updates, old),
                (scheme, order, "inside"): partial(loop, inner, 1e-3),
                (scheme, order, "other dt"): partial(loop, inner, 1.1e-3),
            }
    least = least_seconds(calls, rounds=300)
    repeats = {"young": len(samples), "old": len(samples), "inside": ticks, "other dt": ticks}
    rows = [
        [
            scheme,
            f"{order}",
            *(f"{1e6 * least[scheme, order, kind] / n:.2f}" for kind, n in repeats.items()),
            str(size),
        ]
        for (scheme, order), size in sizes.items()
    ]
    head = ["scheme", "order", "update, first 500", "update, after 10⁶", "in compiled code"]
    table(
        "Cost of one update of R⁷ [µs]",
        [*head, "in compiled code, other dt", "floats of state"],
        rows,
    )


def peers() -> None:
    head = ["program", "streams", "10⁴ samples [s]", "error"]
    table("Derivative of order 0.5 of sin t, 10⁴ samples at 1 ms", head, compare())


if __name__ == "__main__":
    parts = {
        "sums": exponential_sums,
        "accuracy": accuracy,
        "growth": growth,
        "cost": cost,
        "peers": peers,
    }
    for part in sys.argv[1:] or ["sums", "accuracy", "growth", "cost"]:
        parts[part]()
