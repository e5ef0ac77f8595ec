"""A server and an axis: processes of their own, or those at PORTAMENTO_SERVER and PORTAMENTO_SIM_AXIS, to whose axis the server is what
PORTAMENTO_PLANNER says."""

import os
import queue
import re
import subprocess
import threading
from pathlib import Path

import pytest

import portamento

ROOT = Path(__file__).parents[3]
BINARIES = Path(os.environ.get("PORTAMENTO_BINARIES", ROOT / "target" / "debug"))


def listening(name):
    """Starts a process on any free port; where it listens."""
    process = subprocess.Popen([BINARIES / name, "--listen", "127.0.0.1:0", "--drain-deadline", "1"], text=True,
                               stdout=subprocess.PIPE, stderr=subprocess.STDOUT, env={**os.environ, "RUST_LOG": "info"})
    lines = queue.Queue()
    threading.Thread(target=lambda: [lines.put(line) for line in process.stdout], daemon=True).start()
    said = ""
    while not (found := re.search(r" serving address=(\S+)", said)):
        said += lines.get(timeout=20)
    return process, found[1]


@pytest.fixture(scope="session")
def addresses():
    if "PORTAMENTO_SERVER" in os.environ:
        yield {"server": os.environ["PORTAMENTO_SERVER"], "sim-axis": os.environ["PORTAMENTO_SIM_AXIS"]}
        return
    processes = {name: listening(f"portamento-{name}") for name in ["server", "sim-axis"]}
    yield {name: address for name, (_, address) in processes.items()}
    for process, _ in processes.values():
        process.terminate()
        process.wait(timeout=20)


@pytest.fixture
def server(addresses):
    with portamento.Server(addresses["server"]) as server:
        yield server


@pytest.fixture
def axis(addresses):
    with portamento.SimAxis(addresses["sim-axis"]) as axis:
        yield axis


@pytest.fixture
def planners(addresses):
    return [os.environ.get("PORTAMENTO_PLANNER", f"http://{addresses['server']}")]


@pytest.fixture
def limits():
    return portamento.Limits(velocity=0.25, acceleration=3, jerk=100)


def run_portamento(*args, cwd=None, check=True):
    return subprocess.run([BINARIES / "portamento", *map(str, args)], text=True, capture_output=True, cwd=cwd, check=check)
