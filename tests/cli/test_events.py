"""`--event` and `--wrench` of `fotsmc simulate`: what they make, and what they refuse."""

from functools import partial

import pytest

import fotsmc_pin as fp
from fotsmc_pin.cli.plant_options import PlantOptions
from fotsmc_pin.cli.run_events import events, wrenches
from fotsmc_pin.errors import ArgumentError

ARM = fp.load_arm("two_link")


def made(options):
    return options.apply(ARM)


def test_an_event_replaces_one_option_and_holds_until_another():
    plant = PlantOptions(payload="1", mass_scale=["0.9:1.1"], seed=3)
    given = ["6:payload=0", "3:payload=2", "4.5:--friction=0.5", "5:true_armature=6"]
    found = events(given, plant, made, 10.0)
    as_perturbed = partial(fp.perturb, ARM, mass_scale=fp.Uniform(0.9, 1.1), seed=3)
    assert [*found] == [3.0, 4.5, 5.0, 6.0]
    rough = {"friction": 0.5, "armature": 6.0}
    assert found[3.0] == as_perturbed(payload=2.0)
    assert found[4.5] == as_perturbed(payload=2.0, friction=0.5)
    assert found[5.0] == as_perturbed(payload=2.0, **rough)
    assert found[6.0] == as_perturbed(**rough)


def test_events_at_one_time_act_together():
    found = events(["2:payload=1", "2:friction=0.5"], PlantOptions(), made, 10.0)
    assert found == {2.0: fp.perturb(ARM, payload=1.0, friction=0.5)}


@pytest.mark.parametrize(
    ("text", "remedy"),
    [
        ("3", "write TIME:option=value"),
        ("payload=2", "write TIME:option=value"),
        ("x:payload=2", "write TIME:option=value"),
        ("3:payload", "write TIME:option=value"),
        ("0:payload=2", "not within the run, above 0 and below 10 s"),
        ("10:payload=2", "not within the run"),
        ("nan:payload=2", "not within the run"),
        ("3:paylod=2", "did you mean payload"),
        ("3:seed=2", "it can change mass-scale"),
        ("3:payload=two", "payload: write a number"),
        ("3:friction=joint1=2", "friction: write a number"),
        ("3:payload=-2", "payload: give a number at least 0"),
        ("3:mass-scale=0.9:1.1", "seed: "),
    ],
)
def test_an_event_that_is_none(text, remedy):
    with pytest.raises(ArgumentError, match=remedy) as caught:
        events([text], PlantOptions(), made, 10.0)
    assert (caught.value.argument, caught.value.value) == ("--event", text)


def test_a_wrench_is_a_force_and_perhaps_a_torque_and_a_link():
    given = ["3:0.5:50,0,0", "1e0:2:0,0,-1.5,0,2,0@link1"]
    assert wrenches(given, ARM, 10.0) == [
        fp.Wrench(start=3.0, duration=0.5, force=(50, 0, 0)),
        fp.Wrench(start=1.0, duration=2.0, force=(0, 0, -1.5), torque=(0, 2, 0), frame="link1"),
    ]


@pytest.mark.parametrize(
    ("text", "remedy"),
    [
        ("3:0.5", "write START:DURATION:FX,FY,FZ"),
        ("3:0.5:50", "write START:DURATION:FX,FY,FZ"),
        ("3:0.5:1,2,3,4", "write START:DURATION:FX,FY,FZ"),
        ("3:0.5:a,b,c", "write START:DURATION:FX,FY,FZ"),
        ("3,1:0.5:1,2,3", "write START:DURATION:FX,FY,FZ"),
        ("10:0.5:1,2,3", "the run ends at 10 s"),
        ("1:-1:1,2,3", "duration: give a number above 0"),
        ("1:1:inf,0,0", "force: every entry must be finite"),
        ("1:1:1,2,3@lnk2", "did you mean link2"),
    ],
)
def test_a_wrench_that_is_none(text, remedy):
    with pytest.raises(ArgumentError, match=remedy) as caught:
        wrenches([text], ARM, 10.0)
    assert (caught.value.argument, caught.value.value) == ("--wrench", text)


def test_a_run_with_both_tells_and_keeps_them(fotsmc, tmp_path):
    result = fotsmc(
        *("simulate", "two_link", "--payload", "1", "--duration", "1", "--out", "run"),
        *("--event", "0.3:payload=2", "--event", "0.6:payload=0", "--wrench", "0.8:0.1:50,0,0"),
    )
    assert result.returncode == 0, result.stderr
    rec = fp.Recording.load(tmp_path / "run" / "run.npz")
    assert [(e.time, e.words) for e in rec.events] == [
        (0.3, "payload 2 kg"),
        (0.6, "no payload"),
    ]
    assert rec.wrenches[0].force == (50.0, 0.0, 0.0)
    for words in ("0.3 s: payload 2 kg", "0.8 s to 0.9 s: 50 N at the tool"):
        assert words in result.stdout
        assert words in (tmp_path / "run" / "two_link.html").read_text("utf-8")


@pytest.mark.parametrize("option", ["--event", "--wrench"])
def test_a_wrong_one_is_one_line_and_exit_code_2(fotsmc, option):
    result = fotsmc("simulate", "two_link", option, "soon")
    assert result.returncode == 2
    assert result.stderr.startswith(f"fotsmc: {option} = 'soon': write ")
    assert len(result.stderr.strip().splitlines()) == 1
