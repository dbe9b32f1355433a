"""What goes wrong in mid-run is named by its cause: the part, the time, the joint."""

import numpy as np
import pytest

import fotsmc_pin as fp
from fotsmc_pin.errors import ArgumentError, DivergenceError, MeasurementError
from fotsmc_pin.references import Hold
from fotsmc_pin.simulation import simulate

WHEN = 0.05


@pytest.fixture(scope="module")
def arm():
    return fp.load_arm("two_link")


def after(sound, broken):
    """What a part returns: sound at first, broken from `WHEN` on."""
    return lambda t, *rest: broken if t >= WHEN - 1e-9 else sound(t, *rest)


def run(arm, controller=None, reference=None, **options):
    controller = controller or fp.ComputedTorque(arm, 1e-3)
    return simulate(arm, controller, reference or Hold(arm), 0.2, **options)


NAN, SHORT = np.full(2, np.nan), np.zeros(1)


@pytest.mark.parametrize("broken", [NAN, SHORT, 0.0, "push", [np.inf, 0.0]])
@pytest.mark.parametrize("integrator", ["rk4", "semi-implicit"])
def test_a_disturbance(arm, broken, integrator):
    push = after(lambda t: np.zeros(2), broken)
    with pytest.raises(ArgumentError, match=r"^disturbance = .*at t = 0\.05") as caught:
        run(arm, disturbance=push, integrator=integrator)
    assert caught.value.argument == "disturbance"


@pytest.mark.parametrize(
    ("broken", "named"),
    [
        ((NAN, np.zeros(2)), "sensor q"),
        ((np.zeros(2), NAN), "sensor v"),
        ((np.zeros(2), SHORT), "sensor v"),
        (np.zeros(3), "sensor"),
        (None, "sensor"),
    ],
)
def test_a_sensor(arm, broken, named):
    with pytest.raises(MeasurementError, match=r"at t = 0\.05 s") as caught:
        run(arm, sensor=after(lambda t, q, v: (q, v), broken))
    assert caught.value.argument == named


@pytest.mark.parametrize(
    ("broken", "named"),
    [
        ((NAN, np.zeros(2), np.zeros(2)), "reference q_d"),
        ((np.zeros(2), np.zeros(2), NAN), "reference a_d"),
        ((np.zeros(2), SHORT, np.zeros(2)), "reference v_d"),
        ((np.zeros(2), np.zeros(2)), "reference"),
    ],
)
def test_a_reference(arm, broken, named):
    reference = after(Hold(arm), broken)
    with pytest.raises(MeasurementError, match=r"at t = 0\.05 s") as caught:
        run(arm, reference=reference)
    assert caught.value.argument == named


def test_a_reference_of_many_times_at_once(arm):
    class Bent(Hold):
        def at(self, t):
            q_d, v_d, a_d = super().at(t)
            return q_d[:, :1], v_d, a_d

    with pytest.raises(MeasurementError, match="reference q_d"):
        run(arm, reference=Bent(arm))


@pytest.mark.parametrize("broken", [NAN, SHORT * np.nan, np.zeros(3)])
def test_an_actuator(arm, broken):
    with pytest.raises(ArgumentError, match=r"actuator torque.*at t = 0\.05 s"):
        run(arm, actuator=after(lambda t, tau: tau, broken))


def test_a_controller_of_ones_own(arm, held):
    ticks = iter(range(1000))
    law = held(arm, 1e-3, lambda q, v: [0.0, np.nan if next(ticks) >= 50 else 0.0])
    with pytest.raises(ArgumentError, match=r"controller torque.*at t = 0\.05 s"):
        run(arm, law)


def test_an_error_of_a_part_itself_comes_through(arm):
    def broken(t, q, v):
        if t > WHEN:
            raise ValueError("the sensor's own words")
        return q, v

    with pytest.raises(ValueError, match="the sensor's own words"):
        run(arm, sensor=broken)


def test_a_safeguard_goes_on_without_the_reference(arm):
    """What a law bears, the simulation does not forbid."""
    guarded = fp.Safeguard(fp.RobustFONFTSM(arm, 1e-3))
    broken = (NAN, np.zeros(2), np.zeros(2))
    rec = run(arm, guarded, reference=after(Hold(arm), broken))
    assert guarded.stopped is not None
    assert np.isfinite(rec.q).all()


class TestDivergence:
    @pytest.mark.parametrize("joint", [0, 1])
    @pytest.mark.parametrize("substeps", [1, 2])
    def test_the_joint_that_left_first_is_named(self, arm, held, joint, substeps):
        """The runaway drags the other joint along, and both end in numbers without meaning."""
        arm = fp.load_arm("two_link", effort_limit=1e30)

        def runaway(q, v):
            tau = np.zeros(2)
            tau[joint] = 1e3 * v[joint] + 1.0
            return tau

        with pytest.raises(DivergenceError, match="left first, at t =") as caught:
            simulate(arm, held(arm, 1e-3, runaway), Hold(arm), 60.0, substeps=substeps)
        assert caught.value.joint == arm.joint_names[joint]

    def test_it_says_when(self, arm, held):
        arm = fp.load_arm("two_link", effort_limit=1e30, velocity_limit=1.0)
        law = held(arm, 1e-3, lambda q, v: [0.0, 300.0 * v[1] + 1.0])
        with pytest.raises(DivergenceError) as caught:
            simulate(arm, law, Hold(arm), 60.0)
        rec = caught.value.recording
        first = rec.t[np.flatnonzero(np.abs(rec.v).max(axis=1) > 10.0)[0]]
        assert f"left first, at t = {first:.4g} s" in str(caught.value)
        assert first < caught.value.time
