"""States violate their contacts, or are consistent."""

import copy

import manycontact as mc
import numpy as np
import pytest
from conftest import MODELS

BOX = """<scene %s><robot name="b" urdf="box.urdf" base="floating"><v>0 0 -1 0 0 0</v></robot>
  <contact name="weld" type="6d" frame="b/crate" xyz="0 0 %s"/></scene>"""


def load(attributes="", height=0):
    return mc.load_scene_text(BOX % (attributes, height), str(MODELS / "scene.xml"))


def test_errors_are_told():
    file = load(height=0.5)
    (place,) = mc.placement_errors(file.scene, file.q)
    assert (place.contact, place.position, place.angle) == (0, pytest.approx(0.5), 0)
    (velocity,) = mc.velocity_errors(file.scene, file.q, file.v)
    assert (velocity.contact, velocity.linear, velocity.angular) == (0, pytest.approx(1), 0)
    assert repr(velocity) == "<VelocityError of contact 0: 1 m/s, 0 rad/s>"
    assert copy.deepcopy(velocity) == velocity
    assert mc.velocity_errors(file.scene, file.q, file.v, active=[False]) == []
    with pytest.raises(ValueError, match="v: 6 numbers are expected, not 5"):
        mc.velocity_errors(file.scene, file.q, file.v[:5])
    with pytest.raises(ValueError, match="active: 1 flags are expected"):
        mc.velocity_errors(file.scene, file.q, file.v, active=[True, True])


def test_make_consistent():
    file = load(height=0.5)
    before = file.q.copy()
    state = mc.make_consistent(file.scene, file.q, file.v)
    assert state.consistent and state.misplaced == [] and state.moving == []
    assert state.q[2] == pytest.approx(0.5, abs=1e-12)
    assert np.abs(state.v).max() < 1e-12
    assert (file.q == before).all()
    assert state.status == mc.Status.OK and state.steps >= 1
    assert copy.deepcopy(state) == state
    free = mc.make_consistent(file.scene, file.q, file.v, active=[False])
    assert (free.v == file.v).all() and free.consistent


def test_scenes_ask_for_it():
    file = load('consistent="true"', 0.5)
    assert file.q[2] == pytest.approx(0.5, abs=1e-12)
    assert [f.kind for f in file.findings] == ["consistent"]
    with pytest.raises(mc.InputError, match="consistent=\"true\" is set, but contact '(one|two)', the worst of 2, stays out of place by 1 m"):
        mc.load_scene_text(
            """<scene consistent="true"><robot name="b" urdf="box.urdf" base="floating"/>
            <contact name="one" type="3d" frame="b/crate" xyz="0 0 1"/>
            <contact name="two" type="3d" frame="b/crate" xyz="0 0 3"/></scene>""",
            str(MODELS / "scene.xml"),
        )


def test_unique_forces():
    file = mc.load_scene_text(
        """<scene><robot name="b" urdf="box.urdf" base="floating"/>
        <contact name="lower" type="3d" frame="b/crate" offset="-0.2 0 -0.2"/>
        <contact name="upper" type="3d" frame="b/crate" offset="-0.2 0 0.2"/></scene>""",
        str(MODELS / "scene.xml"),
    )
    data = mc.SceneData(file.scene)
    with pytest.raises(ValueError, match="solve first"):
        mc.unique_forces(file.scene, file.q, data)
    assert mc.solve(file.scene, file.q, file.v, file.u, data).status == mc.Status.REDUNDANT
    unique = mc.unique_forces(file.scene, file.q, data)
    assert unique.dtype == bool and unique.tolist() == [True, True, False, True, True, False]


def solved(contacts, attributes=""):
    file = mc.load_scene_text(
        '<scene><robot name="q" urdf="quadruped.urdf" base="floating"%s/>%s</scene>' % (attributes, contacts),
        str(MODELS / "scene.xml"),
    )
    data = mc.SceneData(file.scene)
    mc.solve(file.scene, file.q, file.v, file.u, data)
    return file, data


def test_rank_changes():
    """The trunk is fixed, and a leg is stretched to a foot that is fixed too."""
    file, data = solved(
        '<contact name="trunk" type="6d" frame="q/trunk"/><contact name="foot" type="3d" frame="q/RF_foot"/>'
    )
    (change,) = mc.rank_changes(file.scene, file.q, data)
    assert change.singular and change.rank == 8 and change.rows == 9
    assert change.contacts == [0, 1]
    assert mc.velocity_names(file.scene)[change.coordinate].startswith("q/RF")


def test_near_dependent():
    file, data = solved(
        '<contact name="a" type="3d" frame="q/trunk"/><contact name="b" type="3d" frame="q/trunk" offset="1e-5 0 0"/>'
    )
    (near,) = mc.near_dependent(file.scene, file.q, data)
    assert near.island == 0 and min(near.rows) >= 3 and 0 < near.left < 1e-3
    gap = mc.rank_gap(file.scene, data, 0)
    assert gap.known and gap.kept >= 3 and gap.gap > 1e3
    with pytest.raises(ValueError, match="no island 1"):
        mc.rank_gap(file.scene, data, 1)
