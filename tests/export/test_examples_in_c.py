"""The examples in C and C++: compiled and run, or read for their syntax."""

import runpy
import subprocess
import sysconfig
from pathlib import Path

import pytest

import fotsmc_pin as fp

from .compiled_c import STRICT
from .conftest import DT, arm_named

EXAMPLES = Path(__file__).parents[2] / "examples"
WHEEL = Path(sysconfig.get_paths()["purelib"]) / "cmeel.prefix"
BOOST = (
    "-DBOOST_MPL_LIMIT_LIST_SIZE=30",
    "-DBOOST_MPL_LIMIT_VECTOR_SIZE=30",
    "-DBOOST_MPL_CFG_NO_PREPROCESSED_HEADERS",
    "-DBOOST_FUSION_INVOKE_MAX_ARITY=12",
    "-DPINOCCHIO_ENABLE_TEMPLATE_INSTANTIATION",
)


def run(*command):
    done = subprocess.run([*map(str, command)], capture_output=True, text=True, check=False)
    assert not done.returncode, f"{done.stdout[-1500:]}{done.stderr[-3000:]}"
    return done.stdout


def test_a_recording_is_repeated_under_sanitizers(tmp_path, capsys):
    made = tmp_path / "made"
    runpy.run_path(str(EXAMPLES / "export_to_c.py"))["main"](made, duration=0.1)
    assert "101 ticks" in capsys.readouterr().out
    program = tmp_path / "replay"
    sanitizers = ("-O0", "-g", "-fsanitize=address,undefined", "-fno-sanitize-recover=all")
    files = (made / "fotsmc_panda.c", EXAMPLES / "c" / "replay.c")
    run("gcc", *STRICT, *sanitizers, *files, f"-I{made}", "-lm", "-o", program)
    assert "101 ticks" in run(program, made / "ticks.txt")


@pytest.mark.parametrize("name", ["libfranka_callback", "ros2_controller"])
def test_what_needs_a_robot_is_read_for_its_syntax(name, tmp_path):
    """Against stand-ins for the libraries, which declare what the example uses."""
    fp.export_c(fp.Safeguard(fp.RobustFONFTSM(arm_named("panda"), DT)), tmp_path)
    stubs = Path(__file__).parent / "stand_ins"
    source = EXAMPLES / "c" / f"{name}.cpp"
    run(
        "g++",
        "-std=c++17",
        "-Wall",
        "-Wextra",
        "-fsyntax-only",
        f"-I{tmp_path}",
        f"-I{stubs}",
        source,
    )


@pytest.mark.long
@pytest.mark.parametrize("name", ["pinocchio_loop", "learning_loop"])
def test_pinocchio_closes_the_loop(name, tmp_path):
    arm = arm_named("panda")
    law = fp.RobustFONFTSM(arm, DT)
    fp.export_c(fp.ModelLearning(law, delay=0) if name == "learning_loop" else law, tmp_path)
    arm.write_urdf(tmp_path / "panda.urdf")
    program, part = tmp_path / name, tmp_path / "law.o"
    run("gcc", *STRICT, "-c", tmp_path / "fotsmc_panda.c", "-o", part)
    run(
        *("g++", "-std=c++17", "-O1", *BOOST, f"-I{tmp_path}", f"-I{WHEEL / 'include'}"),
        *(
            "-I/usr/include/eigen3",
            EXAMPLES / "c" / f"{name}.cpp",
            part,
            f"-L{WHEEL / 'lib'}",
        ),
        *(
            f"-Wl,-rpath,{WHEEL / 'lib'}",
            "-lpinocchio_default",
            "-lpinocchio_parsers",
            "-o",
            program,
        ),
    )
    assert "mrad" in run(program, tmp_path / "panda.urdf")
