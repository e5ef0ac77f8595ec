"""A server with its console, an axis, and a browser that looks at them."""

import os
import queue
import re
import subprocess
import threading
from pathlib import Path

import pytest
from feed import Feed
from playwright.sync_api import sync_playwright

BINARIES = Path(__file__).parents[2] / "target" / "debug"
PAGES = Path(__file__).parents[2] / "server/src/console/page"
FLAGS = ["--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking",
         "--disable-component-update", "--disable-sync"]


class Process:
    """One of our processes, with the addresses that it says it has."""

    def __init__(self, name, *args, says):
        environment = {**os.environ, "RUST_LOG": "info", "NO_COLOR": "1"}
        self.process = subprocess.Popen([BINARIES / name, *args], stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                        text=True, env=environment)
        self.lines = queue.Queue()
        # To its end: a process whose words nobody reads stands still some day.
        threading.Thread(target=lambda: [self.lines.put(line) for line in self.process.stdout], daemon=True).start()
        self.addresses = {what: self.hear(rf" {what} address=(\S+)") for what in says}

    def hear(self, pattern):
        """What the process says that looks so."""
        said = ""
        while not (found := re.search(pattern, said)):
            said += self.lines.get(timeout=20)
        return found[1]

    def stop(self):
        self.process.terminate()
        self.process.wait(timeout=20)


@pytest.fixture(scope="session")
def server():
    server = Process("portamento-server", "--listen", "127.0.0.1:0", "--http", "127.0.0.1:0", "--drain-deadline", "1",
                     says=["serving", "serving HTTP"])
    yield server
    server.stop()


@pytest.fixture(scope="session")
def axis():
    model = Path(__file__).parent / "axis.json"
    axis = Process("portamento-sim-axis", "--listen", "127.0.0.1:0", "--drain-deadline", "1", "--model", model,
                   says=["serving"])
    yield axis
    axis.stop()


@pytest.fixture(scope="session")
def light_axis():
    """One that follows exactly: twenty of them fit on a small machine."""
    axis = Process("portamento-sim-axis", "--listen", "127.0.0.1:0", "--drain-deadline", "1", says=["serving"])
    yield axis
    axis.stop()


@pytest.fixture
def feed():
    feed = Feed(20)
    yield feed
    feed.stop()


def portamento(*args, **more):
    return subprocess.run([BINARIES / "portamento", *map(str, args)], text=True, capture_output=True, check=True, **more)


@pytest.fixture
def track(server, axis, tmp_path):
    """Has the axis play a move of `distance` m, in the background, under the name given."""
    running = []

    def begin(stream, distance=2.0, at=axis):
        plan = tmp_path / f"{len(running)}.json"
        portamento("plan", "--distance", distance, "--max-velocity", 0.25, "--max-acceleration", 3, "--max-jerk", 100,
                   "--output", plan)
        running.append(subprocess.Popen(
            [BINARIES / "portamento", "track", "--plan", plan, "--stream", stream, "--lead", "250", "--endpoint",
             f"http://{at.addresses['serving']}", "--planner", f"http://{server.addresses['serving']}"],
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL))

    yield begin
    for process in running:
        process.kill()
        process.wait()


@pytest.fixture(scope="session")
def browser():
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path="/usr/bin/chromium", args=FLAGS)
        yield browser
        browser.close()


@pytest.fixture
def open_console(browser, server):
    """Opens a view, in the scheme and size asked for. Whatever the page complains of fails the test."""
    contexts, complaints = [], []
    home = f"http://{server.addresses['serving HTTP']}/console/"

    def opened(view="explorer", scheme="light", width=1280, height=900, at=None):
        context = browser.new_context(color_scheme=scheme, viewport={"width": width, "height": height},
                                      accept_downloads=True)
        contexts.append(context)
        page = context.new_page()
        page.set_default_timeout(15_000)
        page.on("pageerror", lambda error: complaints.append(str(error)))
        page.on("console", lambda said: complaints.append(said.text)
                if said.type == "error" and "status of 4" not in said.text else None)
        if "PORTAMENTO_PAGES" in os.environ:
            page.route("**/console/*.*", lambda route: route.fulfill(path=PAGES / route.request.url.rsplit("/", 1)[1]))
        page.goto(f"{at or home}#{view}")
        return page

    yield opened
    for context in contexts:
        context.close()
    assert not complaints


@pytest.fixture
def picture(request):
    """Keeps a picture of the page, where somebody wants to look."""
    folder = os.environ.get("PORTAMENTO_SCREENSHOTS")

    def take(page, name, full=True):
        if folder:
            page.screenshot(path=Path(folder) / f"{name}.png", full_page=full)

    return take
