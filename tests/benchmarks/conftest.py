"""Tables of ratios, collected over the whole run, printed and stored at its end."""

from __future__ import annotations

import os
import platform
from importlib.metadata import version
from pathlib import Path

import pytest

from fotsmc_pin.files import markdown_table

OUT = Path(__file__).parents[2] / "test-output/benchmarks.md"
PACKAGES = ("fotsmc_pin", "pin", "numpy", "numba", "mujoco", "drake", "roboticstoolbox-python")
TABLES = pytest.StashKey[dict[str, list[list[str]]]]()


@pytest.fixture
def table(request):
    """Return a function that adds a row to the table of a title; the first row is the head."""
    tables = request.config.stash.setdefault(TABLES, {})

    def add(title, head, *rows):
        tables.setdefault(title, [head]).extend([str(cell) for cell in row] for row in rows)

    return add


def pytest_terminal_summary(terminalreporter, config):
    tables = config.stash.get(TABLES, {})
    if not tables:
        return
    text = machine() + "".join(markdown(title, rows) for title, rows in tables.items())
    OUT.parent.mkdir(exist_ok=True)
    OUT.write_text(text, "utf-8")
    terminalreporter.write(f"\n{text}\nwritten to {OUT}\n")


def markdown(title, rows):
    head, *body = rows
    return f"\n### {title}\n\n{markdown_table(head, body, 'l' + 'r' * (len(head) - 1))}"


def machine():
    cpu = platform.processor() or "unknown processor"
    info = Path("/proc/cpuinfo")
    if info.is_file():
        names = [
            line.split(":")[1].strip()
            for line in info.read_text().splitlines()
            if "model name" in line
        ]
        cpu = names[0] if names else cpu
    found = []
    for package in PACKAGES:
        try:
            found.append(f"{package} {version(package)}")
        except ModuleNotFoundError:
            found.append(f"{package} not installed")
    python = platform.python_version()
    return f"{cpu}, {os.cpu_count()} cores; Python {python}; {', '.join(found)}.\n"
