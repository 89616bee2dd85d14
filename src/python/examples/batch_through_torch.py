"""Ten thousand states of an arm that wrenches a box, as one function in torch, and its gradients.

    batch_through_torch.py models/arm_pushes_box.xml [states]

Torques are sought that make the box slide at a given acceleration, all states at once: as any layer of a network would be
trained.
"""

import sys
import time

import manycontact as mc
import manycontact.torch as mt
import torch

file = mc.load_scene(sys.argv[1])
scene, n = file.scene, int(sys.argv[2]) if len(sys.argv) > 2 else 10_000
dynamics = mt.Dynamics(scene)
torch.manual_seed(0)
q = torch.tensor(file.q).repeat(n, 1)
v = 0.1 * torch.randn(n, scene.nv, dtype=torch.float64)
u = torch.tensor(file.u).repeat(n, 1).requires_grad_()
box = mc.v_index(scene, "box", "root")  # its acceleration along its own x, y, z from here
wanted = torch.tensor([0.5, 0.0, 0.0], dtype=torch.float64)

optimiser = torch.optim.LBFGS([u], max_iter=20, line_search_fn="strong_wolfe")
evaluations, start = 0, time.time()


def loss():
    global evaluations
    evaluations += 1
    optimiser.zero_grad()
    a, _ = dynamics(q, v, u)
    error = ((a[:, box : box + 1] - wanted[:1]) ** 2).mean() + 1e-7 * (u**2).mean()
    error.backward()
    return error


before = float(loss())
optimiser.step(loss)
after = float(loss())
each = (time.time() - start) / evaluations / n
print(f"{n} states: the error fell from {before:.3g} to {after:.3g}; {1e6 * each:.1f} us for a state and its gradient")
assert after < 1e-2 * before and not dynamics.status.any()
