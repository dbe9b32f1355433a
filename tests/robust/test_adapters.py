"""Adapters call what the makers' libraries have: held against the installed libraries' signatures.

No connection is made: the classes that would are replaced by stand-ins, which allow a call only if
the real class has that method and its own signature takes the arguments.
"""

import inspect
import re
import sys

import numpy as np
import pytest

from fotsmc_pin.errors import ArgumentError, MissingDependencyError
from fotsmc_pin.realtime.robot import declared
from fotsmc_pin.realtime.robots import Franka, UniversalRobot
from fotsmc_pin.realtime.robots.ur import RobotError

TAU7, TAU6 = np.linspace(-3.0, 3.0, 7), np.linspace(-3.0, 3.0, 6)


def signature(method):
    """The signature that a pybind11 method states in its docstring."""
    text = re.sub(r'"[^"]*"|<[^>]*>', "None", method.__doc__.splitlines()[0])
    inside, _, returns = re.match(r"\w+\((.*)\)( -> (.*))?$", text).groups()
    names, depth, word = [], 0, ""
    for letter in inside + ",":
        depth += (letter in "[({") - (letter in "])}")
        if letter == "," and depth == 0:
            names.append(word.strip())
            word = ""
        else:
            word += letter
    kinds = inspect.Parameter
    parameters = []
    for name in names:
        head, _, default = name.partition(" = ")
        title, _, annotation = head.partition(": ")
        parameters.append(
            kinds(
                title,
                kinds.POSITIONAL_OR_KEYWORD,
                default=default or kinds.empty,
                annotation=annotation,
            )
        )
    return inspect.Signature(parameters, return_annotation=returns)


class StandIn:
    """An object of a class of the library, without a connection."""

    def __init__(self, real, answers, calls, missing=()):
        self._told = (real, answers, calls, missing)

    def __call__(self, *args, **words):
        """Construct: the real class must take the arguments."""
        real, _, calls, _ = self._told
        signature(real.__init__).bind(self, *args, **words)
        calls.append((real.__name__, args))
        return self

    def __getattr__(self, name):
        real, answers, calls, missing = self._told
        if name in missing:
            raise AttributeError(f"{real.__name__} has no {name}")
        found = getattr(real, name)  # An AttributeError where the library has renamed it.
        if isinstance(found, property):
            return answers[name]

        def call(*args, **words):
            if "Overloaded" not in found.__doc__:
                bound = signature(found).bind(self, *args, **words)
                for key, value in list(bound.arguments.items())[1:]:
                    if signature(found).parameters[key].annotation == "list[float]":
                        assert isinstance(value, list), key
                        assert all(isinstance(number, float) for number in value), key
            calls.append((name, args))
            return answers.get(name)

        return call


@pytest.fixture
def franka(monkeypatch):
    library = pytest.importorskip("pylibfranka", reason="NO PYLIBFRANKA: its adapter is not held")

    def make(missing=(), **options):
        calls = []
        numbers = {"q": [0.1] * 7, "dq": [0.2] * 7, "tau_J": [0.3] * 7}
        state = StandIn(library.RobotState, numbers, calls, missing)
        control = StandIn(library.ActiveControlBase, {"readOnce": (state, None)}, calls, missing)
        robot = StandIn(library.Robot, {"start_torque_control": control}, calls, missing)
        monkeypatch.setattr(library, "Robot", robot)
        return Franka("172.16.0.2", **options), calls

    # The stand-in must not be looked up as if it were the library's class.
    real = library.Robot
    yield make
    assert real is not None


@pytest.fixture
def ur(monkeypatch):
    control = pytest.importorskip("rtde_control", reason="NO UR_RTDE: its adapter is not held")
    receive = pytest.importorskip("rtde_receive")
    interfaces = (control.RTDEControlInterface, receive.RTDEReceiveInterface)

    def make(missing=(), taken=True, connected=True, **options):
        calls = []
        state = {"getActualQ": [0.1] * 6, "getActualQd": [0.2] * 6, "isConnected": connected}
        commands = StandIn(interfaces[0], {"directTorque": taken}, calls, missing)
        monkeypatch.setattr(control, "RTDEControlInterface", commands)
        readings = StandIn(interfaces[1], state, calls, missing)
        monkeypatch.setattr(receive, "RTDEReceiveInterface", readings)
        return UniversalRobot("192.168.0.2", **options), calls

    return make


def use(robot, tau):
    with robot:
        q, v = robot.read()
        robot.write(tau)
    return q, v


def test_franka_is_called_as_its_library_says(franka):
    robot, calls = franka(realtime=False, contact_torque=40.0, contact_force=60.0)
    q, v = use(robot, TAU7)
    np.testing.assert_array_equal(q, np.full(7, 0.1))
    np.testing.assert_array_equal(v, np.full(7, 0.2))
    np.testing.assert_array_equal(robot.read_torque(), np.full(7, 0.3))
    sent = dict(calls)["writeOnce"][0]
    np.testing.assert_allclose(sent.tau_J, TAU7)  # an object of the real library
    assert [name for name, _ in calls] == [
        "Robot",
        "set_collision_behavior",
        "start_torque_control",
        "readOnce",
        "writeOnce",
        "stop",
    ]
    assert declared(robot) == (("gravity", "friction"), True)


def test_franka_writes_what_the_library_takes_as_torques(franka):
    import pylibfranka

    franka()
    assert "franka::Torques" in pylibfranka.ActiveControlBase.writeOnce.__doc__
    with pytest.raises(TypeError):
        pylibfranka.Torques([0.0] * 6)


@pytest.mark.parametrize(
    "name",
    [
        "start_torque_control",
        "readOnce",
        "writeOnce",
        "q",
        "dq",
        "tau_J",
        "stop",
        "set_collision_behavior",
    ],
)
def test_a_name_that_franka_changes_is_noticed(franka, name):
    with pytest.raises(AttributeError, match=name):
        use(franka(missing={name}, contact_torque=40.0, contact_force=60.0)[0], TAU7)


def test_half_a_limit_of_contact_is_refused(franka):
    with pytest.raises(ArgumentError, match="contact_force"):
        franka(contact_torque=40.0)


@pytest.mark.parametrize("friction", [True, False])
def test_ur_is_called_as_its_library_says(ur, friction):
    robot, calls = ur(friction=friction)
    q, v = use(robot, TAU6)
    np.testing.assert_array_equal(q, np.full(6, 0.1))
    np.testing.assert_array_equal(v, np.full(6, 0.2))
    np.testing.assert_array_equal(dict(calls)["directTorque"][0], TAU6)
    assert [name for name, _ in calls] == [
        "RTDEReceiveInterface",
        "RTDEControlInterface",
        "isConnected",
        "getActualQ",
        "getActualQd",
        "directTorque",
        "stopScript",
        "disconnect",
        "disconnect",
    ]
    assert declared(robot) == (("gravity", "friction") if friction else ("gravity",), False)


@pytest.mark.parametrize(
    "name", ["directTorque", "getActualQ", "getActualQd", "isConnected", "stopScript", "disconnect"]
)
def test_a_name_that_ur_changes_is_noticed(ur, name):
    with pytest.raises(AttributeError, match=name):
        use(ur(missing={name})[0], TAU6)


def test_a_ur_that_refuses_or_is_silent_is_an_error(ur):
    with pytest.raises(RobotError, match="protective stop"):
        use(ur(taken=False)[0], TAU6)
    with pytest.raises(RobotError, match="network"):
        use(ur(connected=False)[0], TAU6)


def test_a_signature_is_read_as_it_is_stated():
    def method(): ...

    method.__doc__ = "move(self: a.B, torque: list[float], scale: list[float] = [0.9, 0.8]) -> bool"
    stated = signature(method)
    assert [*stated.parameters] == ["self", "torque", "scale"]
    assert stated.parameters["torque"].default is inspect.Parameter.empty
    with pytest.raises(TypeError):
        stated.bind(1)


def test_a_missing_library_is_told_with_its_remedy(monkeypatch):
    monkeypatch.setitem(sys.modules, "pylibfranka", None)
    monkeypatch.setitem(sys.modules, "rtde_control", None)
    with pytest.raises(MissingDependencyError, match="pip install pylibfranka"):
        Franka("nowhere")
    with pytest.raises(MissingDependencyError, match="pip install ur_rtde"):
        UniversalRobot("nowhere")
