"""Recordings, read by a library that knows nothing of ours: as Foxglove and PlotJuggler read them."""

import csv
import json

import pytest
from conftest import run_portamento
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory


@pytest.fixture(scope="module")
def demo(tmp_path_factory):
    place = tmp_path_factory.mktemp("demo")
    run_portamento("demo", "--virtual-time", "--plot", "demo.svg", "--record", "demo.mcap", cwd=place)
    return place / "demo.mcap"


def messages(path):
    with open(path, "rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        return [(channel.topic, schema.name, message.log_time, decoded)
                for schema, channel, message, decoded in reader.iter_decoded_messages()]


def test_what_happened_is_inside_with_its_schema(demo):
    found = messages(demo)
    by_topic = {}
    for topic, schema, log_time, decoded in found:
        by_topic.setdefault(topic, []).append((schema, log_time, decoded))
    schemas = {topic: said[0][0] for topic, said in by_topic.items()}
    assert schemas == {
        "/head": "motion.v1.RecordingHead", "/request": "motion.v1.PlanRequest", "/plan": "motion.v1.Plan",
        "/axes/x": "motion.v1.RecordedCycle", "/operations": "motion.v1.RecordedOperation",
        "/events": "motion.v1.StreamEvent", "/failovers": "motion.v1.FailOver", "/report": "motion.v1.TrackingReport",
    }
    plan = by_topic["/plan"][0][2]
    assert plan.certificate.passed and plan.axes[0].axis == "x"
    cycles = [decoded for _, _, decoded in by_topic["/axes/x"]]
    assert [cycle.cycle for cycle in cycles] == list(range(cycles[0].cycle, cycles[0].cycle + len(cycles)))
    assert all(log_time == decoded.cycle * 1_000_000 for _, log_time, decoded in by_topic["/axes/x"])
    assert all(cycle.HasField("measured_position") and cycle.HasField("load_position") for cycle in cycles)
    assert cycles[-1].position == 0.05
    kinds = [decoded.operation.WhichOneof("operation") for _, _, decoded in by_topic["/operations"]]
    assert kinds == ["set_override", "hold", "resume"]


def test_it_is_played_again_bit_for_bit(demo):
    replayed = json.loads(run_portamento("replay", demo, "--json").stdout)
    assert replayed["same"] and replayed["planned"] and replayed["operations"] == 3
    assert replayed["compared"] > 300


def test_one_bit_that_differs_is_found(demo, tmp_path):
    """Written again by the independent library, with one number the next double above."""
    import math

    from mcap.writer import CompressionType
    from mcap_protobuf.writer import Writer

    changed = tmp_path / "changed.mcap"
    with open(changed, "wb") as file, Writer(file, compression=CompressionType.NONE) as writer:
        for topic, _, log_time, decoded in messages(demo):
            if topic == "/axes/x" and decoded.cycle == 123:
                decoded.velocity = math.nextafter(decoded.velocity, math.inf)
            writer.write_message(topic=topic, message=decoded, log_time=log_time, publish_time=log_time)
    ran = run_portamento("replay", changed, "--json", check=False)
    assert ran.returncode == 1
    difference = json.loads(ran.stdout)["difference"]
    assert (difference["cycle"], difference["axis"], difference["quantity"]) == (123, "x", "velocity")


def test_a_file_that_broke_off_says_so(demo, tmp_path):
    part = tmp_path / "part.mcap"
    part.write_bytes(demo.read_bytes()[:5000])
    ran = run_portamento("replay", part, check=False)
    assert ran.returncode == 2 and "not a whole MCAP file" in ran.stderr


def test_a_run_at_an_axis_is_recorded_too(addresses, tmp_path):
    run_portamento("plan", "--distance", 0.05, "--max-velocity", 0.25, "--max-acceleration", 3, "--max-jerk", 100,
                   "--output", "move.json", cwd=tmp_path)
    for name in ["run.mcap", "run.csv"]:
        run_portamento("track", "--plan", "move.json", "--endpoint", f"http://{addresses['sim-axis']}", "--planner",
                       f"http://{addresses['server']}", "--virtual-time", "--record", name, cwd=tmp_path)
    assert json.loads(run_portamento("replay", tmp_path / "run.mcap", "--json").stdout)["same"]
    with open(tmp_path / "run.csv") as file:
        rows = list(csv.DictReader(file))
    recorded = [decoded for topic, *_, decoded in messages(tmp_path / "run.mcap") if topic == "/axes/x"]
    assert [(int(row["cycle"]), float(row["x.position"])) for row in rows] == [(c.cycle, c.position) for c in recorded]
