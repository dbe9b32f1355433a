"""The check of the site finds what it is for, on a site of two pages."""

import pytest

from tests.site_check.links import follow

GOOD = '<h1 id="top">a</h1><a href="b/other.html#far">b</a><a href="#top">top</a>'


@pytest.fixture
def site(tmp_path):
    (tmp_path / "b").mkdir()
    (tmp_path / "index.html").write_text(GOOD)
    (tmp_path / "b/other.html").write_text('<p id="far"></p><a href="../index.html?x=1">back</a>')
    return tmp_path


def test_a_sound_site_has_no_dead_link(site):
    links = follow(site)
    assert links.dead == []
    assert (links.pages, links.inside, links.anchors) == (2, 3, 2)


@pytest.mark.parametrize(
    ("reference", "why"),
    [
        ("gone.html", "no such file"),
        ("b/Other.html", "no such file"),
        ("b/other.html#near", "no such anchor"),
        ("#bottom", "no such anchor"),
        ("/absolute.html", "no such file"),
    ],
)
def test_a_dead_link_is_found(site, reference, why):
    (site / "index.html").write_text(f'{GOOD}<a href="{reference}">x</a>')
    assert follow(site).dead == [f"index.html: {reference}: {why}"]


def test_what_a_search_leads_to_is_followed_too(site):
    (site / "search").mkdir()
    index = '{"docs": [{"location": "b/other.html#far"}, {"location": "b/other.html#no"}]}'
    (site / "search/search_index.js").write_text(f"var __index = {index}")
    assert follow(site).dead == ["search: b/other.html#no: no such anchor"]


def test_addresses_outside_are_counted_and_not_followed(site):
    (site / "index.html").write_text(f'{GOOD}<a href="https://example.org/x">x</a>')
    links = follow(site)
    assert list(links.outside) == ["https://example.org/x"]
    assert links.dead == []
