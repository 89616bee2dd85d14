"""The push that a standing robot withstands, and the least one that it does not.

    push_withstood.py models/humanoid_pushed.xml

The robot answers a push on its chest by the torques that hold it still (quasi_static). That is an answer as long as its
soles neither pull, slip nor tip: `violations` says so, from the contacts' mu and box. Between a push that they bear and
one that they do not lies the least that is too much; so for every direction.
"""

import sys

import manycontact as mc
import numpy as np

file = mc.load_scene(sys.argv[1])
scene, data = file.scene, mc.SceneData(file.scene)
still = np.zeros(scene.nv)


def judged(push):
    """What a force on the first push's frame, in the world's axes, does to the contacts."""
    data.wrenches[0] = [*push, 0, 0, 0]
    u = mc.quasi_static(scene, file.q, data)
    mc.solve(scene, file.q, still, u, data)
    if abs(data.a).max() > 1e-6:
        sys.exit("no torques hold the robot still")
    return mc.violations(scene, file.q, data)


print("from    withstands  not any more  what gives way")
for degrees in range(0, 360, 45):
    direction = np.array([np.cos(np.radians(degrees)), np.sin(np.radians(degrees)), 0])
    borne, too_much = 0.0, 1000.0
    assert not judged(borne * direction) and judged(too_much * direction)
    while too_much - borne > 0.1:
        middle = (borne + too_much) / 2
        if judged(middle * direction):
            too_much = middle
        else:
            borne = middle
    what = sorted({f"{scene.contacts[v.contact].name} {v.kind}" for v in judged(too_much * direction)})
    print(f"{degrees:3d} deg  {borne:6.1f} N    {too_much:6.1f} N      {', '.join(what)}")
