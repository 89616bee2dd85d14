"""A humanoid squats on both soles under a whole-body controller: its centre of mass follows a curve, its trunk stays upright.

    whole_body_controller.py models/humanoid_standing.xml

At every step accelerations and forces are affine in the torques: a = a(u) + da_du (u' - u), and these blocks come from
the factor of the contact dynamics. So the torques are those of a least-squares problem that knows nothing of contacts.
"""

import sys

import manycontact as mc
import numpy as np

file = mc.load_scene(sys.argv[1])
scene, h = file.scene, 2e-3
data, bodies = mc.SceneData(scene), mc.RigidBodyData(scene)
for contact in scene.contacts:
    contact.alpha, contact.beta = mc.recommended_gains("semi-implicit-euler", h)
chest = mc.find_frame(scene, scene.robots[0].name + "/chest")
joints = np.arange(6, scene.nv)  # behind the floating base


def torques(q, v, u, goal, goal_velocity):
    mc.solve(scene, q, v, u, data)
    da_du = mc.differentiate(scene, data).islands[0].da_du
    mc.forward_kinematics(scene, q, bodies, v)
    J = [mc.center_of_mass_jacobian(scene, bodies), mc.frame_jacobian(scene, bodies, chest)[3:], np.eye(scene.nv)[joints]]
    drift = [mc.center_of_mass_acceleration(scene, bodies), mc.frame_bias_acceleration(scene, bodies, chest)[3:], 0]
    tilt = mc.frame_placement(scene, bodies, chest).R[2] @ np.array([[0, 1, 0], [-1, 0, 0], [0, 0, 0]])  # of z from up
    wanted = [
        200 * (goal - mc.center_of_mass(scene, bodies)) + 28 * (goal_velocity - J[0] @ v),
        200 * tilt - 28 * J[1] @ v,
        50 * mc.difference(scene, q, file.q)[joints] - 14 * v[joints],
    ]
    rows = [w * Jk @ da_du for w, Jk in zip((10, 3, 0.3), J)] + [1e-3 * np.eye(scene.nu)]
    right = [w * (a - d - Jk @ data.a) for w, a, d, Jk in zip((10, 3, 0.3), wanted, drift, J)] + [-1e-3 * u]
    return u + np.linalg.lstsq(np.vstack(rows), np.concatenate(right), rcond=None)[0]


simulation = mc.SimulationData(scene, file.q, file.v, "semi-implicit-euler", h)
mc.forward_kinematics(scene, file.q, bodies)
start, u, worst = mc.center_of_mass(scene, bodies), file.u, 0.0
for k in range(1000):
    phase = np.pi * k * h  # a squat of 8 cm, down and up in two seconds
    goal = start - [0, 0, 0.04 * (1 - np.cos(phase))]
    u = torques(simulation.q, simulation.v, u, goal, np.array([0, 0, -0.04 * np.pi * np.sin(phase)]))
    if mc.step(scene, u, simulation) != mc.StepStatus.OK:
        sys.exit("the humanoid fell")
    mc.forward_kinematics(scene, simulation.q, bodies)
    worst = max(worst, np.linalg.norm(mc.center_of_mass(scene, bodies) - goal))
print(f"the centre of mass stayed within {1000 * worst:.1f} mm of its curve, torques within {abs(u).max():.0f} N m")
assert worst < 0.01
