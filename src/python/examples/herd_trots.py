"""A herd of 64 quadrupeds trots, by the torques of its plan.

    herd_trots.py models/tasks/herd_trots.xml

The plan is found at a cost that is linear in the robots; the simulation takes finer steps, makes an impact wherever feet
land, and follows the plan by the feedback that the solver found with it.
"""

import sys

import manycontact as mc
import numpy as np

task = mc.load_task(sys.argv[1])
scene = task.scene.scene
plan = mc.optimize(task)
print(f"{len(scene.robots)} robots, {task.nodes} nodes: cost {plan.cost:.4g}, {plan.reason}")

motion = mc.simulate(task, plan, integrator="semi-implicit-euler", substeps=5)
start, end, planned = (np.array(x) for x in (motion.xs[0], motion.xs[-1], plan.xs[-1]))
bases = np.array([robot.idx_q for robot in scene.robots])
print(f"simulated: {motion.stopped}, contacts drift by {motion.violation_position:.1e} m,", end=" ")
print(f"impacts dissipate {motion.energy_lost:.1f} J")
print(f"forward by {np.mean(end[bases] - start[bases]):.3f} m, the plan's {np.mean(planned[bases] - start[bases]):.3f} m")
assert motion.stopped == mc.StepStatus.OK and (abs(end - planned)[bases] < 0.02).all()
