"""The command line as its users run it: in a process of its own, in an empty folder."""

import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="session")
def warm_process():
    """A program that has everything imported, and forks for each command."""
    server = [sys.executable, "-m", "tests.cli.warm_process"]
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "text": True}
    with subprocess.Popen(server, cwd=ROOT, env=environ(), **pipes) as process:
        yield process
        process.stdin.close()


@pytest.fixture
def fotsmc(tmp_path, warm_process):
    """Run `fotsmc` with these words in `tmp_path`; the environment may be widened."""

    def call(*words, timeout=240, **environment):
        files = {name: tmp_path.with_name(f"{tmp_path.name}.{name}") for name in ("out", "err")}
        request = {
            "words": [str(word) for word in words],
            "folder": str(tmp_path),
            "environment": environ(**environment),
            "timeout": timeout,
            **{name: str(path) for name, path in files.items()},
        }
        warm_process.stdin.write(json.dumps(request) + "\n")
        warm_process.stdin.flush()
        code = int(warm_process.stdout.readline())
        texts = [path.read_text("utf-8") for path in files.values()]
        return subprocess.CompletedProcess(command(words), code, *texts)

    return call


@pytest.fixture
def new_fotsmc(tmp_path):
    """The same in a process that is started anew, as a shell does it."""

    def call(*words, timeout=240, preexec_fn=None, **environment):
        return subprocess.run(
            command(words),
            cwd=tmp_path,
            capture_output=True,
            text=True,
            timeout=timeout,
            check=False,
            env=environ(**environment),
            preexec_fn=preexec_fn,
        )

    return call


def heed_interrupts():
    """Undo what a shell does to programs in its background: they ignore Ctrl-C."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


@pytest.fixture
def started(tmp_path):
    """Start `fotsmc` in a session of its own, and see to it that nothing of it stays."""
    processes = []

    def start(*words):
        process = subprocess.Popen(
            command(words),
            preexec_fn=heed_interrupts,
            cwd=tmp_path,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            start_new_session=True,
            env=environ(),
        )
        processes.append(process)
        return process

    yield start
    for process in processes:
        process.kill()
        process.communicate()


def command(words):
    return [sys.executable, "-m", "fotsmc_pin", *map(str, words)]


def environ(**more):
    return os.environ | {"PYTHONPATH": str(ROOT), "COLUMNS": "80"} | more
