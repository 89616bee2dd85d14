"""A humanoid stands, is pushed, and its soles' forces are drawn.

    standing.py models/humanoid_standing.xml standing.png
"""

import sys

import manycontact as mc
import matplotlib.pyplot as plt

# %% The scene, the torques that keep it at rest, and the contact forces with these torques.
file = mc.load_scene(sys.argv[1])
scene = file.scene
data = mc.SceneData(scene)
u = mc.quasi_static(scene, file.q, data)
print(mc.solve(scene, file.q, file.v, u, data))

# %% How the soles' forces depend on each torque: dforces_du is a view of the library's memory.
blocks = mc.differentiate(scene, data).islands[0]
print("largest df/du:", abs(blocks.dforces_du).max(), "N per N m")

# %% A push: the base starts at 0.1 m/s sideways; the gains of the contacts are those recommended for the step h.
h = 1e-3
gains = mc.recommended_gains("rk4", h)
for contact in scene.contacts:
    contact.alpha, contact.beta = gains
file.v[mc.v_index(scene, scene.robots[0].name, "root") + 1] = 0.1
simulation = mc.SimulationData(scene, file.q, file.v, "rk4", h)
times, forces = [], []
for _ in range(300):
    if mc.step(scene, u, simulation) != mc.StepStatus.OK:
        break
    times.append(simulation.time)
    forces.append([mc.contact_force(scene, simulation, c.name)[2] for c in scene.contacts])

# %% The plot.
figure, axes = plt.subplots(1, 2, figsize=(10, 4))
axes[0].plot(times, forces, label=[c.name for c in scene.contacts])
axes[0].set(xlabel="time [s]", ylabel="normal force [N]", title="soles after a push")
axes[0].legend()
axes[1].spy(mc.kkt_matrix(scene, data), markersize=2)
axes[1].set_title("K = [M J'; J -delta I]")
figure.tight_layout()
figure.savefig(sys.argv[2], dpi=100)
