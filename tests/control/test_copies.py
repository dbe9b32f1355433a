"""A controller is an ordinary object: copies, pickles and saved states go on bit for bit."""

import copy
import pickle
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

import numpy as np
import pytest

from fotsmc_pin.arms import load_arm
from fotsmc_pin.control import (
    CONTROLLERS,
    AdaptiveFONFTSM,
    ComputedTorque,
    ExactDifferentiator,
    FilteredDifferentiator,
    FrictionCompensation,
    RobustFONFTSM,
    Safeguard,
    SoftStart,
)
from fotsmc_pin.errors import ArgumentError
from fotsmc_pin.fractional import FractionalDerivative, FractionalIntegral

BEFORE, AFTER = 120, 500

WAYS = {
    "copy": copy.copy,
    "deepcopy": copy.deepcopy,
    "pickle": lambda thing: pickle.loads(pickle.dumps(thing)),
}
EVERY_WAY = pytest.mark.parametrize("way", WAYS.values(), ids=WAYS)


def guarded(arm, law=RobustFONFTSM):
    friction = FrictionCompensation(arm, friction=0.2)
    return Safeguard(law(arm, 1e-3), torque_rate=500.0, friction_compensation=friction)


def arrays_of(thing, seen=None):
    """Every writable array that can be reached from an object, its arm left out."""
    seen = set() if seen is None else seen
    if id(thing) in seen or type(thing).__name__ in ("Arm", "type", "Dispatcher"):
        return []
    seen.add(id(thing))
    if isinstance(thing, np.ndarray):
        return [thing] if thing.flags.writeable else []
    if isinstance(thing, dict):
        parts = list(thing.values())
    elif isinstance(thing, (list, tuple, set, frozenset)):
        parts = list(thing)
    else:
        slots = [getattr(thing, name) for name in getattr(type(thing), "__slots__", ())]
        parts = [*getattr(thing, "__dict__", {}).values(), *slots]
    return [array for part in parts for array in arrays_of(part, seen)]


def assert_shares_nothing(one, other):
    mine, theirs = arrays_of(one), arrays_of(other)
    assert mine
    assert not any(np.shares_memory(a, b) for a in mine for b in theirs)


def assert_goes_on_alike(original, twin, rows):
    """Both take the same rows, in turns, and give the same bits and signals."""
    for row in rows:
        np.testing.assert_array_equal(original.update(*row), twin.update(*row))
    shown = twin.signals
    assert original.signals.keys() == shown.keys()
    for name, signal in original.signals.items():
        np.testing.assert_array_equal(signal, shown[name], err_msg=name)


def advanced(controller, arm, wander):
    """Run a controller into the middle of a motion; return the rows that come next."""
    rows = list(wander(arm, BEFORE + AFTER))
    for row in rows[:BEFORE]:
        controller.update(*row)
    return rows[BEFORE:]


@EVERY_WAY
def test_a_twin_of_any_law_goes_on_bit_for_bit(controller, arm, wander, way):
    rows = advanced(controller, arm, wander)
    twin = way(controller)
    assert_shares_nothing(controller, twin)
    assert_goes_on_alike(controller, twin, rows)


@EVERY_WAY
def test_a_twin_of_a_guarded_law_goes_on_bit_for_bit(arms, wander, way):
    arm = arms["panda"]
    controller = guarded(arm)
    rows = advanced(controller, arm, wander)
    twin = way(controller)
    assert_shares_nothing(controller, twin)
    assert_goes_on_alike(controller, twin, rows[:250])
    controller.stop()
    twin.stop()
    assert_goes_on_alike(controller, twin, rows[250:])


def test_what_happens_to_a_twin_does_not_happen_to_the_original(controller, another, arm, wander):
    untouched = another()
    for row in wander(arm, 30):
        controller.update(*row)
        untouched.update(*row)
    for way in WAYS.values():
        twin = way(controller)
        for row in wander(arm, 30, seed=5, spread=0.5):
            twin.update(*row)
        twin.reset()
    assert_goes_on_alike(untouched, controller, wander(arm, 30, seed=6))


def test_a_saved_state_goes_on_in_another_controller(controller, another, arm, wander):
    rows = advanced(controller, arm, wander)
    saved = controller.save_state()
    assert all(type(array) is np.ndarray and array.dtype == float for array in saved.values())
    resumed = another()
    resumed.restore_state(saved)
    for array in saved.values():  # what was given stays the giver's
        array[...] = -1.0
    assert_goes_on_alike(controller, resumed, rows)


def test_a_saved_state_of_a_guarded_law_survives_a_file(arms, wander, tmp_path):
    arm = arms["panda"]
    controller, resumed = guarded(arm), guarded(arm)
    rows = advanced(controller, arm, wander)
    controller.stop("a test")
    controller.update(*rows[0])
    np.savez(tmp_path / "state.npz", **controller.save_state())
    with np.load(tmp_path / "state.npz", allow_pickle=False) as saved:
        resumed.restore_state(dict(saved))
    assert resumed.stopped == "a test"
    assert_goes_on_alike(controller, resumed, rows[1:])


def test_a_state_that_does_not_fit_changes_nothing(controller, another, arm, wander):
    twin = another()
    rows = list(wander(arm, 40))
    for row in rows[:20]:
        controller.update(*row)
        twin.update(*row)
    good = controller.save_state()
    name = next(iter(good))
    for bad in (
        {key: value for key, value in good.items() if key != name},
        good | {"joints.unheard_of": np.zeros(arm.nv)},
        good | {name: np.zeros(arm.nv + 1)},
        good | {name: np.full(arm.nv, np.nan)},
    ):
        with pytest.raises(ArgumentError):
            controller.restore_state(bad)
    assert_goes_on_alike(controller, twin, rows[20:])


def run_on(controller, rows):
    return np.array([controller.update(*row) for row in rows])


def test_controllers_travel_into_worker_processes(arms, make, wander):
    arm = arms["two_link"]
    controllers = [make(law, arm) for law in CONTROLLERS.values()] + [guarded(arm)]
    rows = list(wander(arm, 60))
    for controller in controllers:
        run_on(controller, rows[:20])
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool:
        theirs = list(pool.map(run_on, controllers, [rows[20:]] * len(controllers)))
    for controller, torques in zip(controllers, theirs, strict=True):
        np.testing.assert_array_equal(torques, run_on(controller, rows[20:]))


class Numbered(AdaptiveFONFTSM):
    """A user's law that carries something of its own."""

    def __init__(self, arm, dt, number, **gains):
        super().__init__(arm, dt, **gains)
        self.numbers = [number]


@EVERY_WAY
def test_what_a_subclass_adds_travels_along(arms, make, wander, way):
    arm = arms["two_link"]
    original = Numbered(arm, 1e-3, 7, preset="practical")
    twin = way(original)
    assert type(twin) is Numbered
    assert twin.numbers == [7]
    twin.numbers.append(8)
    assert original.numbers == [7]
    assert_goes_on_alike(original, twin, wander(arm, 20))


@EVERY_WAY
@pytest.mark.parametrize("operator", [FractionalDerivative, FractionalIntegral])
@pytest.mark.parametrize("order", [0.0, 0.3, 1.0])
def test_a_twin_of_a_stream_goes_on_bit_for_bit(operator, order, way):
    stream = operator(order=order, dt=1e-3).stream(3)
    rng = np.random.default_rng(0)
    stream.update_many(rng.standard_normal((50, 3)))
    twin = way(stream)
    assert_shares_nothing(stream, twin)
    samples = rng.standard_normal((500, 3))
    np.testing.assert_array_equal(stream.update_many(samples), twin.update_many(samples))


@EVERY_WAY
@pytest.mark.parametrize("kind", [FilteredDifferentiator, ExactDifferentiator])
def test_a_twin_of_a_differentiator_goes_on_bit_for_bit(kind, way):
    arm = load_arm("kinova")
    rng = np.random.default_rng(0)
    path = [arm.integrate(arm.neutral, 0.01 * k * rng.uniform(0.9, 1.1, arm.nv)) for k in range(60)]
    original = kind(arm, 1e-3)
    for q in path[:30]:
        original.update(q)
    twin = way(original)
    assert_shares_nothing(original, twin)
    for q in path[30:]:
        np.testing.assert_array_equal(original.update(q), twin.update(q))


@EVERY_WAY
def test_a_twin_of_a_soft_start_goes_on_bit_for_bit(way):
    arm = load_arm("two_link")
    q, v, q_d = np.array([0.3, 0.2]), np.zeros(2), np.zeros(2)
    original = SoftStart(arm, 1.0)
    original.lead(q, v, q_d, v, v, 1e-3)
    twin = way(original)
    assert_shares_nothing(original, twin)
    for _ in range(50):
        for mine, theirs in zip(
            original.lead(q, v, q_d, v, v, 1e-3), twin.lead(q, v, q_d, v, v, 1e-3), strict=True
        ):
            np.testing.assert_array_equal(mine, theirs)


def test_a_law_that_was_copied_before_its_first_tick_works(arms, wander):
    arm = arms["two_link"]
    original = ComputedTorque(arm, 1e-3)
    for way in WAYS.values():
        assert_goes_on_alike(ComputedTorque(arm, 1e-3), way(original), wander(arm, 5))
