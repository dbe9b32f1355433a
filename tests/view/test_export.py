"""Writing a page: whole, small, quick, the same each time, and without any server."""

from __future__ import annotations

import re
import subprocess
import sys
import time
from html.parser import HTMLParser

import numpy as np
import pytest

import fotsmc_pin as fp
from fotsmc_pin.errors import ArgumentError


def test_same_run_gives_the_same_bytes(two_link, tmp_path):
    first = fp.export_html(two_link, tmp_path / "a.html").read_bytes()
    assert fp.export_html(two_link, tmp_path / "b.html").read_bytes() == first


def test_saved_and_loaded_run_gives_the_same_page(two_link, tmp_path):
    two_link.save(tmp_path / "run.npz")
    loaded = fp.Recording.load(tmp_path / "run.npz")
    pages = [
        fp.export_html(rec, tmp_path / "x.html").read_text("utf-8") for rec in (two_link, loaded)
    ]
    assert pages[0] == pages[1]


def test_sizes_of_ten_second_pages(make_recording, tmp_path):
    two_link = make_recording(fp.load_arm("two_link_true"), duration=10.0)
    assert fp.export_html(two_link, tmp_path / "a.html").stat().st_size < 1.6e6
    panda = make_recording(fp.load_arm("panda"), duration=10.0)
    took = []
    for _ in range(3):
        start = time.process_time()
        size = fp.export_html(panda, tmp_path / "b.html").stat().st_size
        took.append(time.process_time() - start)
    assert size < 6e6
    assert min(took) < 3.0


def test_a_long_run_stays_small(make_recording, tmp_path):
    run = make_recording(fp.load_arm("two_link"), duration=100.0)
    assert fp.export_html(run, tmp_path / "long.html").stat().st_size < 2.5e6


def test_a_failed_write_leaves_the_old_page(two_link, tmp_path, monkeypatch):
    path = tmp_path / "page.html"
    path.write_text("old")

    def fail(*_: object) -> None:
        raise OSError("disk full")

    monkeypatch.setattr("pathlib.Path.replace", fail)
    with pytest.raises(OSError, match="disk full"):
        fp.export_html(two_link, path)
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


def test_page_names_no_address_outside(two_link, tmp_path):
    text = fp.export_html(two_link, tmp_path / "a.html").read_text("utf-8")

    class Links(HTMLParser):
        found: list[str] = []  # noqa: RUF012

        def handle_starttag(self, tag, attributes):
            self.found += [v for k, v in attributes if k in ("src", "href", "srcset", "data")]

    Links().feed(re.sub(r"<script>.*?</script>", "", text, flags=re.DOTALL))
    assert Links.found == ["data:,"]
    assert "default-src 'none'" in text


def test_no_server_socket_or_pyplot_is_needed(tmp_path):
    program = f"""
import sys
import fotsmc_pin as fp
def refuse(event, arguments):
    assert not event.startswith("socket"), event
sys.addaudithook(refuse)
sys.path.insert(0, {str(tmp_path)!r})
arm = fp.load_arm("two_link")
import numpy as np
t = np.arange(100) * 1e-2
zero = np.zeros((100, 2))
rec = fp.Recording(t=t, q=zero, v=zero, q_d=zero, v_d=zero, e=zero, e_dot=zero, tau=zero,
                   signals={{}}, arm=arm)
fp.export_html(rec, {str(tmp_path / "a.html")!r})
fp.plot(rec, {str(tmp_path / "a.png")!r})
bad = {{"zmq", "tornado", "meshcat", "matplotlib.pyplot"}} & set(sys.modules)
assert not bad, bad
"""
    subprocess.run(
        [sys.executable, "-W", "error", "-c", program], check=True, cwd=sys.path[0] or None
    )


def test_looks_are_not_loaded_before_they_are_wanted():
    program = "import fotsmc_pin as fp, sys; fp.export_html; assert 'matplotlib' not in sys.modules"
    subprocess.run([sys.executable, "-c", program], check=True)


def test_payload_of_a_perturbed_arm_is_drawn(make_recording, tmp_path):
    arm = fp.perturb(fp.load_arm("two_link"), payload=2.0)
    text = fp.export_html(make_recording(arm, duration=0.5), tmp_path / "a.html").read_text("utf-8")
    assert '"payload_1_0"' in text


@pytest.mark.parametrize(
    ("options", "argument"),
    [
        ({"paths": "some"}, "paths"),
        ({"layout": "stacked"}, "layout"),
        ({"quality": "best"}, "quality"),
        ({"theme": "pink"}, "theme"),
        ({"speed": 0.0}, "speed"),
        ({"rate": np.nan}, "rate"),
        ({"signals": ["nothing"]}, "signals"),
    ],
)
def test_unusable_options_are_named_before_anything_is_written(
    two_link, tmp_path, options, argument
):
    with pytest.raises(ArgumentError) as caught:
        fp.export_html(two_link, tmp_path / "a.html", **options)
    assert caught.value.argument == argument
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("rec", [[], {}, 7, [1], {"run": None}])
def test_what_is_no_recording_is_refused(rec, tmp_path):
    with pytest.raises(ArgumentError):
        fp.export_html(rec, tmp_path / "a.html")


def test_runs_without_names_are_called_by_their_controllers(two_link, tmp_path):
    text = fp.export_html([two_link, two_link], tmp_path / "a.html").read_text("utf-8")
    assert "MadeUp · MadeUp (2)" in text


def test_a_single_sample_makes_a_page(two_link, tmp_path):
    import dataclasses

    arrays = {
        name: getattr(two_link, name)[:1]
        for name in ("t", "q", "v", "q_d", "v_d", "e", "e_dot", "tau")
    }
    one = dataclasses.replace(two_link, signals={}, **arrays)
    assert fp.export_html(one, tmp_path / "a.html").stat().st_size > 0
