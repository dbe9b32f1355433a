"""Imports go one way, and the heavy libraries stay in few packages: read from the source."""

import ast
import subprocess
import sys
from pathlib import Path

import pytest

import fotsmc_pin

ROOT = Path(fotsmc_pin.__file__).parent
"""Of the source that the tests run: a checkout's, or that of an installed wheel."""
GROUND = {
    "errors",
    "checks",
    "compiled",
    "files",
    "types",
    "progress",
    "copying",
    "user_warnings",
    "notebook",
}

LARGEST_TOP_LEVEL = 14
"""So many packages can be read at a glance."""

BELOW_ANALYSIS = {"fractional", "arms", "references", "control", "simulation"}
BELOW_VIEW = BELOW_ANALYSIS | {"analysis", "learning", "evaluation", "identification"}

MAY_IMPORT = {
    "fractional": set(),
    "arms": set(),
    "references": {"arms"},
    "control": {"fractional", "arms", "references"},
    "simulation": BELOW_ANALYSIS - {"simulation"},
    "analysis": BELOW_ANALYSIS,
    "realtime": BELOW_ANALYSIS,
    "learning": BELOW_ANALYSIS | {"analysis"},
    "evaluation": BELOW_ANALYSIS | {"analysis", "learning"},
    "identification": BELOW_ANALYSIS,
    "export": {"fractional", "arms", "control", "learning"},
    "view": BELOW_VIEW,
    "paper": BELOW_VIEW | {"view"},
}
"""What each package may import at all, also inside functions; `cli` may import any."""

# References: a straight line of the tool needs inverse kinematics, an excitation the regressor.
KEEPERS = {
    "pinocchio": {
        "arms",
        "simulation",
        "control",
        "learning",
        "identification",
        "view",
        "references",
    },
    "meshcat": {"view"},
    "matplotlib": {"view"},
    "pylibfranka": {"realtime"},
    "rtde_control": {"realtime"},
    "rtde_receive": {"realtime"},
}
LATE = {"meshcat", "matplotlib", "pylibfranka", "rtde_control", "rtde_receive"}
"""Libraries that are imported when called, and not when the library is."""


def package_of(path):
    return path.relative_to(ROOT).parts[0].removesuffix(".py")


def imports(path):
    """Names that a module imports when it runs, each with whether that is at its top level."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    for node in ast.walk(tree):
        for child in ast.iter_child_nodes(node):
            child.parent = node
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: imports are written out"
            names = [f"{node.module}.{alias.name}" for alias in node.names]
        else:
            continue
        above = list(ancestors(node))
        if any(isinstance(a, ast.If) and "TYPE_CHECKING" in ast.unparse(a.test) for a in above):
            continue
        late = any(isinstance(a, ast.FunctionDef) for a in above)
        for name in names:
            yield name, not late


def ancestors(node):
    while hasattr(node, "parent"):
        node = node.parent
        yield node


def modules(*packages):
    return [
        path for path in sorted(ROOT.rglob("*.py")) if not packages or package_of(path) in packages
    ]


def package_imported(name):
    parts = name.split(".")
    return parts[1] if parts[0] == "fotsmc_pin" and len(parts) > 1 else None


@pytest.mark.parametrize("package", sorted(MAY_IMPORT))
def test_a_package_imports_only_what_lies_below_it(package):
    allowed = MAY_IMPORT[package] | GROUND | {package}
    found = {
        (path.name, name)
        for path in modules(package)
        for name, _ in imports(path)
        if package_imported(name) not in {None, *allowed}
    }
    assert not found


@pytest.mark.parametrize("package", sorted(MAY_IMPORT))
def test_there_is_something_to_hold(package):
    assert any(package_imported(name) for path in modules(package) for name, _ in imports(path))


def test_every_package_has_its_place():
    packages = {path.parent.name for path in ROOT.glob("*/__init__.py")}
    assert packages == {*MAY_IMPORT, "cli"}
    assert len(packages) <= LARGEST_TOP_LEVEL


def test_inside_evaluation_only_the_stress_scenarios_tune():
    between = {
        (path.relative_to(ROOT).parts[1], name.split(".")[2])
        for path in modules("evaluation")
        for name, _ in imports(path)
        if name.startswith("fotsmc_pin.evaluation.")
    }
    assert {pair for pair in between if pair[0] != pair[1]} == {("stress", "tuning")}


def test_the_ground_imports_nothing_above_it():
    for path in modules(*GROUND):
        assert {package_imported(name) for name, _ in imports(path)} <= {None, *GROUND}


@pytest.mark.parametrize("library", sorted(KEEPERS))
def test_only_their_keepers_know_the_heavy_libraries(library):
    knowing = {
        package_of(path)
        for path in modules()
        for name, _ in imports(path)
        if name.split(".")[0] == library
    }
    assert knowing <= KEEPERS[library]


def test_the_reader_of_imports_sees_them():
    assert ("pinocchio", True) in set(imports(ROOT / "control" / "controller.py"))
    assert any(name.startswith("matplotlib") for p in modules("view") for name, _ in imports(p))


def test_the_late_libraries_are_imported_when_called():
    early = {
        (path.name, name)
        for path in modules()
        for name, at_top in imports(path)
        if at_top and name.split(".")[0] in LATE
    }
    assert not early


def test_the_leaves_of_fractional_know_only_numpy_scipy_and_numba():
    known = {"numpy", "scipy", "numba", "fotsmc_pin"}
    for path in modules("fractional"):
        for name, _ in imports(path):
            top = name.split(".")[0]
            assert top in known or top in sys.stdlib_module_names, (path.name, name)


def test_importing_the_library_loads_none_of_the_heavy_ones():
    code = (
        "import sys, fotsmc_pin; "
        "print(sorted({'pinocchio', 'meshcat', 'matplotlib', 'numba', 'typer'} & set(sys.modules)))"
    )
    shown = subprocess.run(
        [sys.executable, "-c", code], check=True, capture_output=True, text=True, cwd=ROOT.parent
    )
    assert shown.stdout.strip() == "[]"
