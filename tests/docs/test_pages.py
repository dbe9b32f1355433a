"""The documentation: its Python runs, its commands are understood, and nothing is left out."""

from __future__ import annotations

import re
import shlex
import shutil
import sys
import textwrap
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING

import pytest
import typer

import fotsmc_pin as fp
from fotsmc_pin.cli import app
from fotsmc_pin.control import CONTROLLERS

if TYPE_CHECKING:
    from collections.abc import Iterator

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").rglob("*.md"))]
PAGES = [page for page in PAGES if page.name != "VENDORED.md"]
FENCE = re.compile(r"^(?P<in> *)```(?P<language>\w*)[^\n]*\n(?P<code>.*?)^(?P=in)```", re.M | re.S)
SNIPPET = re.compile(r'--8<-- "(?P<path>[^"]+)"\s*\Z')
SHELL = ("", "sh", "bash", "console", "shell")


@dataclass(frozen=True, kw_only=True)
class Block:
    """A block of code: where it stands, and its text without the page's indentation."""

    page: Path
    line: int
    language: str
    code: str

    @property
    def snippet(self) -> Path | None:
        """The file that the block consists of, if it is nothing else."""
        found = SNIPPET.match(self.code)
        return ROOT / found["path"] if found else None


def blocks_of(page: Path) -> Iterator[Block]:
    """Yield the page's blocks from top to bottom."""
    text = page.read_text("utf-8")
    for found in FENCE.finditer(text):
        yield Block(
            page=page,
            line=text.count("\n", 0, found.start("code")) + 1,
            language=found["language"],
            code=textwrap.dedent(found["code"]),
        )


def name_of(page: Path) -> str:
    """Return the page's address from the repository's root."""
    return page.relative_to(ROOT).as_posix()


def commands_of(page: Path) -> Iterator[str]:
    """Yield every call of `fotsmc` in the page's shell blocks, without the way to the program."""
    for block in blocks_of(page):
        if block.language in SHELL:
            for line in block.code.replace("\\\n", " ").splitlines():
                for part in line.split("&&"):
                    found = re.match(r"\s*(?:\$ )?(?:\S*/)?fotsmc( .*)?$", part)
                    if found:
                        yield (found[1] or "").partition("  #")[0].strip()


PYTHON_PAGES = [page for page in PAGES if any(b.language == "python" for b in blocks_of(page))]
SHELL_PAGES = [page for page in PAGES if any(commands_of(page))]


@pytest.fixture
def reader(tmp_path, monkeypatch):
    """A folder in which a reader has a URDF of two joints, and a module to type into."""
    shutil.copy(ROOT / "urdf/two_link_nominal.urdf", tmp_path / "my.urdf")
    monkeypatch.chdir(tmp_path)
    module = ModuleType("a_readers_program")
    monkeypatch.setitem(sys.modules, module.__name__, module)
    return module


@pytest.mark.parametrize("page", PYTHON_PAGES, ids=name_of)
def test_python_blocks_run_from_top_to_bottom(page, reader):
    for block in blocks_of(page):
        if block.language != "python":
            continue
        if block.snippet is not None:
            assert block.snippet.is_file()  # The tests of the examples run it.
            continue
        padded = "\n" * (block.line - 1) + block.code
        code = compile(padded, f"<{name_of(page)}>", "exec", dont_inherit=True)
        exec(code, vars(reader))


@pytest.mark.parametrize("page", SHELL_PAGES, ids=name_of)
def test_commands_are_understood(page):
    program = typer.main.get_command(app)
    for command in commands_of(page):
        # Words in capitals stand for the reader's own.
        name, *arguments = shlex.split(re.sub(r"\b[A-Z]{3,}\b", "1", command))
        if name.startswith("-"):
            assert name in {option for p in program.params for option in p.opts} | {"--help"}
            continue
        known = program.get_command(None, name)
        assert known is not None, f"no command {name}"
        if "--help" not in arguments:
            known.make_context(name, arguments)


@pytest.mark.parametrize("page", SHELL_PAGES, ids=name_of)
def test_commands_work_as_typed_whether_or_not_the_environment_is_activated(page):
    """Each page activates the environment before its first bare `fotsmc`, or names the program."""
    shell = "\n".join(block.code for block in blocks_of(page) if block.language in SHELL)
    first = re.search(r"^(?:\$ )?fotsmc ", shell, re.MULTILINE)
    if first is not None:
        assert ". .venv/bin/activate" in shell[: first.start()]


def test_nobody_is_told_to_install_from_an_index_that_does_not_have_the_package():
    package = Path(fp.__file__).parent
    files = [*PAGES, *package.rglob("*.py"), *(ROOT / "tests").rglob("*.py")]
    named = re.compile(r"pip install [\"']?fotsmc[_-]pin")
    assert not [str(file) for file in files if named.search(file.read_text("utf-8"))]


def test_the_commands_of_the_documentation_are_found():
    found = {command.split()[0] for page in SHELL_PAGES for command in commands_of(page)}
    assert {"simulate", "reproduce", "report", "animate", "inspect"} <= found


DOCS = ROOT / "docs"
API = "\n".join(page.read_text("utf-8") for page in (DOCS / "api").glob("*.md"))
MENU = (ROOT / "mkdocs.yml").read_text("utf-8")


@pytest.mark.parametrize("page", [page for page in PAGES if page.parent != ROOT], ids=name_of)
def test_a_page_stands_in_the_menu(page):
    assert f": {page.relative_to(DOCS).as_posix()}\n" in MENU


@pytest.mark.parametrize("law", CONTROLLERS)
def test_a_law_and_its_gains_stand_in_the_api(law):
    assert f"::: fotsmc_pin.control.{law}\n" in API
    assert f".{CONTROLLERS[law].Gains.__name__}\n" in API


@pytest.mark.parametrize(
    "name", [name for name in fp.__all__ if name not in ("errors", "references", "__version__")]
)
def test_a_public_name_stands_in_the_api(name):
    assert re.search(rf"^::: fotsmc_pin\.[\w.]+\.{name}$", API, re.MULTILINE)


def test_the_gallery_shows_every_example_that_it_is_built_from():
    gallery = (DOCS / "gallery.md").read_text("utf-8")
    hook = (DOCS / "hooks/gallery.py").read_text("utf-8")
    shown = re.findall(r'--8<-- "examples/(\w+)\.py"', gallery)
    assert len(shown) >= 6
    for name in shown:
        assert f'"{name}"' in hook  # The build runs it.
        assert (DOCS / f"assets/gallery/{name}.jpg").is_file()


def test_the_site_names_no_server_to_fetch_from():
    for file in (MENU, *(path.read_text("utf-8") for path in DOCS.glob("javascripts/*.js"))):
        assert "http" not in file.replace("https://www.w3.org", "")
