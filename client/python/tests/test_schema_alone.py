"""grpcio and the .proto files, and nothing else of ours: what a client in any language starts from."""

import queue
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import grpc
import pytest

PROTO = Path(__file__).parents[3] / "proto"


@pytest.fixture(scope="module")
def schema(tmp_path_factory):
    """The modules that grpcio-tools makes of the schema, here and now."""
    out = tmp_path_factory.mktemp("schema")
    files = [f"motion/v1/{name}.proto" for name in ["plan", "setpoint", "sim_axis"]]
    # In an interpreter of its own: the client's generated code knows the same files under other modules.
    subprocess.run([sys.executable, "-m", "grpc_tools.protoc", "-I", PROTO, f"--python_out={out}", f"--grpc_python_out={out}",
                    *files], check=True)
    return out


def test_plan_stream_and_hold(schema, addresses):
    run = subprocess.run([sys.executable, __file__, schema, addresses["server"]], text=True, capture_output=True)
    assert run.returncode == 0, run.stderr
    assert run.stdout == "played 0.05\n"


def plan_stream_and_hold(address):
    from motion.v1 import plan_pb2, plan_pb2_grpc, setpoint_pb2, setpoint_pb2_grpc

    channel = grpc.insecure_channel(address)
    planner = plan_pb2_grpc.PlannerServiceStub(channel)
    setpoints = setpoint_pb2_grpc.SetpointServiceStub(channel)

    limits = plan_pb2.AxisLimits(max_velocity=0.25, max_acceleration=3, max_jerk=100)
    axis = plan_pb2.AxisMove(axis="x", kind="AXIS_KIND_PRISMATIC", goal=plan_pb2.AxisState(position=0.05), limits=limits)
    request = plan_pb2.PlanRequest(axes=[axis], family="PROFILE_FAMILY_S_CURVE", short_path_policy="SHORT_PATH_POLICY_REJECT",
                                   synchronization="SYNCHRONIZATION_NONE")
    plan = planner.Plan(request, timeout=10).plan
    assert plan.certificate.passed

    # An axis: what it says goes out of a queue, and what it hears says how far it is.
    said = queue.Queue()
    messages = setpoints.StreamSetpoints(iter(said.get, None), timeout=60)
    say = setpoint_pb2.StreamSetpointsRequest
    said.put(say(open=setpoint_pb2.Open(stream="python/schema-alone", epoch=1, plan=plan, close_at_rest=True)))
    hold = setpoint_pb2.ControlStreamRequest(
        stream="python/schema-alone", operation=setpoint_pb2.Operation(request_id="wait", hold=setpoint_pb2.Hold()))
    position, executed, held, gone_on = {}, 0, None, False
    with ThreadPoolExecutor() as commander:
        for message in messages:
            match message.WhichOneof("message"):
                case "opened":
                    held = commander.submit(setpoints.ControlStream, hold, timeout=60)
                case "operation":
                    assert message.operation.request_id == "go on"
                    gone_on = True
                case "batch":
                    batch = message.batch
                    accepted = batch.first_cycle + batch.columns.cycles - 1
                    position.update(zip(range(batch.first_cycle, accepted + 1), batch.columns.position))
                    # It begins to play when it has been told to hold: before, the motion might be over. And it stays behind what it
                    # holds, as an axis does, so that what is replaced is not played yet.
                    if batch.revision > 0:
                        executed = max(executed, accepted if batch.last else accepted - 20)
                    said.put(say(report=setpoint_pb2.AxisReport(
                        executed_cycle=executed, accepted_cycle=accepted, grant_cycle=executed + 40, revision=batch.revision,
                        digest=batch.digest)))
                    # The report has said that it plays by the hold: whoever asked for it is answered.
                    if batch.revision == 1 and held is not None and accepted >= held.result().result.rest_cycle:
                        result = held.result().result
                        assert result.request_id == "wait" and result.on_path, result
                        assert len({position[cycle] for cycle in range(result.rest_cycle, accepted + 1)}) == 1
                        held = None
                        resume = setpoint_pb2.Operation(request_id="go on", resume=setpoint_pb2.ResumeMotion())
                        said.put(say(operation=resume))
    said.put(None)
    assert gone_on and list(position) == list(range(1, executed + 1)), "no cycle is missing"
    print("played", position[executed])


if __name__ == "__main__":
    sys.path.insert(0, sys.argv[1])
    plan_stream_and_hold(sys.argv[2])
