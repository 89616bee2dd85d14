"""Batches of states in torch: accelerations and contact forces of many states of one scene, with their gradients.

    import manycontact as mc, manycontact.torch as mt

    dynamics = mt.Dynamics(mc.load_scene("models/humanoid_standing.xml").scene)
    a, f = dynamics(q, v, u)                # tensors of (n, nq), (n, nv), (n, nu)  ->  (n, nv), (n, rows)
    (f**2).sum().backward()                 # q.grad, v.grad, u.grad

States are solved by solve_batch, gradients come from vjp_batch, in threads of the library's own: no matrix of derivatives
is formed. All is computed in float64 on the CPU; tensors of other types and devices get answers of their own.
"""

from typing import List, Optional, Tuple

import numpy
import torch  # type: ignore[import]

from . import BatchData, JointType, Options, Scene, solve_batch, vjp_batch_with_wrenches


def _numbers(tensor):
    return tensor.detach().to("cpu", torch.float64).contiguous().numpy()


class _Solve(torch.autograd.Function):
    @staticmethod
    def forward(ctx, dynamics, q, v, u, wrenches):
        ctx.dynamics, ctx.active = dynamics, numpy.array(dynamics.batch.active)
        ctx.save_for_backward(q, v, u, wrenches)
        dynamics._set(ctx.active, _numbers(wrenches))
        a, f, dynamics.status = solve_batch(dynamics.scene, *map(_numbers, (q, v, u)), dynamics.batch)
        return q.new_tensor(a), q.new_tensor(f)

    @staticmethod
    @torch.autograd.function.once_differentiable
    def backward(ctx, by_a, by_f):
        dynamics, (q, v, u, wrenches) = ctx.dynamics, ctx.saved_tensors
        dynamics._set(ctx.active, _numbers(wrenches))
        wq, wv, wu, ww, _ = vjp_batch_with_wrenches(
            dynamics.scene, *map(_numbers, (q, v, u, by_a, by_f)), dynamics.batch
        )
        by_q = dynamics._by_numbers_of_q(_numbers(q), wq)
        return None, *map(q.new_tensor, (by_q, wv, wu, ww.sum(axis=0).reshape(-1, 6)))


class Dynamics:
    """The dynamics of a scene as a function of tensors: (a, f) = dynamics(q, v, u).

    q: (n, nq), v: (n, nv), u: (n, nu), or one state without its n. a: (n, nv) accelerations; f: (n, rows) forces of the
    active contacts. Gradients are by the numbers of q: quaternions are made unit first, as a function of their four
    numbers, so that steps along a gradient may leave the sphere. Where a state fails, a, f and gradients are NaN.
    Not for second derivatives, nor for two threads at once.
    """

    def __init__(self, scene: Scene, threads: int = 0, options: Optional[Options] = None):
        self.scene = scene
        self.batch = BatchData(scene, threads, options or Options())
        self.status = numpy.zeros(0, numpy.int8)  # (n) of the last call, int(Status)
        self._quaternions, self._planes = [], []  # first in q, first in v
        self._same: Tuple[List[int], List[int]] = ([], [])  # coordinates of q, and of v that are their rates
        for robot in scene.robots:
            for joint in robot.model.joints:
                at = robot.idx_q + joint.idx_q, robot.idx_v + joint.idx_v
                if joint.type == JointType.FLOATING:
                    self._quaternions.append(at)
                elif joint.type == JointType.PLANAR:
                    self._planes.append(at)
                else:
                    for same, first in zip(self._same, at):
                        same.append(first)

    @property
    def active(self):
        """One bool per contact of the scene: which hold, in all states."""
        return self.batch.active

    @active.setter
    def active(self, flags):
        self.batch.active = flags

    def __call__(self, q, v, u, wrenches=None):
        """(a, f). wrenches: (wrenches of the scene, 6), wrenches in all states; default: those of the scene."""
        if wrenches is None:
            wrenches = q.new_tensor(numpy.array([push.wrench for push in self.scene.wrenches])).reshape(-1, 6)
        one = q.dim() == 1
        if one:
            q, v, u = q[None], v[None], u[None]
        a, f = _Solve.apply(self, self._unit(q), v, u, wrenches)
        return (a[0], f[0]) if one else (a, f)

    def _set(self, active, wrenches):
        self.batch.active = active
        self.batch.wrenches = wrenches

    def _unit(self, q):
        if not self._quaternions:
            return q
        parts, last = [], 0
        for first, _ in self._quaternions:
            four = slice(first + 3, first + 7)
            parts += [q[:, last : four.start], torch.nn.functional.normalize(q[:, four], dim=1, eps=0)]
            last = four.stop
        return torch.cat([*parts, q[:, last:]], dim=1)

    def _by_numbers_of_q(self, q, w):
        """From gradients on the tangent space, (n, nv), those by q's own numbers, across unit quaternions."""
        out = numpy.zeros_like(q)
        out[:, self._same[0]] = w[:, self._same[1]]
        for i, k in self._planes:  # moves in the axes that turn with it
            c, s = numpy.cos(q[:, i + 2]), numpy.sin(q[:, i + 2])
            out[:, i] = c * w[:, k] - s * w[:, k + 1]
            out[:, i + 1] = s * w[:, k] + c * w[:, k + 1]
            out[:, i + 2] = w[:, k + 2]
        for i, k in self._quaternions:  # dp = R times the linear, d(xyz, w) = q times (angular, 0) / 2
            p, r = q[:, i + 3 : i + 6], q[:, i + 6 : i + 7]
            linear, angular = w[:, k : k + 3], w[:, k + 3 : k + 6]
            across = 2 * numpy.cross(p, linear)
            out[:, i : i + 3] = linear + r * across + numpy.cross(p, across)
            out[:, i + 3 : i + 6] = 2 * (r * angular + numpy.cross(p, angular))
            out[:, i + 6] = -2 * (p * angular).sum(axis=1)
        return out
