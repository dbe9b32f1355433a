"""Runs for studies, in a module of their own so that they reach other processes by name."""

from __future__ import annotations

import os
import time
from pathlib import Path


def noisy_square(parameters, seed):
    """The metrics depend on every bit of what is planned."""
    x = parameters.get("x", 0.0)
    return {"square": x * x / 3.0, "seed": seed}


def fragile(parameters, seed):
    if parameters["x"] > 1.0:
        raise ArithmeticError(f"x = {parameters['x']} is too much")
    return {"x": parameters["x"]}


def logged(parameters, seed):
    """Leave a line for each call; take a moment."""
    with Path(parameters["log"]).open("a") as log:
        log.write(f"{parameters['x']}\n")
    time.sleep(0.05)
    return {"x": parameters["x"]}


class CountsItsArrivals:
    """Leaves a line with the process each time it is unpickled."""

    identity = "counts its arrivals"

    def __init__(self, log):
        self.log = log

    def __setstate__(self, state):
        self.__dict__ = state
        with Path(self.log).open("a") as log:
            log.write(f"{os.getpid()}\n")

    def __call__(self, parameters, seed):
        time.sleep(0.01)
        return {"process": os.getpid()}
