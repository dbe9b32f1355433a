"""Springs between motors and links: closed forms, energy, the rigid limit, who measures what."""

import numpy as np
import pinocchio as pin
import pytest

import fotsmc_pin as fp
from fotsmc_pin.arms import load_arm, perturb
from fotsmc_pin.errors import ArgumentError
from fotsmc_pin.references import Hold
from fotsmc_pin.simulation import Recording, dry_friction, simulate
from tests.simulation.gauss_seidel import speeds_with_friction

MASS, ROTOR = 2.0, 0.5


@pytest.fixture(scope="module")
def slider(tmp_path_factory):
    """A mass of 2 kg on a level rail, and a motor of 0.5 kg."""
    path = tmp_path_factory.mktemp("slider") / "slider.urdf"
    path.write_text(
        '<robot name="slider"><link name="rail"/><link name="mass"><inertial><mass value="2"/>'
        '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>'
        '<joint name="slide" type="prismatic"><parent link="rail"/><child link="mass"/>'
        '<axis xyz="1 0 0"/></joint></robot>'
    )
    return load_arm(path, armature=ROTOR)


@pytest.fixture(scope="module")
def soft_panda():
    """Springs as stiff as limit × 1000 per rad, on the raw links: the wrist rings at 5000 rad/s."""
    arm = load_arm("panda", armature="rotors", friction=0.0, damping=0.0)
    return perturb(arm, joint_stiffness=1000.0 * arm.effort_limit)


def stored(rec):
    """Energy of links, motors, springs and height of each row [J]."""
    arm = rec.arm
    model = arm.model.copy()
    model.armature = np.zeros(arm.nv)
    data = model.createData()
    twist, omega = rec.signals["deflection"], rec.signals["motor_speed"]
    rows = zip(rec.q, rec.v, strict=True)
    links = [
        pin.computeKineticEnergy(model, data, q, v) + pin.computePotentialEnergy(model, data, q)
        for q, v in rows
    ]
    return np.array(links) + 0.5 * (arm.armature * omega**2 + arm.joint_stiffness * twist**2).sum(1)


@pytest.mark.parametrize("stiffness", [1e2, 1e4, 1e6])
def test_two_masses_swing_as_the_closed_form_says(slider, held, stiffness):
    """A step of force on the motor: `δ = f / (B ω²) (1 - cos ωt)`, and the whole is a free mass."""
    arm, force, h = perturb(slider, joint_stiffness=stiffness), 3.0, 2.5e-4
    rec = simulate(arm, held(arm, 1e-3, force), Hold(arm), 0.5, substeps=4)
    omega = np.sqrt(stiffness * (1.0 / MASS + 1.0 / ROTOR))
    # The midpoint rule swings a little slower, as it is known to.
    seen = 2.0 / h * np.arctan(omega * h / 2.0)
    size = force / (ROTOR * omega**2)
    exact = size * (1.0 - np.cos(seen * rec.t))
    error = np.abs(rec.signals["deflection"][:, 0] - exact).max()
    assert error < 0.6 * omega * h * size, "half a step of phase, and no more"
    whole = MASS * rec.v[:, 0] + ROTOR * rec.v_motor[:, 0]
    np.testing.assert_allclose(whole, force * rec.t, atol=1e-9)


@pytest.mark.parametrize("stiffness", [1e3, 1e6, 1e9])
def test_a_spring_neither_adds_nor_takes_energy_in_the_long_run(slider, held, stiffness):
    """At the last of these `h ω` is 18: an explicit step would explode beyond 2."""
    arm = perturb(slider, joint_stiffness=stiffness)
    ticks = iter(range(100_000))
    kick = held(arm, 1e-3, lambda q, v: [50.0 if next(ticks) < 3 else 0.0])
    rec = simulate(arm, kick, Hold(arm), 20.0, substeps=2)
    energy = stored(rec)
    early, late = energy[100:3000].max(), energy[-2900:].max()
    assert late == pytest.approx(early, rel=1e-3)
    assert np.ptp(rec.signals["deflection"][-2900:]) == pytest.approx(
        np.ptp(rec.signals["deflection"][100:3000]), rel=1e-2
    )


def test_damping_takes_the_swing_as_the_closed_form_says(slider, held):
    stiffness, damping = 1e3, 2.0
    arm = perturb(slider, joint_stiffness=stiffness, joint_damping=damping)
    rec = simulate(arm, held(arm, 1e-3, 3.0), Hold(arm), 3.0, substeps=10)
    reduced = 1.0 / (1.0 / MASS + 1.0 / ROTOR)
    rate = damping / (2.0 * reduced)
    settled = 3.0 * MASS / (MASS + ROTOR) / stiffness
    swing = np.abs(rec.signals["deflection"][:, 0] - settled)
    # Its envelope falls by e^{-rate t}.
    one, two = swing[:500].max(), swing[1000:1500].max()
    assert two / one == pytest.approx(np.exp(-rate * 1.0), rel=0.05)


def test_an_arm_at_one_khz_keeps_its_energy_on_stiff_springs(soft_panda, held):
    rng = np.random.default_rng(5)
    q0 = soft_panda.integrate(soft_panda.neutral, rng.uniform(-0.5, 0.5, 7))
    rec = simulate(
        soft_panda,
        held(soft_panda, 1e-3),
        Hold(soft_panda),
        2.0,
        q0=q0,
        v0=rng.uniform(-1, 1, 7),
        substeps=2,
    )
    energy = stored(rec)
    heights = np.ptp(
        [pin.computePotentialEnergy(soft_panda.model, pin.Data(soft_panda.model), q) for q in rec.q]
    )
    assert rec.metadata["integrator"] == "semi-implicit"
    assert np.abs(energy - energy[0]).max() < 0.02 * heights


def test_stiff_springs_are_a_rigid_arm(held):
    rigid = load_arm("panda", armature="rotors", friction=0.2, damping=0.5)
    stiff = perturb(rigid, joint_stiffness=1e8)
    torque = 0.02 * rigid.effort_limit
    ends = [
        simulate(arm, held(arm, 1e-3, torque), Hold(arm), 0.5, substeps=4).q[-1]
        for arm in (rigid, stiff)
    ]
    moved = np.abs(ends[0] - rigid.neutral).max()
    assert np.abs(ends[1] - ends[0]).max() < 2e-3 * moved


def test_gravity_stretches_the_springs_by_its_torque_over_their_stiffness(soft_panda, held):
    """At rest from the first tick on, with the torque that holds the arm."""
    gravity = soft_panda.gravity(soft_panda.neutral)
    rec = simulate(soft_panda, held(soft_panda, 1e-3, gravity), Hold(soft_panda), 0.2)
    twist = gravity / soft_panda.joint_stiffness
    np.testing.assert_allclose(rec.signals["deflection"], np.tile(twist, (201, 1)), atol=1e-9)
    np.testing.assert_allclose(rec.e, 0.0, atol=1e-9)
    np.testing.assert_allclose(rec.e_motor, np.tile(twist, (201, 1)), atol=1e-9)


class TestFrictionIsTheMotors:
    def test_a_push_on_the_link_swings_on_a_resting_motor(self, slider, held):
        stiffness, force, h = 1e3, 2.0, 2.5e-4
        arm = perturb(slider, joint_stiffness=stiffness, friction=5.0)
        rec = simulate(
            arm,
            held(arm, 1e-3),
            Hold(arm),
            1.0,
            disturbance=lambda t: np.array([force]),
            substeps=4,
        )
        np.testing.assert_array_equal(rec.v_motor, 0.0)
        omega = 2.0 / h * np.arctan(np.sqrt(stiffness / MASS) * h / 2.0)
        exact = force / stiffness * (1.0 - np.cos(omega * rec.t))
        np.testing.assert_allclose(rec.q[:, 0], exact, atol=0.01 * force / stiffness)
        np.testing.assert_allclose(rec.q_motor, 0.0, atol=1e-12)

    def test_it_breaks_away_where_the_spring_pulls_hard_enough(self, slider, held):
        arm = perturb(slider, joint_stiffness=1e3, joint_damping=30.0, friction=5.0, stiction=1.5)
        for force, moves in ((7.3, False), (7.6, True)):
            rec = simulate(
                arm,
                held(arm, 1e-3),
                Hold(arm),
                4.0,
                # Faded in, so that the swing does not add to it.
                disturbance=lambda t, force=force: np.array([force * min(t / 3.0, 1.0)]),
                substeps=2,
            )
            assert rec.v_motor.any() == moves

    @pytest.mark.parametrize("h", [5e-4, 4e-3])
    def test_the_solver_gives_the_speeds_of_an_independent_one(self, h):
        """All joints of both kinds in one system of links and motors, friction on the motors."""
        arm = load_arm("panda", armature="rotors")
        elastic = np.array([1, 0, 1, 1, 0, 1, 1], dtype=bool)
        arm = perturb(
            arm,
            friction=np.linspace(0.0, 1.0, 7),
            damping=np.linspace(0.5, 0.0, 7),
            joint_stiffness=np.where(elastic, 50.0 * arm.effort_limit, np.inf),
            joint_damping=0.5,
        )
        n, rng = 7, np.random.default_rng(3)
        stiffness = np.where(elastic, arm.joint_stiffness, 0.0)
        rotors = np.where(elastic, arm.armature, 0.0)
        x, factor = np.zeros((dry_friction.TABLE_ROWS, n)), np.zeros((n, n))
        x[dry_friction.DAMPING], x[dry_friction.FRICTION] = arm.damping, arm.friction
        x[dry_friction.STICTION] = 1.0
        x[dry_friction.ROTOR], x[dry_friction.SPRING_DAMPING] = arm.armature, arm.joint_damping
        x[dry_friction.STIFFNESS] = stiffness
        rested = 0
        for size in np.tile([1.0, 0.1, 1e-2, 0.0], 20):
            q, v = arm.random_configuration(rng), size * rng.normal(size=n)
            omega = np.where(elastic, v + 0.3 * size * rng.normal(size=n), v)
            twist = np.where(elastic, 1e-2 * size * rng.normal(size=n), 0.0)
            mass = arm.mass_matrix(q) - np.diag(rotors)
            bias = arm.inverse_dynamics(q, v, np.zeros(n))
            torque = np.where(elastic, 0.0, bias) + rng.normal(size=n)
            push = np.where(elastic, bias, 0.0)

            kick = h * stiffness * twist - 0.25 * h * h * stiffness * (omega - v)
            coupling = np.where(elastic, h * arm.joint_damping + 0.25 * h * h * stiffness, 0.0)
            big = np.zeros((2 * n, 2 * n))
            big[:n, :n] = mass + np.diag(coupling)
            big[n:, n:] = np.diag(rotors + coupling) + np.diag(~elastic * 1.0)
            big[:n, n:] = big[n:, :n] = -np.diag(coupling)
            pushed = mass @ v + h * (push - bias) + kick + np.where(elastic, 0.0, h * torque)
            turned = rotors * omega + h * torque - kick
            free = np.linalg.solve(big, np.concatenate([pushed, np.where(elastic, turned, 0.0)]))
            on_links, on_motors = np.where(elastic, 0.0, 1.0), np.where(elastic, 1.0, 0.0)
            right = speeds_with_friction(
                h,
                big,
                free,
                np.concatenate([on_links * arm.friction, on_motors * arm.friction]),
                np.concatenate([on_links * arm.damping, on_motors * arm.damping]),
            )
            x[dry_friction.DEFLECTION], x[dry_friction.MOTOR_SPEED] = twist, omega
            dry_friction.slide(h, mass, bias, torque, push, v, factor, x)
            np.testing.assert_allclose(v, right[:n], atol=1e-10)
            motors = x[dry_friction.MOTOR_SPEED]
            np.testing.assert_allclose(motors[elastic], right[n:][elastic], atol=1e-10)
            np.testing.assert_allclose(
                x[dry_friction.DEFLECTION], twist + h * (motors - v) * elastic, atol=1e-15
            )
            rested += np.count_nonzero(motors == 0.0)
        assert rested > 20


class TestEncoders:
    @pytest.mark.parametrize("name", ["panda", "kinova"])
    @pytest.mark.parametrize("encoder", ["motor", "link"])
    def test_the_law_is_told_of_the_side_that_is_asked_for(self, held, name, encoder):
        arm = load_arm(name, armature="rotors")
        arm = perturb(arm, joint_stiffness=500.0)
        seen = []

        def look(q, v):
            seen.append((q.copy(), v.copy()))
            return np.ones(arm.nv)

        rec = simulate(arm, held(arm, 1e-3, look), Hold(arm), 0.1, encoder=encoder)
        for row, (q, v) in enumerate(seen):
            lead = arm.difference(rec.q[row], q)
            twist = rec.signals["deflection"][row] if encoder == "motor" else np.zeros(arm.nv)
            np.testing.assert_allclose(lead, twist, atol=1e-12)
            right = rec.v_motor if encoder == "motor" else rec.v
            np.testing.assert_array_equal(v, right[row])
        assert np.abs(rec.signals["deflection"]).max() > 1e-4
        assert rec.metadata["encoder"] == encoder

    def test_the_motors_are_in_the_recording_and_its_file(self, soft_panda, held, tmp_path):
        rec = simulate(soft_panda, held(soft_panda, 1e-3, 1.0), Hold(soft_panda), 0.1)
        rec.save(tmp_path / "run.npz")
        again = Recording.load(tmp_path / "run.npz")
        for what in ("q_motor", "v_motor", "e_motor"):
            np.testing.assert_array_equal(getattr(again, what), getattr(rec, what))
        np.testing.assert_allclose(rec.q_motor - rec.q, rec.e_motor - rec.e, atol=1e-15)
        np.testing.assert_array_equal(again.arm.joint_stiffness, soft_panda.joint_stiffness)

    def test_a_rigid_arm_has_one_side(self, held):
        arm = load_arm("two_link")
        rec = simulate(arm, held(arm, 1e-3), Hold(arm), 0.01, encoder="link")
        assert rec.q_motor is rec.q
        assert rec.v_motor is rec.v
        assert "deflection" not in rec.signals

    def test_another_side_is_refused(self, slider, held):
        with pytest.raises(ArgumentError, match="encoder"):
            simulate(slider, held(slider, 1e-3), Hold(slider), 0.01, encoder="both")


def test_a_joint_without_a_motor_is_named():
    with pytest.raises(ArgumentError, match=r"'panda_joint1' has no armature.*rotors"):
        perturb(load_arm("panda"), joint_stiffness=1e4)


def test_a_file_that_forgets_the_motor_is_refused_before_the_run(slider, held, tmp_path):
    path = tmp_path / "no_motor.urdf"
    path.write_text(slider.urdf.replace("</joint>", '<fotsmc_pin joint_stiffness="9"/></joint>', 1))
    arm = load_arm(path, armature=0.0)
    with pytest.raises(ArgumentError, match="'slide' has no armature"):
        simulate(arm, held(arm, 1e-3), Hold(arm), 0.01)


def test_rk4_is_refused(soft_panda, held):
    with pytest.raises(ArgumentError, match="springs"):
        simulate(soft_panda, held(soft_panda, 1e-3), Hold(soft_panda), 0.1, integrator="rk4")


def test_a_law_keeps_the_motors_where_it_is_told(soft_panda):
    """What a law can do with encoders on the motors: the links are off by the springs alone."""
    nominal = load_arm("panda", armature="rotors", friction=0.0, damping=0.0)
    rec = simulate(soft_panda, fp.ComputedTorque(nominal, 1e-3), Hold(nominal), 3.0, substeps=2)
    assert np.abs(rec.e_motor[-500:]).max() < 5e-4
    twist = nominal.gravity(nominal.neutral) / soft_panda.joint_stiffness
    np.testing.assert_allclose(rec.e[-1], rec.e_motor[-1] - twist, atol=2e-4)
