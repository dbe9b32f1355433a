"""Runs commands of `fotsmc`, each in a process of its own that has imported everything already.

Most of a short command's time goes to imports and to the loading of compiled kernels. This program
does both once; for each request it then forks, so that no command sees what another one did.

Requests come as lines of JSON (`words`, `folder`, `environment`, `timeout`, and the files `out` and
`err`); each is answered by a line with the exit code, negative where a signal ended it.
"""

import json
import os
import signal
import sys


def load():
    """Import what commands use, and let a run load its kernels."""
    import fotsmc_pin as fp
    from fotsmc_pin.references import Sinusoid

    parts = ("cli", "evaluation", "identification", "learning", "paper", "simulation", "view")
    for name in parts:
        __import__(f"fotsmc_pin.{name}")
    import matplotlib.pyplot  # noqa: F401
    import meshcat  # noqa: F401

    arm = fp.load_arm("two_link")
    fp.simulate(arm, fp.RobustFONFTSM(arm, 1e-3), Sinusoid.inside_limits(arm), 0.01)


def run(request):
    """Be the command: in its folder, with its environment and output."""
    signal.alarm(request["timeout"])
    os.chdir(request["folder"])
    os.environ.clear()
    os.environ.update(request["environment"])
    for number, name in ((1, "out"), (2, "err")):
        file = os.open(request[name], os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
        os.dup2(file, number)
    sys.path.insert(0, request["folder"])
    sys.argv = ["fotsmc", *request["words"]]
    from fotsmc_pin.cli import main

    main()


def exit_code(error):
    """Return what Python itself would return where this left the program."""
    if not isinstance(error, SystemExit):
        sys.excepthook(type(error), error, error.__traceback__)
        return 1
    if isinstance(error.code, str):
        sys.stderr.write(f"{error.code}\n")
        return 1
    return error.code or 0


def serve():
    load()
    for line in sys.stdin:
        child = os.fork()
        if child == 0:
            code = 0
            try:
                run(json.loads(line))
            except BaseException as error:
                code = exit_code(error)
            sys.stdout.flush()
            sys.stderr.flush()
            os._exit(code)
        _, status = os.waitpid(child, 0)
        sys.stdout.write(f"{os.waitstatus_to_exitcode(status)}\n")
        sys.stdout.flush()


if __name__ == "__main__":
    serve()
