"""The report of a folder of results: everything in one file, told right, and nothing fetched."""

from __future__ import annotations

import html
import json
import re
from html.parser import HTMLParser
from pathlib import Path

import pytest

import fotsmc_pin as fp
from fotsmc_pin.files import markdown_table
from fotsmc_pin.view import write_report
from fotsmc_pin.view.prose import prose

CLAIMS = """# What the paper claims

## Fig. 4: no <chattering>

- printed: no chattering
- measured: 300 N·m/s
- holds: **no**: `sign` chatters.
"""
CELL = re.compile(r"<(?:th|td)[^>]*>(.*?)</(?:th|td)>")


def outside_the_frame(page: str) -> str:
    """Return the report's own markup: a quoted attribute holds the page in the frame."""
    return re.sub(r'srcdoc="[^"]*"', "", page)


def text_of(page: str) -> str:
    """Return what the report says, without styles and tags."""
    page = re.sub(r"<style>.*?</style>", "", outside_the_frame(page), flags=re.DOTALL)
    return html.unescape(re.sub(r"<[^>]+>", "\n", page))


@pytest.fixture
def folder(tmp_path, make_recording):
    arm = fp.perturb(fp.load_arm("two_link"), mass_scale=fp.Uniform(0.9, 1.1), seed=7)
    metadata = {"controller": "MadeUp", "gains": {"theta": 5.0}, "versions": {"pin": "4.1.0"}}
    make_recording(arm, duration=1.0, metadata=metadata).save(tmp_path / "results/run.npz")
    return tmp_path / "results"


def test_it_tells_arm_perturbation_seed_controller_gains_and_versions(folder):
    text = text_of(write_report(folder).read_text("utf-8"))
    for word in ("two_link_perturbed", "drawn from seed 7", "MadeUp", "theta = 5", "pin 4.1.0"):
        assert word in text


def test_its_figures_are_the_recordings(folder):
    rec = fp.Recording.load(folder / "run.npz")
    text = text_of(write_report(folder).read_text("utf-8"))
    summary = fp.summarize(rec)
    assert f"{1e3 * summary.tail_rms_error:.3g}" in text
    assert f"{summary.peak_torque:.3g}" in text


def test_metrics_on_disk_stand_for_runs_that_were_not_kept(folder):
    runs = {"run": {"settling_time": "inf"}, "alpha_0.5": {"settling_time": 2.25}}
    titles = {"alpha_0.5": "α = 0.5"}
    metrics = {"runs": runs, "experiments": titles}
    (folder / "metrics.json").write_text(json.dumps(metrics), "utf-8")
    text = text_of(write_report(folder).read_text("utf-8"))
    assert "α = 0.5" in text
    assert "2.25" in text
    assert "never" in text


def test_claims_stand_where_there_are_any(folder):
    assert "Claims" not in text_of(write_report(folder).read_text("utf-8"))
    (folder / "claims.md").write_text(CLAIMS, "utf-8")
    page = write_report(folder).read_text("utf-8")
    assert "Fig. 4: no <chattering>" in text_of(page)
    assert "<strong>no</strong>" in page


def test_prose_is_escaped_and_nested_under_the_page():
    shown = prose(CLAIMS, top=2)
    assert "<h3>Fig. 4: no &lt;chattering&gt;</h3>" in shown
    assert "<li>holds: <strong>no</strong>: <code>sign</code> chatters.</li>" in shown
    assert shown.count("<li>") == 3


HOSTILE_MARKDOWN = [
    "<script>alert(1)</script>",
    "words <img src=x onerror=alert(1)> words",
    "[press](javascript:alert(1))",
    "[press](https://example.org)",
    "<https://example.org>",
    "![look](https://example.org/spy.png)",
    "[press][1]\n\n[1]: https://example.org",
    "# a <b onclick=x>b</b>\n- <i>c</i>",
    "| <u>a</u> |\n|---|\n| <iframe src=x> |",
    "```<style>\n<b>*{display:none}\n```",
    "&lt;script&gt;alert(1)&lt;/script&gt;",
]


@pytest.mark.parametrize("text", HOSTILE_MARKDOWN)
def test_no_markup_of_the_texts_own_and_nothing_to_fetch_reaches_the_page(text):
    known = {"p", "h2", "ul", "li", "pre", "code", "div", "table", "thead", "tbody", "tr", "th"}
    allowed = {"class", "role", "aria-label", "tabindex", "scope"}

    class Tags(HTMLParser):
        def handle_starttag(self, tag, attrs):
            assert tag in known, (tag, text)
            assert {name for name, _ in attrs} <= allowed, (attrs, text)

    Tags().feed(prose(text))


def test_every_cell_of_a_written_table_is_read_back():
    rows = [["a | b", "1e3"], ["<c>\nd", "0.50"], ["λ_s *e*", "∞"]]
    shown = prose(markdown_table(["law", "RMS [mrad]"], rows, align="lr"))
    cells = [html.unescape(re.sub("<[^>]+>", "", cell)) for cell in CELL.findall(shown)]
    assert cells == ["law", "RMS [mrad]", "a | b", "1e3", "<c> d", "0.50", "λ_s e", "∞"]


def test_a_comparison_stands_as_a_table(folder):
    lines = ["# Laws", "", "## UR5", "", "| law | RMS |", "|---|---:|", "| <new> | 0.5 |"]
    (folder / "comparison.md").write_text("\n".join(lines), "utf-8")
    page = write_report(folder).read_text("utf-8")
    assert re.search(r'<th scope="col">law</th>\s*<th scope="col">RMS</th>', page)
    assert re.search(r'<th scope="row">&lt;new&gt;</th>\s*<td>0.5</td>', page)
    assert page.count('aria-label="Table"') == 1
    assert "Laws" not in page


def test_own_figures_of_the_folder_are_inlined(folder):
    fp.plot(fp.Recording.load(folder / "run.npz"), folder / "my_torques.svg", kind="torque")
    page = write_report(folder).read_text("utf-8")
    assert page.count("<figure>") == 1
    assert 'alt="my torques"' in page


def test_names_cannot_break_out(folder):
    rec = fp.Recording.load(folder / "run.npz")
    hostile = '"><script>alert(1)</script>'
    fp.Recording(**{**vars(rec), "metadata": {"controller": hostile, hostile: hostile}}).save(
        folder / "run.npz"
    )
    page = write_report(folder, title=hostile).read_text("utf-8")
    assert "<script>alert" not in page
    assert "<script" not in outside_the_frame(page)


@pytest.mark.parametrize(
    ("name", "content"),
    [("metrics.json", "{"), ("metrics.json", "[1]"), ("metrics.json", '{"runs": 3}')],
)
def test_damaged_results_are_refused_and_no_page_is_left(folder, name, content):
    (folder / name).write_text(content, "utf-8")
    with pytest.raises(fp.errors.RecordingError, match=re.escape(name)):
        write_report(folder)
    assert not (folder / "report.html").exists()


def test_a_folder_without_runs_is_refused(tmp_path):
    with pytest.raises(fp.errors.RecordingError, match="holds no run"):
        write_report(tmp_path)


@pytest.mark.browser
def test_it_opens_offline_moves_and_passes_axe_in_light_and_dark(folder, chromium, output):
    (folder / "claims.md").write_text(CLAIMS, "utf-8")
    path = write_report(folder)
    context = chromium.new_context(offline=True, viewport={"width": 1280, "height": 900})
    page = context.new_page()
    told: list[str] = []
    requests: list[str] = []
    page.on("pageerror", lambda error: told.append(str(error)))
    page.on("console", lambda message: message.type == "error" and told.append(message.text))
    page.on("request", lambda request: requests.append(request.url))
    page.goto(path.as_uri())
    page.frame_locator("iframe").locator("html[data-ready=true]").wait_for(timeout=60_000)
    inner = next(frame for frame in page.frames if frame != page.main_frame)
    before = inner.evaluate("fotsmc.seek(0), fotsmc.capture()")
    assert inner.evaluate("fotsmc.seek(0.8), fotsmc.capture()") != before
    page.evaluate((Path(__file__).parent / "assets/axe.min.js").read_text("utf-8"))
    for scheme in ("light", "dark"):
        page.emulate_media(color_scheme=scheme)
        found = page.evaluate("axe.run({iframes: false})")
        assert [violation["id"] for violation in found["violations"]] == [], scheme
        page.screenshot(path=output / f"report_{scheme}.png", full_page=True)
    assert told == []
    assert [url for url in requests if not url.startswith("data:")] == [path.as_uri()]
    context.close()
