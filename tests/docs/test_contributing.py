"""What contributors are told: the commands exist, and the hooks check what the full check does."""

import importlib.util
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
TEXT = (ROOT / "CONTRIBUTING.md").read_text("utf-8")
PROJECT = (ROOT / "pyproject.toml").read_text("utf-8")
HOOKS = re.findall(r"^ +entry: (.+)$", (ROOT / ".pre-commit-config.yaml").read_text(), re.M)


@pytest.mark.parametrize("target", re.findall(r"\]\(([^)]+)\)", TEXT))
def test_a_link_leads_to_a_file(target):
    assert (ROOT / target).is_file()


def test_the_hooks_are_the_quick_checks_of_the_full_check():
    full = (ROOT / ".ci/run").read_text("utf-8").splitlines()
    quick = [line for line in full if re.match(r"\.venv/bin/(ruff|mypy)\b", line)]
    assert len(quick) == 3
    assert quick == HOOKS


def test_set_up_is_two_commands_with_extras_that_exist():
    block = re.search(r"## Set up\n+```sh\n(.*?)```", TEXT, re.S)[1].splitlines()
    assert len(block) == 2
    for extra in re.search(r'-e "\.\[([\w,]+)\]"', block[0])[1].split(","):
        assert re.search(rf"^{extra} = \[", PROJECT, re.M)
    assert "-c constraints.txt" in block[0]
    assert '"pre-commit>=' in PROJECT


@pytest.mark.parametrize("module", re.findall(r"python -m (tests[\w.]+)", TEXT))
def test_a_benchmark_is_there(module):
    assert importlib.util.find_spec(module) or (ROOT / module.replace(".", "/")).is_dir()


@pytest.mark.parametrize("folder", re.findall(r"(?<![\w/.])((?:tests|docs|examples)/\w*)", TEXT))
def test_a_folder_that_is_named_is_there(folder):
    assert list(ROOT.glob(f"{folder.rstrip('/')}*"))


@pytest.mark.parametrize("extra", ["benchmarks", "cluster", "peers"])
def test_an_extra_that_is_named_is_there(extra):
    assert f"`{extra}`" in TEXT
    assert re.search(rf"^{extra} = \[", PROJECT, re.M)
