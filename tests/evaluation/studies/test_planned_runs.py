"""What is run: every point of the grid, all with the same reproducible draws."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fotsmc_pin import Uniform
from fotsmc_pin.errors import ArgumentError
from fotsmc_pin.evaluation.studies.planned_runs import PlannedRun, planned_runs

GRID = {"law": ["a", "b"], "alpha": [0.1, 0.2, 0.3]}
DRAWS = {"mass": Uniform(0.5, 2.0), "arm": ["long", "short"]}


def test_every_point_of_the_grid_meets_the_same_draws():
    made = planned_runs(GRID, DRAWS, 4, 7)
    assert len(made) == 6 * 4
    points = {(planned.parameters["law"], planned.parameters["alpha"]) for planned in made}
    assert len(points) == 6
    per_point = {}
    for planned in made:
        point = (planned.parameters["law"], planned.parameters["alpha"])
        drawn = (planned.parameters["mass"], planned.parameters["arm"], planned.seed)
        per_point.setdefault(point, []).append(drawn)
    assert all(drawn == per_point["a", 0.1] for drawn in per_point.values())
    assert len(set(per_point["a", 0.1])) == 4


@given(seed=st.integers(0, 2**40), few=st.integers(1, 5), more=st.integers(1, 5))
def test_more_repeats_go_on_where_fewer_ended(seed, few, more):
    assert planned_runs({}, DRAWS, few, seed) == planned_runs({}, DRAWS, few + more, seed)[:few]


def test_another_name_changes_no_draw():
    alone = planned_runs({}, {"mass": DRAWS["mass"]}, 5, 1)
    together = planned_runs({}, DRAWS, 5, 1)
    assert [c.parameters["mass"] for c in alone] == [c.parameters["mass"] for c in together]


def test_draws_stay_inside_their_bounds_and_fill_them():
    drawn = np.array([c.parameters["mass"] for c in planned_runs({}, DRAWS, 400, 3)])
    assert drawn.min() >= 0.5
    assert drawn.max() <= 2.0
    assert abs(drawn.mean() - 1.25) < 4 * 1.5 / np.sqrt(12 * 400)


def test_arrays_are_lists_of_values():
    made = planned_runs({"x": np.linspace(0.0, 1.0, 3)}, {}, 1, 0)
    assert [planned.parameters["x"] for planned in made] == [0.0, 0.5, 1.0]


def test_the_key_tells_runs_parameters_and_seeds_apart():
    planned = PlannedRun(parameters={"x": 1.0, "y": 2.0}, seed=1)
    assert planned.key("run") == PlannedRun(parameters={"y": 2.0, "x": 1.0}, seed=1).key("run")
    others = {
        planned.key("other run"),
        PlannedRun(parameters={"x": 1.0, "y": 2.5}, seed=1).key("run"),
        PlannedRun(parameters={"x": 1.0, "y": 2.0}, seed=2).key("run"),
    }
    assert len(others | {planned.key("run")}) == 4


@pytest.mark.parametrize(
    ("grid", "draws", "repeats", "seed", "named"),
    [
        ({"x": []}, {}, 1, 0, "grid 'x'"),
        ({"x": "word"}, {}, 1, 0, "grid 'x'"),
        ({"x": 1.0}, {}, 1, 0, "grid 'x'"),
        ({"x": [object()]}, {}, 1, 0, "grid 'x'"),
        ({"x": [float("nan")]}, {}, 1, 0, "grid 'x'"),
        ({"x": Uniform(0, 1)}, {}, 1, 0, "grid 'x'"),
        ({}, {"x": 3.0}, 1, 0, "draws 'x'"),
        ({"x": [1]}, {"x": [1]}, 1, 0, "draws"),
        ({}, {}, 0, 0, "repeats"),
        ({}, {}, 1, -1, "seed"),
    ],
)
def test_what_cannot_be_run_is_named(grid, draws, repeats, seed, named):
    with pytest.raises(ArgumentError) as refusal:
        planned_runs(grid, draws, repeats, seed)
    assert refusal.value.argument == named
