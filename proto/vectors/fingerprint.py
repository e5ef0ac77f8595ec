"""Writes fingerprint.json: a plan, its encoding and its fingerprint, for implementations in any language.

Shares no code with the Rust implementation: Google's runtime encodes, PyPI's `xxhash` binds the reference library.

    pip install grpcio-tools xxhash && python3 fingerprint.py > fingerprint.json
"""

import importlib
import importlib.resources
import json
import pathlib
import sys
import tempfile

import xxhash
from google.protobuf import json_format
from grpc_tools import protoc

root = pathlib.Path(__file__).resolve().parent.parent
with tempfile.TemporaryDirectory() as out:
    google = importlib.resources.files("grpc_tools") / "_proto"
    assert protoc.main(["", f"-I{root}", f"-I{google}", f"--python_out={out}", "motion/v1/plan.proto"]) == 0
    sys.path.insert(0, out)
    plan_pb2 = importlib.import_module("motion.v1.plan_pb2")

plan = {
    "plannerVersion": "0.1.0",
    "evaluationVersion": 1,
    "guaranteed": ["QUANTITY_VELOCITY", "QUANTITY_JERK"],
    "cycleTime": "0.001s",
    "cycleCount": "5000",
    "duration": 5.0,
    "axes": [{
        "axis": "x",
        "kind": "AXIS_KIND_PRISMATIC",
        "segments": [{"duration": 1.0, "start": {"position": 0.1, "acceleration": -2.5}, "jerk": 0.0}],
    }],
}
encoded = json_format.ParseDict(plan, plan_pb2.Plan()).SerializeToString(deterministic=True)
print(json.dumps({
    "about": "`fingerprint` is XXH3-128 (seed 0, canonical byte order) of `encoded`, which is `plan` in the binary "
             "format. Made by fingerprint.py.",
    "plan": plan,
    "encoded": encoded.hex(),
    "fingerprint": xxhash.xxh3_128_hexdigest(encoded, seed=0),
}, indent=1))
