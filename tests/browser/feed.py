"""Streams as a server shows them, at an even beat: what the console makes of them depends on the console alone.

Axes by the wall clock, and a planner for them, take more of a small machine than the page that looks on. So this hands out the console's
own files, and streams of made-up axes as server-sent events, in the messages of WatchStream.
"""

import json
import math
import threading
import time
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from urllib.parse import parse_qs, urlsplit

PAGES = Path(__file__).parents[2] / "server/src/console/page"
KINDS = {".html": "text/html", ".js": "text/javascript", ".css": "text/css", ".svg": "image/svg+xml"}


BEAT = 50
"""Cycles of 1 ms in a message."""
TURN = 40
"""Messages until the motion is where it began."""


class Feed:
    """`count` streams of one axis with a cycle of 1 ms, each told of at every beat, once somebody watches."""

    def __init__(self, count):
        self.names = [f"cell-{number}/x" for number in range(count)]
        # Written once: at every beat only the numbers of cycles are new.
        self.columns = [[columns(number, beat) for beat in range(TURN)] for number in range(count)]
        self.begun = time.monotonic()
        self.over = threading.Event()
        feed = self

        class Handler(BaseHTTPRequestHandler):
            protocol_version = "HTTP/1.1"

            def log_message(self, *_):
                pass

            def do_GET(self):
                where = urlsplit(self.path)
                if where.path.endswith("/WatchStream"):
                    return self.watch(parse_qs(where.query).get("stream", []))
                file = PAGES / (where.path.removeprefix("/console/") or "index.html")
                if not file.is_file():
                    return self.send_error(404)
                self.answer(KINDS[file.suffix])
                self.send_header("content-length", str(file.stat().st_size))
                self.end_headers()
                self.wfile.write(file.read_bytes())

            def do_POST(self):
                # Nothing is planned here.
                self.rfile.read(int(self.headers["content-length"]))
                self.send_response(404)
                self.send_header("content-length", "2")
                self.end_headers()
                self.wfile.write(b"{}")

            def answer(self, kind):
                self.send_response(200)
                self.send_header("content-type", kind)

            def watch(self, names):
                self.answer("text/event-stream")
                self.send_header("connection", "close")
                self.end_headers()
                try:
                    feed.tell(names, self.wfile)
                except (BrokenPipeError, ConnectionResetError):
                    pass

        self.http = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
        self.http.daemon_threads = True
        threading.Thread(target=self.http.serve_forever, daemon=True).start()
        self.address = f"http://127.0.0.1:{self.http.server_port}/console/"

    def cycle(self):
        """The cycle that all axes are in."""
        return int((time.monotonic() - self.begun) * 1000)

    def tell(self, names, out):
        """Summaries of all, or the columns of those named, until the reader goes or the feed stops."""
        beat = self.cycle() // BEAT
        while not self.over.wait(max(0.0, beat * BEAT / 1000 - (time.monotonic() - self.begun))):
            if names or beat % 10 == 0:
                messages = (self.message(number, beat, bool(names)) for number, name in enumerate(self.names)
                            if not names or name in names)
                out.write("".join(f"data: {message}\n\n" for message in messages).encode())
            beat += 1

    def message(self, number, beat, full):
        executed = beat * BEAT
        message = json.dumps({
            "stream": self.names[number], "axes": ["x"], "kinds": ["AXIS_KIND_PRISMATIC"], "cycleTime": "0.001s",
            "executedCycle": str(executed), "leadCycles": 40, "phase": "PHASE_MOVING", "overrideFactor": 1,
            "counters": {"underruns": "0"}, "messagesDropped": "0", "events": [],
        })
        if not full:
            return message
        cycles = ",".join(f'"{cycle}"' for cycle in range(executed - BEAT + 1, executed + 1))
        return f'{message[:-1]},"cycles":[{cycles}],{self.columns[number][beat % TURN]}}}'

    def stop(self):
        self.over.set()
        self.http.shutdown()


def columns(number, beat):
    """Back and forth by 100 mm, each stream with a phase of its own; the axis lags by a few micrometres."""
    turn = [2 * math.pi * (cycle / (BEAT * TURN) + number / 20) for cycle in range((beat - 1) * BEAT + 1, beat * BEAT + 1)]
    position = [0.05 * (1 - math.cos(angle)) for angle in turn]
    error = [4e-6 * math.sin(angle) + 4e-7 * math.sin(31 * angle) for angle in turn]
    commanded = {
        "cycles": BEAT, "position": position, "velocity": [0.16 * math.sin(angle) for angle in turn],
        "acceleration": [0.5 * math.cos(angle) for angle in turn], "jerk": [-1.6 * math.sin(angle) for angle in turn],
    }
    tracking = {
        "cycles": BEAT, "followingError": error, "measuredPosition": [at - lag for at, lag in zip(position, error)],
        "cycleJitterNs": [20_000 + 100 * (cycle % 47) for cycle in range(BEAT)],
    }
    return f'"commanded":{json.dumps(commanded)},"tracking":{json.dumps(tracking)}'
