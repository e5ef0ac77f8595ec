import math
import subprocess
import sys
from pathlib import Path

import pytest

import portamento
from portamento import Limits, Move, Points, State
from portamento.motion.v1 import setpoint_pb2

HERE = Path(__file__).parent


def test_a_move_is_planned_and_read_out(server, limits):
    plan = server.plan(Move("x", 0.05, limits))
    # d/v + v/a + a/j.
    assert math.isclose(plan.duration, 0.05 / 0.25 + 0.25 / 3 + 3 / 100, rel_tol=1e-12)
    assert plan.certificate.passed and plan.axes == ["x"] and plan.cycle_time == 1e-3
    assert plan.at(0.0)[:3] == (0.0, 0.0, 0.0)
    assert math.isclose(plan.at(plan.duration)[0], 0.05)
    assert plan.at(10.0)[:2] == (0.05, 0.0)
    position, velocity, acceleration, jerk = plan.at(0.02)
    assert math.isclose(position, 100 * 0.02**3 / 6) and math.isclose(acceleration, 2.0) and jerk == 100.0
    assert server.verify(plan).passed


@pytest.mark.parametrize("family, order, more", [
    ("S_CURVE", None, {}), ("TRAPEZOIDAL", None, {}), ("TRIGONOMETRIC", None, {}), ("POLYNOMIAL", 4, {"snap": 6000.0}),
    ("POLYNOMIAL", 5, {"snap": 6000.0, "higher_derivatives": [8e5]}),
])
def test_what_is_drawn_is_what_is_sampled(server, family, order, more):
    plan = server.plan(Move("x", 0.05, Limits(0.25, 3, 100, **more)), family=family, order=order)
    cycles = 0
    for chunk in server.sample(plan):
        for n, sampled in enumerate(zip(chunk.position[0], chunk.velocity[0], chunk.acceleration[0])):
            drawn = plan.at((chunk.first_cycle + n) * plan.cycle_time)
            scales = (0.05, 0.25, 3.0)
            # Acceleration of a trapezoid jumps: at a joint, rounding decides on which side.
            upto = 2 if family == "TRAPEZOIDAL" else 3
            assert all(abs(a - b) < 1e-9 * scale for a, b, scale in list(zip(drawn, sampled, scales))[:upto])
            cycles += 1
    assert cycles == plan.cycle_count + 1


@pytest.mark.parametrize("family, order, more", [
    ("S_CURVE", None, {}), ("TRAPEZOIDAL", None, {"jerk": 0.0}), ("TRIGONOMETRIC", None, {}),
    ("POLYNOMIAL", 5, {"snap": 6000.0, "higher_derivatives": [8e5]}),
])
def test_many_moves_are_planned_in_columns(server, family, order, more):
    limits = Limits(0.25, 3, **{"jerk": 100, **more})
    goals, speeds = [0.05, math.nan, -0.2, 0.0], [0.25, 0.25, 0.1, 0.25]
    moves = server.plan_many(Move("x", 0.0, limits), family=family, order=order, goal_position=goals, max_velocity=speeds)
    assert len(moves) == 4 and list(moves.refused) == [1] and moves.durations[1] == 0.0
    assert moves.refused[1].reason == "NOT_FINITE" and moves.refused[1].code == "INVALID_ARGUMENT"
    assert moves.refused[1].fields[0][0] == "columns.goal_position[1]"
    for index in (0, 2, 3):
        alone = server.plan(Move("x", goals[index], Limits(speeds[index], 3, **{"jerk": 100, **more})), family=family, order=order)
        plan = moves.plan(index)
        assert plan.message.axes[0].segments == alone.message.axes[0].segments, "bit by bit"
        assert plan.message.axes[0].limits == alone.message.axes[0].limits
        assert moves.durations[index] == alone.duration and moves.cycle_counts[index] == alone.cycle_count
        assert server.verify(plan) == alone.certificate
    with pytest.raises(portamento.Refused):
        moves.plan(1)


def test_more_moves_than_a_message_takes_and_what_is_wrong_with_all(server, limits):
    goals = [1e-5 * n for n in range(1, 5001)]
    moves = server.plan_many(Move("x", 0.0, limits), goal_position=goals)
    assert moves.durations == sorted(moves.durations) and len(moves) == 5000 and not moves.refused
    assert moves.plan(4999).at(10.0)[0] == goals[-1]
    with pytest.raises(portamento.Refused) as refused:
        server.plan_many(Move("", 0.0, limits), goal_position=goals)
    assert refused.value.fields[0][0] == "columns.like.axes[0].axis"
    with pytest.raises(ValueError, match="other lengths"):
        server.plan_many(Move("x", 0.0, limits), goal_position=goals, max_velocity=[1.0])
    with pytest.raises(TypeError, match="no such column: goal"):
        server.plan_many(Move("x", 0.0, limits), goal=goals)


def test_several_axes_go_together(server, limits):
    plan = server.plan(Move("x", 0.05, limits), Move("c", 1.5, Limits(6, 40, 900), kind=portamento.Kind.REVOLUTE),
                       minimum_duration=0.8)
    assert plan.axes == ["x", "c"] and plan.duration >= 0.8
    assert math.isclose(plan.at(plan.duration, axis=1)[0], 1.5)


def test_points_say_what_became_of_them(server):
    asked = Points("x", [(0.2, 0.015, 0.15), (0.4, 0.3, 0.0)], Limits(0.5, 4, 160))
    plan = server.pvt(asked)
    assert [report.region for report in plan.points] == ["R2", "R4"]
    assert [len(report.adjustments) for report in plan.points] == [0, 1]
    with pytest.raises(portamento.Refused) as refused:
        server.pvt(asked, policy="REJECT")
    assert refused.value.reason == "PVT_UNREACHABLE"


def test_refusals_teach(server, limits):
    with pytest.raises(portamento.Refused) as refused:
        server.plan(Move("x", State(0.0005, 0.2), limits))
    assert refused.value.reason == "PATH_TOO_SHORT" and refused.value.code == "FAILED_PRECONDITION"
    assert float(refused.value.metadata["given"]) == 0.0005
    with pytest.raises(portamento.Refused) as refused:
        server.plan(Move("x", 0.05, Limits(-1, 3, 100)))
    assert [field for field, _ in refused.value.fields] == ["axes[0].limits.max_velocity"]
    with pytest.raises(portamento.Unreachable):
        portamento.Server("127.0.0.1:1", timeout=2).plan(Move("x", 0.05, limits))


def test_a_stream_is_tracked_held_and_watched(server, axis, planners, limits):
    plan = server.plan(Move("x", 0.2, limits))
    # A lead that outlasts what a busy machine does to its processes: an axis that starves holds until somebody lets it go on.
    with axis.track(plan, "python/held", planners, settle_window=0.05, lead_cycles=200) as run:
        hold = axis.hold("python/held", not_before=200)
        assert hold.effective_cycle >= 200 and hold.on_path
        watched = next(seen for seen in server.watch("python/held", period=0.02) if seen.cycles)
        assert watched.phase == setpoint_pb2.PHASE_HOLDING and watched.axes == ["x"]
        # Again, as after an answer that got lost: not done twice.
        again = {"request_id": "once", "not_before": hold.rest_cycle + 50}
        resumed = server.resume("python/held", **again)
        assert server.resume("python/held", **again) == resumed
        rows = {}
        for samples in run:
            assert samples.first_cycle < 20_000, "it has starved, and holds"
            rows.update((samples.first_cycle + n, samples.position[0][n]) for n in range(samples.cycles))
    between = [rows[cycle] for cycle in range(hold.rest_cycle, resumed.effective_cycle)]
    assert len(set(between)) == 1, "it rests while it is held"
    assert max(rows.values()) == 0.2
    assert run.report.stream.revisions == 2 and run.report.axes[0].axis == "x"


def test_virtual_time_gives_the_digest_of_the_plan(server, axis, planners, limits):
    plan = server.plan(Move("x", 0.05, limits))
    report = axis.track(plan, "python/virtual", planners, virtual_time=True).finish()
    digest = [chunk.digest for chunk in server.sample(plan)][-1]
    assert report.stream.digest == digest and report.stream.cycles_executed == plan.cycle_count


def test_the_example_plots(addresses, tmp_path):
    plot = tmp_path / "plot.png"
    example = [sys.executable, HERE.parent / "examples" / "plan_and_hold.py", plot, "--server", addresses["server"],
               "--axis", addresses["sim-axis"]]
    said = subprocess.run(example, text=True, capture_output=True, check=True).stdout
    assert "certificate passed" in said and "goes on from cycle" in said
    assert plot.read_bytes().startswith(b"\x89PNG")


def test_generated_code_follows_from_the_schema(tmp_path):
    """What is checked in is what the schema gives."""
    copy = tmp_path / "client" / "python"
    copy.mkdir(parents=True)
    (copy / "generate").write_bytes((HERE.parent / "generate").read_bytes())
    (tmp_path / "proto").symlink_to(HERE.parents[2] / "proto")
    (copy / "portamento").mkdir()
    subprocess.run(["bash", copy / "generate", sys.executable], check=True, capture_output=True)
    fresh = {path.name: path.read_bytes() for path in (copy / "portamento/motion/v1").iterdir()}
    kept = {path.name: path.read_bytes() for path in (HERE.parent / "portamento/motion/v1").iterdir() if path.is_file()}
    assert fresh == kept, "run client/python/generate"
