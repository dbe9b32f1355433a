"""An arm whose damping is too strong for explicit steps is integrated implicitly, or refused."""

import numpy as np
import pytest

import fotsmc_pin as fp
from fotsmc_pin.references import Hold


def held(arm, **options):
    nominal = fp.load_arm("xarm7")
    controller = fp.AdaptiveFONFTSM(nominal, dt=1e-3, preset="practical")
    return fp.simulate(arm, controller, Hold(nominal), 0.2, **options)


def test_strong_damping_on_a_light_wrist_stays_stable_by_default():
    rec = held(fp.load_arm("xarm7"))
    assert rec.metadata["integrator"] == "semi-implicit"
    assert np.abs(rec.v).max() < 10.0


def test_rk4_stays_the_default_where_it_is_stable():
    smooth = fp.load_arm("xarm7", damping=0.0, friction=0.0)
    assert held(smooth).metadata["integrator"] == "rk4"


def test_dry_friction_is_integrated_so_that_it_can_stick():
    rubbing = fp.load_arm("xarm7", damping=0.0, friction=0.5)
    assert held(rubbing).metadata["integrator"] == "semi-implicit"


def test_rk4_is_refused_with_the_steps_that_it_would_need():
    with pytest.raises(fp.errors.ArgumentError, match="wants substeps=") as error:
        held(fp.load_arm("xarm7"), integrator="rk4")
    substeps = int(str(error.value).split("substeps=")[1].split(",")[0])
    rec = held(fp.load_arm("xarm7"), integrator="rk4", substeps=substeps)
    assert np.abs(rec.v).max() < 10.0
