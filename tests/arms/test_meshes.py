"""Meshes: found wherever packages lie, and never needed for dynamics."""

import pytest

from fotsmc_pin.arms import load_arm
from fotsmc_pin.errors import ArgumentError


def test_a_missing_mesh_is_a_warning_and_dynamics_do_not_care(made):
    mesh = '<visual><geometry><mesh filename="package://gone/arm.stl"/></geometry></visual>'
    parts = (made.link("arm", extra=mesh), made.joint("turn", "base", "arm"))
    arm = load_arm(made.file(*parts))
    assert arm.gravity([0.1]).shape == (1,)
    with pytest.warns(UserWarning, match=r"gone/arm.stl.*'arm'.*is not there"):
        assert len(arm.visual_model().geometryObjects) == 0


def test_meshes_beside_the_file_are_found_wherever_it_is_written(made):
    (made.folder / "tri.stl").write_text(
        "solid t\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
        "endloop\nendfacet\nendsolid t\n"
    )
    mesh = '<visual><geometry><mesh filename="tri.stl"/></geometry></visual>'
    parts = (made.link("arm", extra=mesh), made.joint("turn", "base", "arm"))
    (made.folder / "elsewhere").mkdir()
    copy = load_arm(made.file(*parts)).write_urdf(made.folder / "elsewhere" / "copy.urdf")
    assert len(load_arm(copy).visual_model().geometryObjects) == 1


def test_example_robot_data_meshes_are_found_from_a_written_file(tmp_path):
    arm = load_arm(load_arm("asr_twodof").write_urdf(tmp_path / "arm.urdf"))
    assert len(arm.visual_model().geometryObjects) == 7


@pytest.mark.parametrize(
    ("variable", "folder"), [("ROS_PACKAGE_PATH", "w/src"), ("AMENT_PREFIX_PATH", "w/share")]
)
def test_packages_of_ros_are_found(made, monkeypatch, variable, folder):
    meshes = made.folder / folder / "my_arm"
    meshes.mkdir(parents=True)
    (meshes / "tri.stl").touch()
    root = made.folder / ("w" if folder.endswith("share") else folder)
    monkeypatch.setenv(variable, f"/nowhere:{root}")
    mesh = '<visual><geometry><mesh filename="package://my_arm/tri.stl"/></geometry></visual>'
    path = made.file(made.link("arm", extra=mesh), made.joint("turn", "base", "arm"))
    assert load_arm(path).package_dirs == (str(made.folder / folder),)


def test_package_dirs_must_be_a_list():
    with pytest.raises(ArgumentError, match="package_dirs"):
        load_arm("two_link", package_dirs="meshes")
