"""Motions as MCAP files, which Foxglove and other viewers of logs open: the placements of all links over time.

The file has one JSON message of the schema foxglove.FrameTransforms per instant, without chunks and compression.
"""

import json
import struct
from typing import Any

import numpy

from . import RigidBodyData, SceneFile, forward_kinematics, frame_names, frame_placement

_MAGIC = b"\x89MCAP0\r\n"


def _object(**properties: Any) -> Any:
    return {"type": "object", "properties": properties}


def _vector(axes: str) -> Any:
    return _object(**{axis: {"type": "number"} for axis in axes})


_TRANSFORM = _object(
    timestamp=dict(_object(sec={"type": "integer"}, nsec={"type": "integer"}), title="time"),
    parent_frame_id={"type": "string"},
    child_frame_id={"type": "string"},
    translation=_vector("xyz"),
    rotation=_vector("xyzw"),
)
_SCHEMA = dict(_object(transforms={"type": "array", "items": _TRANSFORM}), title="foxglove.FrameTransforms")


def _bytes(data: Any) -> bytes:
    data = data.encode() if isinstance(data, str) else data
    return struct.pack("<I", len(data)) + data


def _record(kind: int, content: bytes) -> bytes:
    return struct.pack("<BQ", kind, len(content)) + content


def write_mcap(path: str, scene: Any, trajectory: Any, rate: float = 50) -> int:
    """Write a motion as an MCAP file: placements of all links in the frame "world", on the topic /tf.

    scene: a Scene or a SceneFile. trajectory: the result of simulate, or anything with t (n) [s] and q (n, nq). rate:
    messages per second at most; the last state is always written. Frames have the names of frame_names. Returns the
    number of messages. Raises ValueError if sizes do not fit, or if times decrease or are negative.
    """
    scene = scene.scene if isinstance(scene, SceneFile) else scene
    times, states = numpy.asarray(trajectory.t, float), numpy.asarray(trajectory.q, float)
    if times.ndim != 1 or states.shape != (len(times), scene.nq):
        raise ValueError(f"write_mcap: t, q have the shapes {times.shape}, {states.shape}, expected (n,), (n, {scene.nq})")
    if not rate > 0 or not numpy.all(numpy.diff(times, prepend=0) >= 0):
        raise ValueError("write_mcap: rate must be positive, and times must increase from 0 or later")
    data, names, count, next_time = RigidBodyData(scene), frame_names(scene), 0, 0.0
    with open(path, "wb") as file:
        file.write(_MAGIC + _record(1, _bytes("") + _bytes("manycontact")))
        schema = _bytes(json.dumps(_SCHEMA))
        file.write(_record(3, struct.pack("<H", 1) + _bytes(_SCHEMA["title"]) + _bytes("jsonschema") + schema))
        file.write(_record(4, struct.pack("<HH", 1, 1) + _bytes("/tf") + _bytes("json") + _bytes("")))
        for k, (t, q) in enumerate(zip(times, states)):
            if t < next_time - 1e-9 and k + 1 < len(times):
                continue
            next_time = t + 1 / rate
            nanoseconds = round(t * 1e9)
            stamp = {"sec": nanoseconds // 10**9, "nsec": nanoseconds % 10**9}
            forward_kinematics(scene, q, data)
            transforms = []
            for name in names:
                at = frame_placement(scene, data, name)
                transforms.append({
                    "timestamp": stamp, "parent_frame_id": "world", "child_frame_id": name,
                    "translation": dict(zip("xyz", at.p.tolist())), "rotation": dict(zip("xyzw", at.quaternion.tolist())),
                })  # fmt: skip
            head = struct.pack("<HIQQ", 1, count, nanoseconds, nanoseconds)
            file.write(_record(5, head + json.dumps({"transforms": transforms}).encode()))
            count += 1
        file.write(_record(15, bytes(4)) + _record(2, bytes(20)) + _MAGIC)
    return count
