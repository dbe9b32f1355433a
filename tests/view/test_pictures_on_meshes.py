"""Pictures on COLLADA meshes: kept at full quality, left out of compact pages."""

from __future__ import annotations

import base64
import io

import numpy as np
import pytest
from PIL import Image

import fotsmc_pin as fp
from fotsmc_pin.view.mesh_files import read_collada

PLATE = """<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<library_images><image id="pic"><init_from>half%20and%20half.png</init_from></image>
</library_images><library_effects><effect id="fx"><profile_COMMON>
<newparam sid="surface"><surface type="2D"><init_from>pic</init_from></surface></newparam>
<newparam sid="sampler"><sampler2D><source>surface</source></sampler2D></newparam>
<technique sid="c"><lambert><diffuse><texture texture="sampler" texcoord="uv"/></diffuse></lambert>
</technique></profile_COMMON></effect></library_effects>
<library_materials><material id="m"><instance_effect url="#fx"/></material></library_materials>
<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="pa" count="12">0 -.5 0 0 .5 0 0 .5 1 0 -.5 1</float_array>
<technique_common><accessor source="#pa" count="4" stride="3"><param name="X" type="float"/>
<param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<source id="t"><float_array id="ta" count="8">0 0 1 0 1 1 0 1</float_array>
<technique_common><accessor source="#ta" count="4" stride="2"><param name="S" type="float"/>
<param name="T" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<polylist material="a" count="1"><input semantic="VERTEX" source="#v" offset="0"/>
<input semantic="TEXCOORD" source="#t" offset="1"/><vcount>4</vcount><p>0 0 1 1 2 2 3 3</p>
</polylist></mesh></geometry></library_geometries><library_visual_scenes>
<visual_scene id="s"><node>
<instance_geometry url="#g"><bind_material><technique_common>
<instance_material symbol="a" target="#m"/></technique_common></bind_material>
</instance_geometry></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>"""
URDF = """<robot name="plate"><link name="base"/><link name="plate">
<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
<visual><geometry><mesh filename="plate.dae"/></geometry></visual></link>
<joint name="turn" type="revolute"><parent link="base"/><child link="plate"/><axis xyz="0 0 1"/>
<limit lower="-1" upper="1" effort="10" velocity="1"/></joint></robot>"""


@pytest.fixture
def plate(tmp_path) -> fp.Arm:
    """An arm that is a plate, green on its left half and red on its right."""
    pixels = np.zeros((8, 8, 3), np.uint8)
    pixels[:, :4, 1] = pixels[:, 4:, 0] = 255
    Image.fromarray(pixels).save(tmp_path / "half and half.png")
    (tmp_path / "plate.dae").write_text(PLATE)
    (tmp_path / "plate.urdf").write_text(URDF)
    return fp.load_arm(tmp_path / "plate.urdf")


def test_collada_tells_where_its_picture_goes(plate, tmp_path):
    mesh = read_collada(tmp_path / "plate.dae")
    assert mesh.skin is not None
    assert mesh.skin.images == (tmp_path / "half and half.png",)
    np.testing.assert_array_equal(
        mesh.skin.uv, [[[0, 0], [1, 0], [1, 1]], [[0, 0], [1, 1], [0, 1]]]
    )


def test_a_picture_that_is_not_there_is_done_without(plate, tmp_path):
    (tmp_path / "half and half.png").unlink()
    assert read_collada(tmp_path / "plate.dae").skin is None


@pytest.mark.browser
def test_full_quality_shows_the_picture_and_compact_does_not(
    plate, make_recording, open_page, tmp_path
):
    run = make_recording(plate, duration=0.5)
    run = make_recording(plate, duration=0.5, q=0 * run.q, q_d=0 * run.q)
    seen = {}
    for quality in ("full", "compact"):
        path = fp.export_html(
            run, tmp_path / f"{quality}.html", quality=quality, ghost=False, paths="off", play=False
        )
        page = open_page(path, viewport={"width": 500, "height": 500})
        data = page.run("fotsmc.capture()").partition(",")[2]
        picture = Image.open(io.BytesIO(base64.b64decode(data))).convert("RGBA")
        red, green, _, solid = np.moveaxis(np.asarray(picture, dtype=float), -1, 0)
        colored = [red > green + 80, green > red + 80]
        seen[quality] = [np.argwhere(where & (solid == 255)) for where in colored]
        assert page.complaints == []
    reds, greens = seen["full"]
    assert min(len(reds), len(greens)) > 100
    # The camera looks against x, with y to the right.
    assert greens[:, 1].mean() < reds[:, 1].mean()
    assert [len(found) for found in seen["compact"]] == [0, 0]
