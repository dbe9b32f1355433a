"""The URDF reader keeps what it does not know and stands between files and the machine."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fotsmc_pin.arms.markup import parse_urdf, urdf_text
from fotsmc_pin.errors import UrdfError


def test_text_survives_the_round_trip():
    body = '<robot name="é &amp; ü"><a b="1 &lt; 2">x<!-- c - d --><ns:e f="&quot;"/>y</a>z</robot>'
    once = urdf_text(parse_urdf(body, "test"))
    assert urdf_text(parse_urdf(once, "test")) == once
    for part in ("é &amp; ü", "x<!-- c - d -->", "<ns:e", "/>y", "</a>z"):
        assert part in once


def test_bytes_follow_their_declared_encoding():
    text = '<?xml version="1.0" encoding="latin-1"?><robot name="Müller"/>'
    assert parse_urdf(text.encode("latin-1"), "test").get("name") == "Müller"


def test_a_comment_cannot_break_out():
    text = urdf_text(parse_urdf("<robot/>", "test"), "mass --> <link/> -- 1.1 ---")
    robot = parse_urdf(text, "test")
    assert len(robot) == 0


@given(st.binary(max_size=200))
def test_noise_is_refused_or_parsed_and_never_else(noise):
    try:
        root = parse_urdf(noise, "noise")
    except UrdfError:
        return
    assert root.tag == "robot"


@pytest.mark.parametrize("text", ["", " ", "<robot", "<a/>"])
def test_what_is_no_urdf_is_refused(text):
    with pytest.raises(UrdfError, match=r"^here: "):
        parse_urdf(text, "here")
