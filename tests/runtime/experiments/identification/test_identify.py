"""Crafts that are not the default are found from noisy streams, and what these do not show is said."""

from dataclasses import replace

import numpy as np
import pytest

from robot_runtime.contract.craft import Craft
from robot_runtime.experiments.identification.bodies import CHANNELS
from robot_runtime.experiments.identification.fit import Fit
from robot_runtime.experiments.identification.identify import Identification, identify
from robot_runtime.experiments.identification.prediction import predict
from robot_runtime.experiments.identification.quantities import QUANTITIES, ZERO_SPREAD
from robot_runtime.experiments.identification.shooting import OF_A_SESSION, OFFSETS
from robot_runtime.experiments.identification.streams import (
    EVERY,
    MEASURED_AGE,
    STEP,
    WINDOW,
    SessionStreams,
    cut,
    sensor_noise,
)
from robot_runtime.experiments.identification.whitening import Whitening
from tests.runtime.experiments.identification.swimmer import HEAVING, swim

OTHER = Craft(
    fin_drag=0.19,
    fin_normal=2.5,
    damping_quadratic=(7.0, 30.0, 48.0, 0.027, 0.033, 0.066),
    added_mass=(1.15, 2.1, 3.2, 0.0053, 0.0085, 0.0075),
    buoyancy=1.0042,
    buoyancy_forward=-0.0012,
    buoyancy_right=0.0008,
    buoyancy_height=0.0066,
    fin_delay=0.025,
    gyroscope_offset=(0.05, -0.02, 0.03),
    accelerometer_offset=(0.2, -0.1, 0.15),
    accelerometer=replace(Craft().accelerometer, noise=0.03),
)
"""Its thrust, damping, inertia, surplus of buoyancy and trim differ from the default's by up to 40 %."""
START = Craft()

pytestmark = pytest.mark.timeout(900)
"""s. The fit takes a minute of processor time, and waits for it behind the tests in real time."""


@pytest.fixture(scope="module")
def result() -> Identification:
    fitted = [swim(OTHER, seed, 50) for seed in (1, 2)]
    return identify(fitted, swim(OTHER, 3, 18), START)


def test_numbers_that_differ_by_up_to_40_percent_are_found_within_5(result: Identification) -> None:
    """10 % where they are weakly seen."""
    judged = 0
    for item in result.results:
        true = item.quantity.value(OTHER)
        # Of the buoyancy the surplus over the weight counts.
        least = 1.0 if item.quantity.name == "buoyancy" else 0.0
        if item.quantity.entry == "damping_linear":
            continue
        error = abs(item.value - true) / abs(true - least)
        assert item.seen != "no", item.quantity.name
        assert error < {"well": 0.05, "weakly": 0.10}[item.seen], (item.quantity.name, item.value, true)
        judged += 1
    assert judged == len(QUANTITIES) - 6


def test_confidence_holds_what_is_true(result: Identification) -> None:
    """Within three and a half standard deviations, as far as 24 of them may be."""
    for item in result.results:
        if item.deviation is not None:
            distance = abs(item.value - item.quantity.value(OTHER)) / item.deviation
            assert distance < 3.5, (item.quantity.name, item.value, item.deviation)


def test_the_session_that_was_left_out_is_predicted_five_times_better(result: Identification) -> None:
    check = result.prediction
    assert check is not None
    assert check.session == "swim 3"
    assert check.improvement > 5
    assert np.all(check.after_rms < check.before_rms)
    assert check.measured.shape == check.before.shape == check.after.shape
    assert check.measured.shape[1] == CHANNELS


def test_noise_and_offsets_of_the_sensors_are_found(result: Identification) -> None:
    assert result.noise == pytest.approx({"pressure": 42, "gyroscope": 2e-4, "accelerometer": 0.03}, rel=0.1)
    # A session draws an offset of its own beside the fixed one.
    assert result.craft.gyroscope_offset == pytest.approx(OTHER.gyroscope_offset, abs=6e-3)
    assert result.craft.accelerometer_offset == pytest.approx(OTHER.accelerometer_offset, abs=0.06)


def test_what_diving_alone_does_not_show_is_named() -> None:
    windows = cut([swim(START, 4, 26, HEAVING)], START)
    fit = Fit(windows, START)
    numbers = np.zeros(len(QUANTITIES) + OF_A_SESSION)
    weak = {QUANTITIES[index].name for index in fit._find_unseen(QUANTITIES, numbers)}
    assert {"damping_quadratic_sway", "damping_quadratic_surge", "damping_linear_yaw"} <= weak
    assert weak.isdisjoint({"thrust", "damping_quadratic_heave", "buoyancy", "fin_delay"})


def test_the_true_craft_predicts_to_the_noise() -> None:
    # Not every swim can be predicted: broadside, Munk's moment turns a hull away, and errors grow.
    windows = cut([swim(START, 6, 10)], START)
    predicted = predict(windows, START)
    assert predicted.rms[0] < 0.006
    assert predicted.rms[1:4].max() < 0.02
    # Strokes are seen 50 times a second only.
    assert predicted.rms[4:].max() < 0.05


def test_windows_leave_out_gaps_and_the_surface() -> None:
    whole = swim(START, 6, 40)
    assert cut([whole], START).starts == pytest.approx(
        [0.33 + WINDOW * index for index in range(4)], abs=0.01
    )
    missing = (whole.depth_times < 10) | (whole.depth_times > 10.2)
    broken = replace(
        whole,
        depth_times=whole.depth_times[missing],
        depths=whole.depths[missing],
    )
    starts = cut([broken], START).starts
    assert starts[0] == pytest.approx(0.33, abs=0.01)
    assert 10.2 < starts[1] < 10.6
    with pytest.raises(
        ValueError, match=r"No part of these sessions can be used: .* 8 s, .* deeper than 8 cm"
    ):
        cut([replace(whole, depths=whole.depths * 0)], START)


@pytest.mark.parametrize("silence", [0.5, 5.0, 12.0])
def test_no_window_reaches_into_a_gap(silence: float) -> None:
    whole = swim(START, 6, 40)
    heard = (whole.imu_times < 10) | (whole.imu_times > 10 + silence)
    broken = replace(
        whole,
        imu_times=whole.imu_times[heard],
        rates=whole.rates[heard],
        forces=whole.forces[heard],
        attitudes=whole.attitudes[heard],
    )
    starts = cut([broken], START).starts
    assert starts[0] == pytest.approx(0.33, abs=0.01)
    assert starts[1] == pytest.approx(10 + silence + 0.32, abs=0.03)


def test_a_session_without_samples_has_no_window() -> None:
    none, three, four = np.empty(0), np.empty((0, 3)), np.empty((0, 4))
    empty = SessionStreams("x", none, four, none, three, three, four, none, none, none)
    with pytest.raises(ValueError, match="No part of these sessions"):
        cut([empty], START)
    assert sensor_noise(empty) == {}


def test_residuals_of_a_filtered_noise_are_made_white() -> None:
    random, share = np.random.default_rng(1), 0.8
    noise = random.normal(0, 0.3, (40, 2, 2000))
    errors = noise.copy()
    for moment in range(1, 2000):
        errors[:, 0, moment] += share * errors[:, 0, moment - 1]
    result = Whitening.of(errors, np.zeros((40, 2000)))
    assert result.coefficients == pytest.approx(np.array([[share, 0, 0, 0], [0, 0, 0, 0]]), abs=0.02)
    assert result.sigma == pytest.approx(np.full((40, 2, 1996), 0.3), rel=0.02)
    assert result.apply(errors) == pytest.approx(noise[:, :, 4:] / 0.3, abs=0.3)
    slopes = np.stack((errors, 2 * errors), axis=3)
    assert result.apply(slopes)[..., 1] == pytest.approx(2 * result.apply(errors))


def test_residuals_count_less_where_the_fins_move() -> None:
    random = np.random.default_rng(1)
    activity = np.repeat([[0.0, 30.0, 60.0, 0.0]], 250, axis=1) * np.ones((20, 1))
    true = np.sqrt(0.01**2 + 0.1**2 * activity)
    result = Whitening.of(random.normal(0, 1, (20, 1, 1000)) * true[:, None], activity)
    assert result.sigma[:, 0] == pytest.approx(true[:, 4:], rel=0.1)


def test_a_channel_without_residuals_is_no_fault() -> None:
    none = np.zeros((2, 1, 50))
    assert np.all(Whitening.of(none, none[:, 0]).apply(none) == 0)


def test_a_resting_fin_has_no_speed() -> None:
    """The noise of its encoder is no motion, whose drag would count as damping of the hull."""
    swum = swim(START, 6, 10)
    noise = np.random.default_rng(1).normal(0, START.encoder.noise, swum.angles.shape)
    resting = replace(swum, angles=np.round((0.5 + noise) * 512 / np.pi) * np.pi / 512)
    assert cut([resting], START).fins(0.0, np.zeros((1, 4))).speeds.std() < 0.02
    # A fin that turns keeps its speed up to the moment at which it stops.
    turned = np.clip(3.0 * (swum.motor_times - 4.0), 0.0, 3.0)[:, None] + resting.angles - 0.5
    windows = cut([replace(resting, angles=np.remainder(turned + np.pi, 2 * np.pi) - np.pi)], START)
    speeds = windows.fins(0.0, np.zeros((1, 4))).speeds[:, 0, 0]
    times = windows.starts[0] + np.arange(len(speeds)) * STEP / 2
    assert speeds[(times > 4.1) & (times < 4.9)] == pytest.approx(3.0, abs=0.6)


def test_readings_between_two_samples_follow_a_quick_motion() -> None:
    swum = swim(START, 6, 10)
    shake = np.sin(2 * np.pi * 8 * swum.imu_times)
    shaken = replace(swum, rates=np.repeat(shake[:, None], 3, axis=1))
    windows = cut([shaken], START)
    times = windows.starts[0] + np.arange(windows.measured.shape[1]) * STEP * EVERY
    times += MEASURED_AGE + START.gyroscope.latency
    assert windows.measured[1, :, 0] == pytest.approx(np.sin(2 * np.pi * 8 * times), abs=0.005)


def test_the_zeros_of_the_encoders_are_found() -> None:
    """A zero that is 4 mrad off is no push of the fins."""
    swum = swim(replace(START, encoder=replace(START.encoder, bias=0)), 6, 26)
    shifted = np.array([0.004, -0.003, 0.002, 0.0])
    fit = Fit(cut([replace(swum, angles=swum.angles + shifted)], START), START)
    numbers = fit._solve((), fit._solve((), np.zeros(OF_A_SESSION)))
    assert ZERO_SPREAD * numbers[OFFSETS:] == pytest.approx(shifted, abs=0.001)


def test_a_fit_that_is_cancelled_ends() -> None:
    windows = cut([swim(START, 5, 10)], START)

    def cancel(share: float) -> None:
        raise KeyboardInterrupt(share)

    with pytest.raises(KeyboardInterrupt):
        Fit(windows, START, cancel).run()
