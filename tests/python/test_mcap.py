"""Motions as MCAP files, read by the few lines below.

The npm package @mcap/core 2.2.2 read such a file on 2026-11-29: McapStreamReader returned the header, the schema, the channel, all
messages with their times, DataEnd and Footer.
"""

import json
import struct
from types import SimpleNamespace

import manycontact as mc
import numpy as np
import pytest
from conftest import MODELS


def records(path):
    """Returns [(kind, content)] of all records of a file without chunks."""
    data, at, found = path.read_bytes(), 8, []
    assert data[:8] == data[-8:] == b"\x89MCAP0\r\n"
    while at < len(data) - 8:
        kind, size = struct.unpack_from("<BQ", data, at)
        found.append((kind, data[at + 9 : at + 9 + size]))
        at += 9 + size
    assert at == len(data) - 8
    return found


def texts(content):
    """Returns the texts that follow each other, each after its length."""
    found = []
    while content:
        size = struct.unpack_from("<I", content)[0]
        found.append(content[4 : 4 + size].decode())
        content = content[4 + size :]
    return found


@pytest.fixture
def beam(tmp_path):
    """The beam falls for a second from 1 m; both humanoids keep their configuration."""
    file = mc.load_scene(str(MODELS / "two_humanoids_carry_beam.xml"))
    t = np.arange(0, 1.0005, 0.001)
    q = np.tile(file.q, (len(t), 1))
    q[:, mc.q_index(file.scene, "beam", "root") + 2] = 1 - t**2
    path = tmp_path / "beam.mcap"
    return file, path, mc.write_mcap(str(path), file, SimpleNamespace(t=t, q=q), rate=20)


def test_records(beam):
    _, path, count = beam
    found = records(path)
    assert [kind for kind, _ in found] == [1, 3, 4, *[5] * count, 15, 2] and count == 21
    assert texts(found[0][1]) == ["", "manycontact"]
    assert found[1][1][:2] == struct.pack("<H", 1) and texts(found[1][1][2:])[:2] == ["foxglove.FrameTransforms", "jsonschema"]
    assert found[2][1][:4] == struct.pack("<HH", 1, 1) and texts(found[2][1][4:]) == ["/tf", "json", ""]
    assert found[-2][1] == bytes(4) and found[-1][1] == bytes(20)


def test_messages(beam):
    file, path, count = beam
    messages = [content for kind, content in records(path) if kind == 5]
    heads = [struct.unpack_from("<HIQQ", x) for x in messages]
    assert [x[1] for x in heads] == list(range(count)) and [x[2] for x in heads] == [k * 50_000_000 for k in range(count)]
    for head, content in zip(heads, messages):
        transforms = json.loads(content[22:])["transforms"]
        assert [x["child_frame_id"] for x in transforms] == mc.frame_names(file.scene)
        beam_at = next(x for x in transforms if x["child_frame_id"] == "beam/beam")
        assert beam_at["translation"]["z"] == pytest.approx(1 - (head[2] / 1e9) ** 2)
        assert beam_at["timestamp"] == {"sec": head[2] // 10**9, "nsec": head[2] % 10**9}
        assert sum(x**2 for x in beam_at["rotation"].values()) == pytest.approx(1) and beam_at["parent_frame_id"] == "world"


def test_schema_has_what_messages_have(beam):
    def fits(value, schema):
        if schema["type"] == "object":
            return value.keys() == schema["properties"].keys() and all(fits(value[k], schema["properties"][k]) for k in value)
        if schema["type"] == "array":
            return all(fits(x, schema["items"]) for x in value)
        return isinstance(value, {"integer": int, "number": float, "string": str}[schema["type"]])

    found = records(beam[1])
    assert fits(json.loads(found[3][1][22:]), json.loads(texts(found[1][1][2:])[2]))


def test_the_last_state_is_written(tmp_path, humanoid):
    file, _ = humanoid
    motion = mc.simulate(file.scene, file.u, mc.SimulationData(file.scene, file.q, file.v, "semi-implicit-euler", 1e-3), 25)
    path = tmp_path / "end.mcap"
    assert mc.write_mcap(str(path), file.scene, motion) == 3
    assert [struct.unpack_from("<HIQQ", x)[2] for kind, x in records(path) if kind == 5] == [0, 20_000_000, 25_000_000]


def test_motions_that_do_not_fit(tmp_path, humanoid):
    file, _ = humanoid
    path = tmp_path / "none.mcap"
    with pytest.raises(ValueError, match="shapes"):
        mc.write_mcap(str(path), file, SimpleNamespace(t=[0.0], q=np.zeros((1, 3))))
    for t, rate in (([1, 0], 50), ([-1, 0], 50), ([0, float("nan")], 50), ([0, 1], 0)):
        with pytest.raises(ValueError, match="rate must be positive"):
            mc.write_mcap(str(path), file, SimpleNamespace(t=t, q=np.tile(file.q, (2, 1))), rate=rate)
    assert not path.exists()
