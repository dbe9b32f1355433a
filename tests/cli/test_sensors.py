"""What `fotsmc simulate` measures: encoders, torque sensors, and options that cannot be."""

import numpy as np
import pytest

import fotsmc_pin as fp
from fotsmc_pin.cli.sensor_options import SensorOptions
from fotsmc_pin.errors import ArgumentError


@pytest.fixture(scope="module")
def arm():
    return fp.load_arm("two_link", effort_limit=[200.0, 50.0])


def readings(options, arm):
    sensor = options.make(arm, 1e-3, 3)
    rows = [sensor(0.0, np.full(2, 0.3), np.zeros(2))[0] for _ in range(500)]
    sensor.reset()
    return np.array(rows), sensor


def test_nothing_is_measured_where_nothing_is_asked(arm):
    assert SensorOptions().make(arm, 1e-3, None) is None


def test_torque_noise_is_a_share_of_each_limit(arm):
    sensor = SensorOptions(torque_noise=0.005).make(arm, 1e-3, 3)
    read = np.array([sensor.measure_torque(0.0, np.zeros(2)) for _ in range(2000)])
    np.testing.assert_allclose(read.std(axis=0), [1.0, 0.25], rtol=0.06)


def test_all_sensors_together(arm):
    options = SensorOptions(noise=1e-4, encoder_bits=12, torque_noise=0.0, torque_step=0.001)
    q, sensor = readings(options, arm)
    step = 2.0 * np.pi / 2**12
    np.testing.assert_allclose(q / step, np.round(q / step), atol=1e-9)
    torque_sensor = sensor.parts[-1]
    np.testing.assert_allclose(
        torque_sensor.measure_torque(0.0, np.array([1.27, 1.27])), [1.2, 1.25]
    )


@pytest.mark.parametrize(
    ("options", "named"),
    [
        ({"noise": -1.0}, "--noise"),
        ({"encoder_bits": 0}, "--encoder-bits"),
        ({"torque_noise": -0.1}, "--torque-noise"),
        ({"torque_noise": np.inf}, "--torque-noise"),
        ({"torque_step": np.nan}, "--torque-step"),
    ],
)
def test_an_option_that_cannot_be_is_named(arm, options, named):
    with pytest.raises(ArgumentError, match=named):
        SensorOptions(**options).make(arm, 1e-3, None)


def test_a_share_of_no_limit_is_refused():
    with pytest.raises(ArgumentError, match="has none"):
        SensorOptions(torque_noise=0.01).make(
            fp.load_arm("two_link", effort_limit=np.inf), 1e-3, None
        )
