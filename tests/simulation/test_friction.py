"""Friction in the plant: the solver's answer, breakaway, Stribeck's curve, and what it takes."""

import mujoco
import numpy as np
import pytest

from fotsmc_pin.arms import load_arm, perturb
from fotsmc_pin.errors import ArgumentError, UrdfError
from fotsmc_pin.references import Hold
from fotsmc_pin.simulation import dry_friction, simulate
from tests.simulation.gauss_seidel import speeds_with_friction

MASS, COULOMB, RATIO, STRIBECK = 2.0, 3.0, 1.5, 0.05


@pytest.fixture(scope="module")
def slider(tmp_path_factory):
    """A mass of 2 kg on a level rail."""
    path = tmp_path_factory.mktemp("slider") / "slider.urdf"
    path.write_text(
        '<robot name="slider"><link name="rail"/><link name="mass"><inertial><mass value="2"/>'
        '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>'
        '<joint name="slide" type="prismatic"><parent link="rail"/><child link="mass"/>'
        '<axis xyz="1 0 0"/></joint></robot>'
    )
    return load_arm(path)


@pytest.fixture(scope="module")
def rough(slider):
    return perturb(slider, friction=COULOMB, stiction=RATIO, stribeck_velocity=STRIBECK)


def table(arm, v):
    rows = np.zeros((dry_friction.TABLE_ROWS, arm.nv))
    rows[dry_friction.DAMPING], rows[dry_friction.FRICTION] = arm.damping, arm.friction
    rows[dry_friction.STICTION], rows[dry_friction.STRIBECK] = arm.stiction, arm.stribeck_velocity
    rows[dry_friction.MOTOR_SPEED], rows[dry_friction.SLIDES] = v, np.sign(v)
    return rows


class TestSolver:
    """Random states of real arms, from wild motion to rest, one table through all of them."""

    @pytest.fixture(params=["panda", "so100", "ur10", "xarm7"])
    def arm(self, request):
        arm = load_arm(request.param)
        n = arm.nv
        return perturb(arm, friction=np.linspace(0.0, 1.0, n), damping=np.linspace(0.5, 0.0, n))

    @pytest.mark.parametrize("h", [5e-4, 4e-3])
    def test_it_gives_the_speeds_of_an_independent_solver(self, arm, h):
        rng = np.random.default_rng(3)
        x, factor = table(arm, np.zeros(arm.nv)), np.zeros((arm.nv, arm.nv))
        rested = slid = 0
        for size in np.tile([2.0, 0.1, 1e-2, 1e-3, 0.0], 30):
            q = arm.random_configuration(rng)
            v = size * rng.normal(size=arm.nv)
            mass, bias = arm.mass_matrix(q), arm.inverse_dynamics(q, v, np.zeros(arm.nv))
            torque = bias + 0.6 * rng.normal(size=arm.nv)
            free = v + h * np.linalg.solve(mass, torque - bias)
            right = speeds_with_friction(h, mass, free, arm.friction, arm.damping)
            dry_friction.slide(h, mass, bias, torque, np.zeros(arm.nv), v, factor, x)
            np.testing.assert_allclose(v, right, atol=1e-11, rtol=1e-9)
            rested += np.count_nonzero(v == 0.0)
            slid += np.count_nonzero(v)
        assert min(rested, slid) > 50, "both kinds were seen"

    @pytest.mark.parametrize("h", [5e-4, 2e-2])
    def test_friction_opposes_and_holds_as_coulomb_says(self, arm, h):
        """These are the conditions of the solution, which is unique, to rounding."""
        rng = np.random.default_rng(4)
        x, factor = table(arm, np.zeros(arm.nv)), np.zeros((arm.nv, arm.nv))
        for size in np.tile([1.0, 1e-2, 0.0], 60):
            q, v0 = arm.random_configuration(rng), size * rng.normal(size=arm.nv)
            mass, bias = arm.mass_matrix(q), arm.inverse_dynamics(q, v0, np.zeros(arm.nv))
            torque, v = bias + 0.6 * rng.normal(size=arm.nv), v0.copy()
            dry_friction.slide(h, mass, bias, torque, np.zeros(arm.nv), v, factor, x)
            impulse = mass @ (v - v0) - h * (torque - bias) + h * arm.damping * v
            slides, bound = v != 0.0, h * arm.friction
            np.testing.assert_allclose(impulse[slides], -(bound * np.sign(v))[slides], atol=1e-12)
            assert np.all(np.abs(impulse[~slides]) <= bound[~slides] + 1e-12)


class TestBreakaway:
    def moved(self, arm, held, force, integrator=None):
        rec = simulate(
            arm, held(arm, 1e-3, force), Hold(arm), 0.5, integrator=integrator, substeps=2
        )
        return rec.q[-1, 0]

    def test_a_resting_joint_holds_up_to_its_breakaway_force(self, rough, held):
        assert self.moved(rough, held, RATIO * COULOMB * 0.999) == 0.0
        assert self.moved(rough, held, RATIO * COULOMB * 1.01) > 2e-3

    def test_without_stiction_it_holds_up_to_coulomb_friction(self, slider, held):
        arm = perturb(slider, friction=COULOMB)
        assert self.moved(arm, held, COULOMB * 0.999) == 0.0
        assert self.moved(arm, held, COULOMB * 1.001) > 1e-4

    def test_a_joint_that_slides_is_kept_sliding_by_less(self, rough, held):
        force = 1.2 * COULOMB
        arm = rough
        rec = simulate(arm, held(arm, 1e-3, force), Hold(arm), 1.0, v0=[0.2], substeps=2)
        assert rec.v[-1, 0] > 0.2
        assert self.moved(arm, held, force) == 0.0

    def test_rk4_creeps_where_the_other_sticks(self, rough, held):
        crept = self.moved(rough, held, 1.2 * COULOMB, integrator="rk4")
        assert 0.0 < crept < 1e-3
        assert self.moved(rough, held, 1.6 * COULOMB, integrator="rk4") > 0.05


@pytest.mark.parametrize("integrator", ["semi-implicit", "rk4"])
def test_the_speed_follows_stribecks_curve(rough, held, integrator):
    """`m v̇ = f - F(v)`, integrated with 10⁻⁶ s steps from a speed beyond the narrow zero of rk4."""
    force, v, h = 5.0, 0.02, 1e-6
    exact = []
    for step in range(300_001):
        if step % 1000 == 0:
            exact.append(v)
        friction = COULOMB * (1.0 + (RATIO - 1.0) * np.exp(-((v / STRIBECK) ** 2)))
        v += h * (force - friction) / MASS
    rec = simulate(
        rough,
        held(rough, 1e-3, force),
        Hold(rough),
        0.3,
        v0=[0.02],
        integrator=integrator,
        substeps=4,
    )
    tolerance = 1e-6 if integrator == "rk4" else 2e-4
    np.testing.assert_allclose(rec.v[:, 0], exact, atol=tolerance)


def test_a_pull_on_a_spring_sticks_and_slips_only_with_breakaway(slider, held):
    """The field's picture of stick-slip: a slow pull over a soft spring."""

    def rests(stiction):
        arm = perturb(slider, friction=COULOMB, stiction=stiction, damping=2.0)
        time = iter(np.arange(0.0, 100.0, 1e-3))
        pull = held(arm, 1e-3, lambda q, v: [300.0 * (0.05 * next(time) - q[0])])
        rec = simulate(arm, pull, Hold(arm), 10.0)
        still = rec.v[:, 0] == 0.0
        return np.count_nonzero(np.diff(still.astype(int)) == 1)

    assert rests(1.5) >= 5
    assert rests(1.0) <= 1


@pytest.mark.parametrize("integrator", ["semi-implicit", "rk4"])
def test_friction_with_breakaway_takes_energy_and_never_gives(arm, held, integrator):
    still = perturb(arm, friction=0.2, stiction=2.0, stribeck_velocity=0.3)
    rng = np.random.default_rng(5)
    start = {
        "q0": arm.integrate(arm.neutral, rng.uniform(-0.5, 0.5, arm.nv)),
        "v0": rng.uniform(-1.0, 1.0, arm.nv),
    }
    weightless = load_weightless(still)
    rec = simulate(
        weightless,
        held(still, 1e-3),
        Hold(still),
        0.5,
        **start,
        integrator=integrator,
        substeps=4,
    )
    kinetic = [0.5 * v @ still.mass_matrix(q) @ v for q, v in zip(rec.q, rec.v, strict=True)]
    assert np.diff(kinetic).max() < (1e-9 if integrator == "rk4" else 2e-3) * kinetic[0]
    assert kinetic[-1] < 0.95 * kinetic[0]


def load_weightless(arm):
    """The arm without gravity: its energy is its motion's alone."""
    arm = perturb(arm)
    arm.model.gravity.linear = np.zeros(3)
    return arm


def test_mujoco_slides_and_stops_the_same_way(slider, held):
    """Coulomb friction alone, which MuJoCo knows as a constraint that is nearly rigid."""
    arm = perturb(slider, friction=COULOMB)
    xml = (
        '<mujoco><option timestep="0.0002" gravity="0 0 0"/><worldbody><body>'
        '<inertial mass="2" pos="0 0 0" diaginertia="1 1 1"/>'
        f'<joint type="slide" axis="1 0 0" frictionloss="{COULOMB}" solreffriction="0.001 1" '
        'solimpfriction="0.9999 0.9999 0.001"/></body></worldbody></mujoco>'
    )
    model = mujoco.MjModel.from_xml_string(xml)
    data = mujoco.MjData(model)
    data.qvel[:] = 0.4
    rec = simulate(arm, held(arm, 1e-3), Hold(arm), 0.5, v0=[0.4], substeps=5)
    theirs = []
    for step in range(2501):
        if step % 5 == 0:
            theirs.append(float(data.qvel[0]))
        mujoco.mj_step(model, data)
    np.testing.assert_allclose(rec.v[:, 0], theirs, atol=2e-3)
    stopped = 0.4 * MASS / COULOMB
    assert rec.t[rec.v[:, 0] == 0.0][0] == pytest.approx(stopped, abs=2e-3)
    assert rec.q[-1, 0] == pytest.approx(0.4**2 * MASS / (2 * COULOMB), abs=1e-4)


class TestFile:
    def test_breakaway_and_springs_come_back_from_the_written_file(self, tmp_path):
        true = perturb(
            load_arm("ur5", armature="rotors"),
            friction=0.5,
            stiction={"wrist_*": 1.5},
            stribeck_velocity=0.1,
            joint_stiffness=1e4,
            joint_damping={"elbow_joint": 2.0},
        )
        again = load_arm(true.write_urdf(tmp_path / "true.urdf"))
        for what in ("stiction", "stribeck_velocity", "joint_stiffness", "joint_damping"):
            np.testing.assert_array_equal(getattr(true, what), getattr(again, what))
        np.testing.assert_array_equal(again.stiction, [1, 1, 1, 1.5, 1.5, 1.5])
        assert "stiction of wrist_1_joint = 1.5" in true.changes

    def test_a_change_to_nothing_takes_the_tag_out(self):
        arm = perturb(load_arm("ur5"), stiction=1.5)
        assert perturb(arm, stiction=1.0).urdf.count("stiction=") == 0
        assert load_arm("ur5").stiction.max() == 1.0

    @pytest.mark.parametrize(
        ("tag", "words"),
        [
            ('stiction="0.5"', "stiction 0.5 is not a finite number of at least 1"),
            ('stribeck_velocity="0"', "stribeck velocity 0 is not"),
            ('joint_stiffness="-3"', "joint stiffness -3 is not a positive number"),
            ('joint_damping="much"', "is not a number"),
        ],
    )
    def test_numbers_that_no_joint_has_are_refused(self, tmp_path, slider, tag, words):
        path = tmp_path / "bad.urdf"
        text = slider.urdf.replace("</joint>", f"<fotsmc_pin {tag}/></joint>")
        path.write_text(text)
        with pytest.raises(UrdfError, match=words):
            load_arm(path)

    @pytest.mark.parametrize(
        "option",
        [{"stiction": 0.9}, {"stribeck_velocity": 0.0}, {"joint_stiffness": 0.0}],
    )
    def test_numbers_given_are_checked_too(self, slider, option):
        with pytest.raises(ArgumentError, match=next(iter(option))):
            perturb(slider, **option)
