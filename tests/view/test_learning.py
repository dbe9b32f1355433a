"""What was learnt in a run: read from its recording, drawn, and told in a report."""

from __future__ import annotations

import numpy as np
import pytest

import fotsmc_pin as fp
from fotsmc_pin.errors import ArgumentError
from fotsmc_pin.learning import Prior, recorded_estimates
from fotsmc_pin.learning.estimates import Estimate, Estimates
from fotsmc_pin.simulation import TickDelay
from fotsmc_pin.view import learning_figure, write_report
from fotsmc_pin.view.learning_tables import (
    known_lines,
    learning_markdown,
    noticed,
    untold,
    with_deviation,
)

PICKED = 1.5


@pytest.fixture(scope="module")
def nominal():
    return fp.load_arm("two_link")


@pytest.fixture(scope="module")
def learning(nominal):
    return fp.ModelLearning(fp.RobustFONFTSM(nominal, dt=1e-3), prior=Prior(stribeck=0.5), delay=2)


@pytest.fixture(scope="module")
def run(nominal, learning):
    true = fp.perturb(nominal, mass_scale=1.3, friction=0.5)
    return fp.simulate(
        true,
        learning,
        fp.references.Sinusoid.inside_limits(nominal),
        2.5,
        events={PICKED: fp.perturb(true, payload=1.0)},
        actuator=TickDelay(2),
    )


class TestRecording:
    def test_it_names_the_law_that_learns_and_its_gains(self, run, learning):
        assert run.metadata["controller"] == "RobustFONFTSM + learning"
        assert run.metadata["gains"] == learning.controller.gains.as_dict()
        assert run.metadata["preset"] == learning.controller.preset
        assert run.metadata["nominal_arm"] == "two_link"
        assert run.metadata["learning"]["delay"] == 2
        assert run.metadata["learning"]["bears"] == [*learning.bears]

    def test_it_gives_the_estimates_at_its_end_back(self, run, learning, tmp_path):
        assert recorded_estimates(run) == learning.estimates()
        run.save(tmp_path / "run.npz")
        assert recorded_estimates(fp.Recording.load(tmp_path / "run.npz")) == learning.estimates()

    def test_it_gives_those_of_any_time(self, run):
        first, later = recorded_estimates(run, 0.0), recorded_estimates(run, 1.0)
        assert all(row.value == row.first_value for row in first)
        column = [row.value for row in later.group("friction")]
        assert column == run.signals["friction"][1000].tolist()
        assert recorded_estimates(run, -1.0) == first
        assert recorded_estimates(run, 1e3) == recorded_estimates(run)

    def test_a_law_that_does_not_learn_has_none(self, nominal, two_link):
        assert recorded_estimates(two_link) is None
        rec = fp.simulate(
            nominal,
            fp.RobustFONFTSM(nominal, dt=1e-3),
            fp.references.Sinusoid.inside_limits(nominal),
            0.01,
        )
        assert rec.metadata["controller"] == "RobustFONFTSM"
        assert "learning" not in rec.metadata


class TestFigure:
    def test_a_panel_for_each_parameter_with_a_line_at_each_event(self, run):
        figure = learning_figure(run)
        shown = [axes for axes in figure.axes if axes.get_visible()]
        # Four of the payload; of each joint the link's factor and moments, armature, and three
        # kinds of friction.
        assert len(shown) == 4 + 2 * 6
        curves = [len(axes.collections) for axes in shown]
        assert sum(curves) == len(recorded_estimates(run)), "a band for each parameter"
        assert sorted(set(curves)) == [1, 3]
        for axes in shown:
            assert any(np.all(np.equal(line.get_xdata(), PICKED)) for line in axes.lines)
        titles = [axes.get_title(loc="left") for axes in shown]
        for title in ("mass [kg]", "armature [kg·m²]", "Coulomb [N·m]"):
            assert title in titles

    def test_the_band_is_two_deviations_wide_at_the_end(self, run):
        row = recorded_estimates(run).group("armature")[1]
        figure = learning_figure(run, joints=[1])
        axes = next(a for a in figure.axes if a.get_title(loc="left") == "armature [kg·m²]")
        (band,) = axes.collections
        corners = band.get_paths()[0].vertices
        edges = corners[corners[:, 0] == run.t[-1], 1]
        assert edges.min() == pytest.approx(row.value - 2 * row.deviation)
        assert edges.max() == pytest.approx(row.value + 2 * row.deviation)
        low, high = axes.get_ylim()
        assert low < edges.min() < edges.max() < high

    def test_plot_writes_it_and_refuses_a_run_that_learnt_nothing(self, run, two_link, tmp_path):
        (file,) = fp.plot(run, tmp_path / "estimates.svg", kind="estimates")
        assert "moments x, y, z" in file.read_text("utf-8")
        with pytest.raises(ArgumentError, match="learnt nothing"):
            fp.plot(two_link, tmp_path / "none.svg", kind="estimates")
        assert not (tmp_path / "none.svg").exists()


def row_of(**parts):
    told = {
        "group": "friction",
        "of": "elbow",
        "value": 0.5,
        "deviation": 0.01,
        "first_value": 0.0,
        "first_deviation": 0.5,
        "unit": "N·m",
    }
    return Estimate(**(told | parts))


class TestWords:
    @pytest.mark.parametrize(
        ("value", "deviation", "words"),
        [
            (1.29871, 0.0521, "1.299 ± 0.052"),
            (0.5094, 0.0092, "0.5094 ± 0.0092"),
            (10.04, 1.3, "10.0 ± 1.3"),
            (87.3, 21.0, "87 ± 21"),
            (0.3, 0.0, "0.3"),
        ],
    )
    def test_a_number_has_the_digits_that_its_deviation_bears(self, value, deviation, words):
        assert with_deviation(value, deviation) == words

    def test_what_is_known_is_told_apart_from_what_is_not(self):
        rows = (
            row_of(),
            row_of(of="wrist", deviation=0.4),
            row_of(of="shoulder", deviation=0.0, first_deviation=0.0),
            row_of(group="payload", of="moment z", unit="kg·m", deviation=0.4),
            row_of(group="link_moment", of="arm x", unit="kg·m", deviation=0.4),
            row_of(group="link_moment", of="arm y", unit="kg·m", deviation=0.0),
            row_of(group="link_moment", of="arm z", unit="kg·m", deviation=0.4),
            row_of(group="link_scale", of="hand and left and right", unit="", deviation=0.3),
        )
        estimates = Estimates(rows)
        assert known_lines(estimates) == [
            ["Coulomb friction", "elbow", "0.500 ± 0.010", "0", "N·m"],
            ["first moment", "arm along y", "0.5", "0", "kg·m"],
        ]
        assert untold(estimates) == (
            "The motion could not tell: Coulomb friction of wrist; payload, first moment along z; "
            "first moment of arm along x and z; mass and inertia of hand and 2 more."
        )
        written = learning_markdown(estimates)
        assert "| Coulomb friction | elbow | 0.500 ± 0.010 | 0 | N·m |" in written
        assert "Nothing is known" in learning_markdown(Estimates(rows[1:4]))
        assert untold(Estimates(rows[:1])) == ""

    def test_many_of_one_kind_are_told_in_few_words(self):
        axes = [f"{link} {axis}" for link in ("arm", "hand") for axis in "xyz"]
        rows = [row_of(group="link_moment", of=of, unit="kg·m", deviation=0.4) for of in axes]
        rows += [row_of(group="damping", of=of, deviation=0.4) for of in ("elbow", "wrist")]
        told = untold(Estimates((*rows, row_of()))).removeprefix("The motion could not tell: ")
        assert told == "first moment of every link; viscous friction of every joint."
        known = [row_of(group="link_moment", of="arm x", unit="kg·m"), *rows[3:6]]
        assert untold(Estimates(tuple(known))) == (
            "The motion could not tell: first moment of hand."
        )

    def test_the_times_at_which_the_payload_was_found_to_be_another(self, run, two_link):
        times = [float(word) for word in noticed(run).replace(" s", "").split(",")]
        assert any(PICKED < time < PICKED + 0.3 for time in times)
        assert len(times) == run.signals["changes"][-1, 0]
        assert noticed(two_link) == ""


class TestReport:
    def test_it_tells_and_shows_what_was_learnt(self, run, tmp_path, text_of):
        run.save(tmp_path / "run.npz")
        page = write_report(tmp_path).read_text("utf-8")
        text = text_of(page)
        assert "What was learnt" in text
        rotor = recorded_estimates(run).group("armature")[0]
        assert f"{with_deviation(rotor.value, rotor.deviation)} kg·m²" in text
        assert "began with the model of two_link and learnt while the arm moved" in text
        assert "torque taken to act 2 ticks later" in text
        assert "<figcaption>estimates</figcaption>" in page

    def test_it_shows_the_folders_own_figure_once(self, run, tmp_path):
        run.save(tmp_path / "run.npz")
        fp.plot(run, tmp_path / "run.png")
        fp.plot(run, tmp_path / "estimates.png", kind="estimates")
        page = write_report(tmp_path).read_text("utf-8")
        assert page.count("<figcaption>estimates</figcaption>") == 1

    def test_runs_that_learn_are_told_apart_from_those_that_do_not(
        self, run, two_link, tmp_path, text_of
    ):
        run.save(tmp_path / "clever.npz")
        two_link.save(tmp_path / "plain.npz")
        page = write_report(tmp_path).read_text("utf-8")
        section = page[page.index('id="what-was-learnt"') : page.index('id="figures"')]
        assert "clever" in section
        assert "plain" not in section

    def test_a_report_without_learning_has_no_such_section(self, two_link, tmp_path, text_of):
        two_link.save(tmp_path / "run.npz")
        assert "learnt" not in text_of(write_report(tmp_path).read_text("utf-8"))
