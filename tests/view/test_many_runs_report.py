"""Reports of folders that hold many runs, or none: a study, a stress suite, a search of gains."""

from __future__ import annotations

import json
import re

import numpy as np
import pytest
from typer.testing import CliRunner

import fotsmc_pin as fp
from fotsmc_pin.cli import app
from fotsmc_pin.evaluation.stress import StressRow, markdown
from fotsmc_pin.evaluation.studies.result import Row
from fotsmc_pin.evaluation.studies.store import Store
from fotsmc_pin.files import write_json
from fotsmc_pin.view import write_report


class Planned:
    """A run of a plan, as far as the store asks for it."""

    def __init__(self, number):
        self.seed, self.parameters = number, {"payload": float(number % 2), "mass": 1 + number / 97}

    def key(self, run):
        return f"{run} {self.seed:03}"


@pytest.fixture
def study_folder(tmp_path, make_recording):
    """A study of 120 runs, of which two failed; error and torque rise with the run's number."""
    folder = tmp_path / "study"
    folder.mkdir()
    names = fp.summarize(make_recording(fp.load_arm("two_link"), duration=0.1)).as_dict()
    with Store(folder / "study.sqlite") as store:
        for number in range(120):
            planned = Planned(number)
            error = "the arm fell over" if number in (7, 8) else None
            metrics = {} if error else dict.fromkeys(names, 1.0)
            metrics |= {} if error else {"tail_rms_error": 1e-3 * (number + 1)}
            row = Row(parameters=planned.parameters, seed=number, metrics=metrics, error=error)
            store.write("run", planned, row)
    make_recording(fp.load_arm("two_link"), duration=0.5).save(folder / "worst.npz")
    return folder


def test_a_study_is_told_as_its_runs_and_not_as_one(study_folder, text_of):
    text = text_of(write_report(study_folder).read_text("utf-8"))
    assert "study of 120 runs, 2 failed" in text
    assert "one run" not in text
    assert "the arm fell over" in text


def test_a_study_shows_quantiles_of_each_group_distributions_and_its_worst_run(
    study_folder, text_of
):
    page = write_report(study_folder).read_text("utf-8")
    text = text_of(page)
    errors = {half: 1.0 + np.arange(half, 120, 2) for half in (0, 1)}
    errors[0] = errors[0][errors[0] != 9]
    errors[1] = errors[1][errors[1] != 8]
    for half, values in errors.items():
        assert f"payload {half:.1f}" in text
        median = np.quantile(values, 0.5, method="higher")
        assert f"{median:.3g}" in text
    assert "seed\n" in text
    assert re.search(r"seed\s+119\s", text)
    assert 'alt="distribution: RMS error, last half"' in page
    assert "Animation of worst" in page


@pytest.fixture
def stress_folder(tmp_path):
    rows = [
        StressRow(arm="panda", controller="Calm", tail_rms_error=1e-3, diverged=False),
        StressRow(arm="ur5", controller="Calm", tail_rms_error=2e-3, diverged=False),
        StressRow(arm="ur5", controller="Wild", scenario="hold"),
    ]
    folder = tmp_path / "stress"
    write_json(folder / "stress.json", {"rows": [row.as_dict() for row in rows]})
    (folder / "stress.md").write_text(markdown(rows), "utf-8")
    return folder


def test_a_stress_suite_is_counted_and_its_worst_run_named(stress_folder, text_of):
    text = text_of(write_report(stress_folder).read_text("utf-8"))
    assert "stress suite of 3 runs: 2 controllers on 2 arms in 2 scenarios, 1 diverged" in text
    assert re.search(r"The worst run: Wild on ur5, scenario hold raw: it diverged", text)
    table = text[text.index("The worst run") :]
    assert [table.count(name) for name in ("Calm", "Wild")] >= [2, 2]


def test_a_search_of_gains_shows_its_front(tmp_path, text_of):
    (tmp_path / "front.md").write_text("| error | gains |\n|---:|---|\n| 0.5 | A=3 |\n", "utf-8")
    (tmp_path / "front.png").write_bytes(
        b"\x89PNG\r\n\x1a\n" + bytes(8) + (700).to_bytes(4, "big") + bytes(4)
    )
    page = write_report(tmp_path).read_text("utf-8")
    assert "Front of the search" in text_of(page)
    assert "A=3" in text_of(page)
    assert "data:image/png;base64," in page


def test_the_command_reports_a_folder_without_recordings(stress_folder):
    result = CliRunner().invoke(app, ["report", str(stress_folder)])
    assert result.exit_code == 0, result.output
    assert (stress_folder / "report.html").is_file()


def test_a_damaged_table_of_a_suite_is_refused_by_name(stress_folder):
    (stress_folder / "stress.json").write_text(json.dumps({"rows": 3}), "utf-8")
    with pytest.raises(fp.errors.RecordingError, match=r"stress\.json"):
        write_report(stress_folder)


def test_progress_of_a_report_and_a_page_is_told_to_its_end(stress_folder, tmp_path, two_link):
    told: list[float] = []
    write_report(stress_folder, progress=told.append)
    assert told == sorted(told)
    assert told[-1] == 1.0
    told.clear()
    fp.export_html(two_link, tmp_path / "a.html", progress=told.append)
    assert told == sorted(told)
    assert told[-1] == 1.0
