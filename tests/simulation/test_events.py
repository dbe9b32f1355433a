"""Events: the plant becomes another arm, and goes on from the state in which it was."""

import json

import numpy as np
import pytest

import fotsmc_pin as fp
from fotsmc_pin.arms import Payload
from fotsmc_pin.errors import ArgumentError
from fotsmc_pin.references import Hold
from fotsmc_pin.simulation import Recording, Wrench, simulate

WHEN = 0.1

CHANGES = {
    "payload": ({}, {"payload": 2.0}),
    "payload put down": ({"payload": 2.0}, {}),
    "friction comes": ({}, {"friction": 0.3, "damping": 0.1, "stiction": 1.5}),
    "friction goes": ({"friction": 0.3, "damping": 0.1}, {}),
    "rotors": ({"friction": 0.1}, {"friction": 0.1, "armature": 0.3}),
    "damping": ({"damping": 0.1}, {"damping": 0.5}),
}


def start(arm):
    rng = np.random.default_rng(5)
    q0 = arm.integrate(arm.neutral, rng.uniform(-0.5, 0.5, arm.nv))
    return {"q0": q0, "v0": rng.uniform(-1.0, 1.0, arm.nv)}


@pytest.mark.parametrize("integrator", ["rk4", "semi-implicit"])
@pytest.mark.parametrize("change", CHANGES)
@pytest.mark.parametrize("name", ["panda", "kinova"])
def test_after_an_event_it_is_the_run_that_begins_there(arms, held, name, change, integrator):
    bare = arms[name]
    before, after = (fp.perturb(bare, **done) if done else bare for done in CHANGES[change])
    torque = 0.02 * np.minimum(bare.effort_limit, 100.0)
    options = {"integrator": integrator, "substeps": 2}
    whole = simulate(
        before,
        held(bare, 1e-3, torque),
        Hold(bare),
        0.2,
        **start(bare),
        **options,
        events={WHEN: after},
    )
    k = round(WHEN / 1e-3)
    rest = simulate(
        after, held(bare, 1e-3, torque), Hold(bare), 0.1, q0=whole.q[k], v0=whole.v[k], **options
    )
    np.testing.assert_array_equal(whole.q[k:], rest.q)
    np.testing.assert_array_equal(whole.v[k:], rest.v)
    first = simulate(before, held(bare, 1e-3, torque), Hold(bare), WHEN, **start(bare), **options)
    np.testing.assert_array_equal(whole.q[: k + 1], first.q)


def test_position_and_velocity_have_no_step_and_the_acceleration_has(arms, held):
    arm = arms["panda"]
    loaded = fp.perturb(arm, payload=3.0)
    h = 1e-4
    torque = arm.gravity(arm.neutral)
    rec = simulate(
        arm, held(arm, h, torque), Hold(arm), 0.04, events={0.02: loaded}, v0=np.full(7, 0.3)
    )
    k = round(0.02 / h)
    a = np.diff(rec.v, axis=0) / h
    np.testing.assert_allclose(rec.q[k + 1] - rec.q[k], h * rec.v[k], atol=h * h * 100)
    state = rec.q[k], rec.v[k], torque
    np.testing.assert_allclose(a[k - 1], arm.forward_dynamics(*state), rtol=0.02, atol=0.02)
    np.testing.assert_allclose(a[k], loaded.forward_dynamics(*state), rtol=0.02, atol=0.02)
    assert np.abs(a[k] - a[k - 1]).max() > 1.0


@pytest.mark.parametrize("late", [0.0, -4e-4])
def test_it_changes_at_the_first_step_at_or_after_the_time(arms, held, late):
    """A step inside of a tick counts: 11 ms is the third of four steps of the second tick."""
    arm, loaded = arms["two_link"], fp.perturb(arms["two_link"], payload=2.0)
    torque = [5.0, 1.0]
    time = 11e-3 + late
    coarse = simulate(
        arm, held(arm, 4e-3, torque), Hold(arm), 0.04, substeps=4, events={time: loaded}
    )
    fine = simulate(arm, held(arm, 1e-3, torque), Hold(arm), 0.04, events={11e-3: loaded})
    np.testing.assert_allclose(coarse.q, fine.q[::4], rtol=0, atol=1e-15)
    never = simulate(arm, held(arm, 1e-3, torque), Hold(arm), 0.04)
    assert np.abs(fine.q - never.q).max() > 1e-4


@pytest.mark.parametrize("tick", [7, 43, 57, 86, 1001])
def test_times_that_are_no_binary_fractions_are_met_at_their_tick(arms, held, tick):
    """`0.001 * 1001` is a little less than 1.001."""
    arm = arms["two_link"]
    heavy = fp.perturb(arm, payload=20.0)
    time = float(f"{tick / 1000:.3f}")
    rec = simulate(
        arm,
        held(arm, 1e-3, arm.gravity([0.3, 0.3])),
        Hold(arm, [0.3, 0.3]),
        time + 0.01,
        events={time: heavy},
    )
    moved = np.flatnonzero(np.abs(rec.v).max(axis=1) > 1e-6)
    assert moved[0] == tick + 1


def test_the_last_of_several_events_holds(arms, held):
    arm = arms["two_link"]
    one, two = (fp.perturb(arm, payload=mass) for mass in (1.0, 2.0))
    events = {0.0303: two, 0.0301: one, 0.01: one, 0.02: arm}
    rec = simulate(arm, held(arm, 1e-3), Hold(arm), 0.1, events=events)
    assert [event.time for event in rec.events] == [0.01, 0.02, 0.0301, 0.0303]
    assert [event.words for event in rec.events] == [
        "payload 1 kg", "no payload", "payload 1 kg", "payload 2 kg"
    ]  # fmt: skip
    once = simulate(arm, held(arm, 1e-3), Hold(arm), 0.1, events={0.01: one, 0.02: arm, 0.031: two})
    np.testing.assert_array_equal(rec.q, once.q)


def test_springs_keep_their_deflection(held):
    arm = fp.perturb(fp.load_arm("panda"), joint_stiffness=2e4, armature=0.2, joint_damping=5.0)
    loaded = fp.perturb(arm, payload=4.0)
    still = held(arm, 1e-4, arm.gravity(arm.neutral))
    rec = simulate(arm, still, Hold(arm), 0.2, events={0.05: loaded})
    k, deflection = round(0.05 / 1e-4), rec.signals["deflection"]
    steps = np.abs(np.diff(deflection, axis=0)).max(axis=1)
    assert steps[:k].max() < 1e-9, "it rests before"
    stretched = np.abs(deflection[-1] - deflection[0]).max()
    assert stretched > 1e-4
    assert 0.0 < steps[k] < 0.01 * stretched, "and stretches from there"


def test_a_wrench_goes_on_over_an_event(arms, held):
    """Its frame is one that all arms have."""
    arm = fp.load_arm("two_link", gravity=(0.0, 0.0, 0.0))
    loaded = fp.perturb(arm, payload=3.0)
    force = np.array([3.0, 0.0, 5.0])
    push = Wrench(start=0.0, duration=1.0, force=force)
    rec = simulate(arm, held(arm, 1e-3), Hold(arm), 0.4, events={0.2: loaded}, disturbance=push)
    ends = [arm.tool_pose(rec.q[k]).translation for k in (200, -1)]
    energies = [0.5 * rec.v[k] @ loaded.mass_matrix(rec.q[k]) @ rec.v[k] for k in (200, -1)]
    assert energies[1] - energies[0] == pytest.approx(force @ (ends[1] - ends[0]), rel=1e-7)
    with pytest.raises(ArgumentError, match="no link of two_link has it"):
        at = Wrench(start=0.25, duration=0.1, force=force, frame="payload_1")
        simulate(arm, held(arm, 1e-3), Hold(arm), 0.4, events={0.2: loaded}, disturbance=at)


def test_a_controlled_arm_picks_something_up_and_puts_it_down():
    arm = fp.load_arm("panda")
    loaded = fp.perturb(arm, payload=2.0)
    law = fp.RobustFONFTSM(arm, dt=1e-3)
    rec = simulate(arm, law, Hold(arm), 1.5, events={0.3: loaded, 0.9: arm}, disturbance=None)
    norm = rec.error_norm
    assert norm[:300].max() < 1e-4 < norm[300:500].max() < 0.02
    assert norm[-1] < 1e-4
    held_up = rec.tau[890] - rec.tau[290]
    np.testing.assert_allclose(
        held_up, loaded.gravity(rec.q[890]) - arm.gravity(rec.q[890]), atol=0.2
    )


def test_saving_keeps_events_and_wrenches(arms, held, tmp_path):
    arm = arms["two_link"]
    loaded = fp.perturb(arm, payload=Payload(mass=2.0, com=(0.1, 0.0, 0.0)), friction=0.5)
    push = Wrench(start=0.02, duration=0.05, force=(1.0, 2.0, 3.0), axes="local", rise=0.01)
    rec = simulate(
        arm, held(arm, 1e-3), Hold(arm), 0.1, events={0.05: loaded, 0.08: arm}, disturbance=[push]
    )
    rec.save(tmp_path / "run.npz")
    back = Recording.load(tmp_path / "run.npz")
    assert back.events == rec.events
    assert back.wrenches == rec.wrenches == (push,)
    assert [e.words for e in back.events] == [
        "payload 2 kg; friction of all = 0.5", "no payload; no longer friction of all = 0.5"
    ]  # fmt: skip
    assert back.events[0].arm == loaded


def test_a_file_of_before_there_were_events_opens(arms, held, tmp_path):
    arm = arms["two_link"]
    simulate(arm, held(arm, 1e-3), Hold(arm), 0.01).save(tmp_path / "run.npz")
    with np.load(tmp_path / "run.npz") as file:
        members = dict(file)
    header = json.loads(str(members["header"]))
    assert header["format"] == 4
    assert header.pop("events") == header.pop("wrenches") == []
    members["header"] = np.array(json.dumps(header))
    np.savez(tmp_path / "old.npz", **members)
    old = Recording.load(tmp_path / "old.npz")
    assert (old.events, old.wrenches) == ((), ())


def test_a_run_that_stops_early_tells_only_what_came_to_pass(arms):
    arm = arms["two_link"]

    def broken(t):
        return np.full(2, 1e9 if t > 0.02 else 0.0)

    law = fp.ComputedTorque(arm, 1e-3)
    with pytest.raises(fp.errors.DivergenceError) as caught:
        simulate(
            arm, law, Hold(arm), 0.2, events={0.01: fp.perturb(arm, payload=1.0), 0.1: arm},
            disturbance=[broken, Wrench(start=0.1, duration=0.1)],
        )  # fmt: skip
    assert [event.time for event in caught.value.recording.events] == [0.01]
    assert caught.value.recording.wrenches == ()


def test_one_integrator_suits_all_arms(arms, held):
    arm = arms["two_link"]
    rough = fp.perturb(arm, friction=0.5)
    told = lambda **o: simulate(arm, held(arm, 1e-3), Hold(arm), 0.1, **o).metadata["integrator"]  # noqa: E731
    assert told() == told(events={0.05: fp.perturb(arm, payload=1.0)}) == "rk4"
    assert told(events={0.05: rough}) == "semi-implicit"
    springs = fp.perturb(arm, joint_stiffness=1e4, armature=0.1)
    with pytest.raises(ArgumentError, match="springs"):
        told(events={0.05: springs})
    stiff = fp.perturb(arm, damping=1e5)
    with pytest.raises(ArgumentError, match="substeps"):
        told(events={0.05: stiff}, integrator="rk4")


@pytest.mark.parametrize(
    ("events", "named", "remedy"),
    [
        (lambda arm: [(0.05, arm)], "events", "mapping"),
        (lambda arm: {0.05: 2.0}, "events[0.05]", "give an arm"),
        (lambda arm: {"soon": arm}, "time of events['soon']", "give a number"),
        (lambda arm: {float("nan"): arm}, "time of events[nan]", "finite"),
        (lambda arm: {0.0: arm}, "time of events[0.0]", "above 0"),
        (lambda arm: {0.1: arm}, "time of events[0.1]", "below the run's duration, 0.1 s"),
        (lambda arm: {0.05: fp.load_arm("panda")}, "events[0.05]", "joints are panda_joint1"),
        (
            lambda arm: {0.05: fp.load_arm("two_link", effort_limit=5.0)},
            "events[0.05]",
            "effort limit of joint1 is 5 and the plant's 1e[+]09",
        ),
        (
            lambda arm: {0.05: fp.perturb(arm, joint_stiffness={"joint2": 1e4}, armature=0.1)},
            "events[0.05]",
            "joint2 has a spring in one arm only",
        ),
    ],
)
def test_events_that_are_none(arms, held, events, named, remedy):
    arm = arms["two_link"]
    with pytest.raises(ArgumentError, match=remedy) as caught:
        simulate(arm, held(arm, 1e-3), Hold(arm), 0.1, events=events(arm))
    assert caught.value.argument == named
