"""Meshes read from files: the triangles that Pinocchio reads, and the colours that it drops."""

from __future__ import annotations

import numpy as np
import pytest
from defusedxml import DefusedXmlException

import fotsmc_pin as fp
from fotsmc_pin.view import visuals
from fotsmc_pin.view.mesh_files import read_collada, read_stl

COLLADA = """<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<library_effects>
<effect id="fx-red"><profile_COMMON><technique sid="c"><phong><diffuse><color>1 0 0 1</color>
</diffuse></phong></technique></profile_COMMON></effect>
<effect id="fx-blue"><profile_COMMON><technique sid="c"><lambert><diffuse><color>0 0 1 1</color>
</diffuse></lambert></technique></profile_COMMON></effect>
</library_effects>
<library_materials>
<material id="red"><instance_effect url="#fx-red"/></material>
<material id="blue"><instance_effect url="#fx-blue"/></material>
</library_materials>
<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="pa" count="15">0 0 0 1 0 0 1 1 0 0 1 0 0 0 1</float_array>
<technique_common><accessor source="#pa" count="5" stride="3"/></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<polylist material="a" count="1"><input semantic="VERTEX" source="#v" offset="0"/>
<input semantic="NORMAL" source="#n" offset="1"/><vcount>4</vcount><p>0 9 1 9 2 9 3 9</p></polylist>
<triangles material="b" count="1"><input semantic="VERTEX" source="#v" offset="0"/>
<p>0 1 4</p></triangles>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s">
<node><translate>0 0 10</translate><rotate>0 0 1 90</rotate>
<node><scale>2 2 2</scale><instance_geometry url="#g"><bind_material><technique_common>
<instance_material symbol="a" target="#red"/><instance_material symbol="b" target="#blue"/>
</technique_common></bind_material></instance_geometry></node></node>
</visual_scene></library_visual_scenes>
</COLLADA>"""


def test_collada_gives_triangles_placed_by_its_nodes_in_their_colours(tmp_path):
    file = tmp_path / "two.dae"
    file.write_text(COLLADA)
    mesh = read_collada(file)
    assert mesh.paint == (((1.0, 0.0, 0.0, 1.0), 2), ((0.0, 0.0, 1.0, 1.0), 1))
    corners = mesh.vertices[mesh.faces]
    square = [[0, 0, 10], [0, 2, 10], [-2, 2, 10]], [[0, 0, 10], [-2, 2, 10], [-2, 0, 10]]
    np.testing.assert_allclose(corners[:2], square, atol=1e-12)
    np.testing.assert_allclose(corners[2], [[0, 0, 10], [0, 2, 10], [0, 0, 12]], atol=1e-12)


def test_collada_without_triangles_is_refused(tmp_path):
    file = tmp_path / "empty.dae"
    file.write_text("<COLLADA><library_visual_scenes/></COLLADA>")
    with pytest.raises(ValueError, match="no triangles"):
        read_collada(file)


def test_collada_that_would_swell_in_memory_is_refused(tmp_path):
    file = tmp_path / "bomb.dae"
    file.write_text('<!DOCTYPE a [<!ENTITY x "xx"><!ENTITY y "&x;&x;">]><COLLADA>&y;</COLLADA>')
    with pytest.raises(DefusedXmlException):
        read_collada(file)


def test_stl_that_is_not_binary_or_cut_off_is_refused(tmp_path):
    file = tmp_path / "part.stl"
    for data in (b"solid ascii\n" + b" " * 200, b"", b"\0" * 80 + b"\x02\0\0\0" + b"\0" * 50):
        file.write_bytes(data)
        with pytest.raises(ValueError, match="STL"):
            read_stl(file)


@pytest.mark.parametrize("name", ["panda", "so101"])
def test_own_readers_see_what_pinocchio_sees(name):
    """So the picture is complete, and a link is where Pinocchio's kinematics has it."""
    items = fp.load_arm(name).visual_model().geometryObjects
    assert len(items) > 8
    for item in items:
        mesh = visuals._from_file(item)
        assert mesh is not None, item.name
        # Pinocchio drops a few faces without area.
        assert len(mesh.faces) == pytest.approx(item.geometry.num_tris, rel=2e-3)
        reference = np.array(item.geometry.vertices())
        np.testing.assert_allclose(mesh.vertices.min(axis=0), reference.min(axis=0), atol=1e-5)
        np.testing.assert_allclose(mesh.vertices.max(axis=0), reference.max(axis=0), atol=1e-5)


def test_materials_of_the_panda_survive():
    meshes = [visual.mesh for visual in visuals.visuals_of(fp.load_arm("panda"))]
    colors = {color for mesh in meshes for color, _ in mesh.paint}
    assert any(max(color[:3]) < 0.4 for color in colors), "its dark parts"
    assert any(min(color[:3]) > 0.8 for color in colors), "its white parts"


def test_a_mesh_that_cannot_be_read_leaves_the_joints_to_draw(tmp_path):
    (tmp_path / "broken.dae").write_text("<COLLADA/>")
    (tmp_path / "arm.urdf").write_text(
        """<robot name="arm"><link name="a"/><link name="b"><inertial><mass value="1"/>
        <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
        <visual><geometry><mesh filename="broken.dae"/></geometry></visual></link>
        <joint name="turn" type="continuous"><parent link="a"/><child link="b"/>
        <axis xyz="0 0 1"/><origin xyz="0 0 0.5"/></joint></robot>"""
    )
    arm = fp.load_arm(tmp_path / "arm.urdf")
    with pytest.warns(UserWarning, match="drawn from its joints"):
        drawn = visuals.visuals_of(arm)
    assert "turn" in [visual.name for visual in drawn]
