"""An observed spring and its law as one linear loop, against simulation of a cart on a spring."""

import warnings
from dataclasses import replace

import numpy as np
import pytest

import fotsmc_pin as fp
from fotsmc_pin.analysis import (
    BandwidthWarning,
    largest_bandwidth,
    margins,
    warn_of_soft_joints,
    with_bandwidth,
)
from fotsmc_pin.analysis.linearization import linearize
from fotsmc_pin.analysis.sampled_loop import closed_loop, is_stable
from fotsmc_pin.analysis.spring_loop import behind_springs
from fotsmc_pin.control import spring_model
from fotsmc_pin.errors import ArgumentError
from fotsmc_pin.references import Hold
from fotsmc_pin.simulation import TickDelay, simulate

DT = 1e-3
ROTOR, SWING = 0.2, 200.0
K = ROTOR * SWING**2
DAMPING = 2.0 * 0.02 * ROTOR * SWING
SLIDER = """<robot name="slider"><link name="base"/><link name="cart"><inertial><mass value="{}"/>
<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="x" type="prismatic"><parent link="base"/><child link="cart"/><axis xyz="1 0 0"/>
<limit lower="-10" upper="10" effort="1e9" velocity="1e9"/></joint></robot>"""


@pytest.fixture(scope="module")
def cart(tmp_path_factory):
    """A cart on a spring whose motor is a fifth of the whole, with other masses of the cart."""
    folder = tmp_path_factory.mktemp("cart")

    def load(ratio=1.0):
        path = folder / f"cart_{ratio:.9g}.urdf"
        path.write_text(SLIDER.format(ratio * (1.0 - ROTOR)))
        return fp.load_arm(path, armature=ROTOR)

    return load


def observed(arm, bandwidth=0.5, delay=1, encoder="link"):
    law = fp.RobustFONFTSM(
        arm, DT, bandwidth=bandwidth, integral=0.0, rotor_limit=0.0, floor_share=0.0
    )
    return fp.SpringObserver(law, K, encoder=encoder, joint_damping=DAMPING, delay=delay)


def swings(cart, ratio, delay, encoder):
    """Largest speed in the second and in the last quarter of a hold [m/s]."""
    true = fp.perturb(cart(ratio), joint_stiffness=K, joint_damping=DAMPING)
    arm = cart()
    rec = simulate(
        true,
        observed(arm, delay=delay, encoder=encoder),
        Hold(arm),
        4.0,
        q0=[1e-4 if encoder == "link" else 1e-2],  # a motor that hardly moves counts as standing
        substeps=10,
        encoder=encoder,
        actuator=TickDelay(delay),
    )
    v = np.abs(rec.v_motor)
    n = len(rec.t) // 4
    return v[n : 2 * n].max(), v[-n:].max()


@pytest.mark.parametrize("encoder", ["link", "motor"])
@pytest.mark.parametrize("delay", [1, 2])
def test_the_loop_is_lost_where_the_margins_say(cart, delay, encoder):
    found = margins(observed(cart(), delay=delay, encoder=encoder), delay)
    assert found.lowest < 0.7 < 2.0 < found.highest < 100.0
    earlier, last = swings(cart, 0.9 * found.highest, delay, encoder)
    assert last < earlier
    earlier, last = swings(cart, 1.1 * found.highest, delay, encoder)
    assert last > earlier


@pytest.mark.parametrize("swing", [141.0, 200.0, 447.0])
@pytest.mark.parametrize("share", [0.1, 0.2, 0.4])
def test_on_the_motors_it_bears_other_links_and_rotors_than_believed(tmp_path, share, swing):
    """A rotor of a tenth: the bare law meets it where it is fast, and feeds a soft spring's swing.

    Default bandwidth, springs of effort limit x 100 to 1000, rotors of limit / 200.
    """
    path = tmp_path / "cart.urdf"
    path.write_text(SLIDER.format(1.0 - share))
    arm = fp.load_arm(path, armature=share)
    law = fp.RobustFONFTSM(arm, DT, rotor_limit=0.0, floor_share=0.0)
    (bare,) = linearize(law)
    (loop,) = behind_springs(
        fp.SpringObserver(law, share * swing**2, encoder="motor"), [bare], None
    )

    def bears(law, link, rotor):
        own, behind = rotor * share, link * (1.0 - share)
        true = replace(loop.joint, mass=own + behind, rotor=own / (own + behind))
        return is_stable(law, true, 1)

    assert all(bears(loop, m, r) for m in (0.7, 1.0, 1.4, 2.0) for r in (1.0, 200.0 / 150.0))
    if share == 0.1:
        assert not bears(bare, 1.4, 1.0)


def test_with_the_right_model_errors_of_the_estimate_keep_their_rates(cart):
    """Law and observer separate: the closed loop has the designed rates among its own."""
    (law,) = linearize(observed(cart()))
    poles = np.linalg.eigvals(closed_loop(law, law.joint, 1))
    rates = spring_model.observer_rates(DT, ROTOR, K, DAMPING)
    for rate in rates:
        assert np.abs(poles - np.exp(rate * DT)).min() < 0.05 * np.abs(rate) * DT


def test_more_damping_of_the_estimate_would_cost_bandwidth(cart, monkeypatch):
    """Why the observer damps no more: links of another inertia enter by what damps."""
    arm = cart()
    (law,) = linearize(fp.RobustFONFTSM(arm, DT, bandwidth=0.8, rotor_limit=0.0, floor_share=0.0))

    def bears(damping):
        monkeypatch.setattr(spring_model, "SWING_DAMPING", damping)
        (loop,) = behind_springs(observed(arm), [law], None)
        return [is_stable(loop, loop.joint.loaded(m), 1) for m in (0.7, 1.0, 1.4, 2.0)]

    assert all(bears(0.15))
    assert not all(bears(1.0))


def test_the_observer_gives_back_most_of_the_bandwidth(cart):
    observer = observed(cart())
    edge = largest_bandwidth(observer)
    assert 0.7 < edge < 1.5
    assert not is_stable(*_loop(observer.law, observer), 1)
    with pytest.raises(ArgumentError, match="its own"):
        largest_bandwidth(observer, K)
    assert with_bandwidth(observer, 0.3).gains.bandwidth == 0.3


def _loop(law, observer):
    """The bare law on the observer's joint."""
    return linearize(law)[0], linearize(observer)[0].joint


def test_a_run_without_it_is_warned_of_and_one_with_it_is_not(cart):
    arm = cart()
    true = fp.perturb(arm, joint_stiffness=K, joint_damping=DAMPING)
    observer = observed(arm)
    with pytest.warns(BandwidthWarning, match="SpringObserver"):
        warn_of_soft_joints(observer.law, true, encoder="link")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warn_of_soft_joints(observer, true, encoder="link")
