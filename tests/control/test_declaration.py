"""What a law declares is checked, described, and pointed at where it is wrong."""

import re
import warnings
from dataclasses import dataclass, fields
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest

import fotsmc_pin as fp
from fotsmc_pin.control import (
    CONTROLLERS,
    FONFTSM,
    AdaptiveFONFTSM,
    GravityWarning,
    PaperConditionWarning,
    RobustFONFTSM,
)
from fotsmc_pin.control.law import Controller, Gains, NoRows, kernel, per_joint, rows
from fotsmc_pin.errors import DeclarationError

LAWS = list(CONTROLLERS.values())
EVERY_LAW = pytest.mark.parametrize("law", LAWS, ids=lambda law: law.__name__)


def described(cls):
    """The names under "Attributes:" of a docstring, in their order."""
    _, _, attributes = (cls.__doc__ or "").partition("Attributes:")
    return re.findall(r"^ {8}(\w+): \S", attributes, flags=re.MULTILINE)


@EVERY_LAW
def test_gains_are_described_in_their_order(law):
    """A base class' gains come first, as its fields do."""
    names = [
        name
        for cls in reversed(law.Gains.__mro__)
        if issubclass(cls, Gains) and cls is not Gains
        for name in described(cls)
    ]
    assert names == [field.name for field in fields(law.Gains)]


@EVERY_LAW
def test_a_state_of_several_rows_is_described_in_their_order(law):
    if len(law.State._fields) > 1:
        assert described(law.State) == [*law.State._fields]


@EVERY_LAW
def test_a_kernel_names_its_rows_and_takes_few_arguments(law):
    import inspect

    function = inspect.getattr_static(law, "tick").__func__.py_func
    assert len(inspect.signature(function).parameters) <= 9
    source = inspect.getsource(inspect.getmodule(law))
    assert not re.search(r"\b(gains|state|work|table|joints)\[\d", source)


@dataclass(frozen=True, kw_only=True, eq=False)
class SomeGains(Gains):
    k: np.ndarray = per_joint(1.0)


class SomeWork(NamedTuple):
    a: np.ndarray


def law_with(**declared):
    @kernel
    def tick(dt, table, M0, h0):
        x, g, _, w = rows(table, SomeGains, NoRows, SomeWork)
        for i in range(x.e.size):
            w.a[i] = g.k[i]
            x.tau[i] = w.a[i]

    parts = {"Gains": SomeGains, "Work": SomeWork, "tick": staticmethod(tick)} | declared
    return type("SomeLaw", (Controller,), parts)


class TestADeclaration:
    def test_that_fits_makes_a_law(self):
        law = law_with(signal_rows={"a": "a"})(fp.load_arm("two_link"), 1e-3, k=[2.0, 3.0])
        np.testing.assert_array_equal(law.update(*[np.zeros(2)] * 5), [2.0, 3.0])
        np.testing.assert_array_equal(law.signals["a"], [2.0, 3.0])

    @pytest.mark.parametrize(
        ("declared", "words"),
        [
            ({"signal_rows": {"s": "s"}}, r"signal_rows\['s'\].*the rows are a"),
            ({"signal_rows": {"s": ()}}, "name a row"),
            ({"Gains": dict}, "give a subclass of Gains"),
            ({"State": SomeWork}, "'a' is a row of State and of Work"),
            ({"streams": {"memory": None}}, r"give \(dt, table, M0, h0, memory, memory_memory\)"),
            ({"tick": lambda dt, table, M0, h0: None}, "staticmethod"),
        ],
    )
    def test_that_does_not_fit_is_refused_when_the_class_is_made(self, declared, words):
        with pytest.raises(DeclarationError, match=words):
            law_with(**declared)


class MyLaw(FONFTSM):
    """A user's law that is made like its parent."""


class MyConstructor(AdaptiveFONFTSM):
    """A user's law with a constructor of its own."""

    def __init__(self, arm):
        super().__init__(arm, 1e-3)


class TestAWarningPointsAtTheUsersLine:
    def lines(self, make):
        """Where the warnings of `make` point: file and line, the line of `make` first."""
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            make()
        assert caught
        return {(warning.filename, warning.lineno) for warning in caught}

    @pytest.mark.parametrize("law", [FONFTSM, AdaptiveFONFTSM, MyLaw], ids=lambda law: law.__name__)
    def test_of_the_papers_condition(self, law):
        arm = fp.load_arm("two_link")
        make = lambda: law(arm, 1e-3)  # noqa: E731
        assert self.lines(make) == {(__file__, make.__code__.co_firstlineno)}

    def test_with_a_constructor_of_ones_own(self):
        arm = fp.load_arm("two_link")
        make = lambda: MyConstructor(arm)  # noqa: E731
        assert self.lines(make) == {(__file__, make.__code__.co_firstlineno)}

    def test_of_gravity(self):
        arm = fp.load_arm("talos_arm")
        make = lambda: RobustFONFTSM(arm, 1e-3)  # noqa: E731
        assert self.lines(make) == {(__file__, make.__code__.co_firstlineno)}
        with pytest.warns(GravityWarning):
            make()

    def test_once_and_not_for_a_copy(self):
        import copy

        with pytest.warns(PaperConditionWarning) as caught:
            law = FONFTSM(fp.load_arm("two_link"), 1e-3)
        assert len(caught) == 1
        copy.deepcopy(law)


def test_an_arm_is_asked_for_by_name_of_the_argument():
    with pytest.raises(fp.errors.ArgumentError, match="arm = 'panda': give an arm"):
        RobustFONFTSM("panda", 1e-3)


def test_the_recipes_law_with_memory_is_short_and_private_to_nobody():
    """The page's code itself is run with all other pages."""
    page = (Path(__file__).parents[2] / "docs/recipes/new-controller.md").read_text("utf-8")
    blocks = re.findall(r"```python\n(.*?)```", page, flags=re.DOTALL)
    (recipe,) = [block for block in blocks if "class State" in block]
    lines = [line for line in recipe.splitlines() if line.strip()]
    assert len(lines) <= 40
    assert not re.search(r"(?<![\w])_(?!_)\w+|\._\w+", recipe)
