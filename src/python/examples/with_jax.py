"""Batches of states in jax, by pure_callback.

    with_jax.py models/arm.urdf

For robots whose joints have one number each: there gradients on the tangent space are those by q (manycontact/torch.py
has the others).
"""

import sys

import jax
import jax.numpy as jnp
import manycontact as mc
import numpy as np

jax.config.update("jax_enable_x64", True)
scene = mc.Scene()
mc.add_robot(scene, "arm", mc.load_urdf(sys.argv[1], armature=0.1))
mc.add_contact(scene, mc.Contact(name="tool", type="3d", A=mc.attach(scene, "arm", "tool")))
batch = mc.BatchData(scene)
rows = sum(contact.rows for contact in scene.contacts)


def shapes(n, *columns):
    return tuple(jax.ShapeDtypeStruct((n, k), jnp.float64) for k in columns)


@jax.custom_vjp
def dynamics(q, v, u):
    """(a, f): (n, nv), (n, rows)."""
    return jax.pure_callback(
        lambda *x: mc.solve_batch(scene, *map(np.asarray, x), batch)[:2], shapes(len(q), scene.nv, rows), q, v, u
    )


def forward(q, v, u):
    return dynamics(q, v, u), (q, v, u)


def backward(state, weights):
    return jax.pure_callback(
        lambda *x: mc.vjp_batch(scene, *map(np.asarray, x), batch)[:3],
        shapes(len(state[0]), scene.nq, scene.nv, scene.nu),
        *state,
        *weights,
    )


dynamics.defvjp(forward, backward)

rng = np.random.default_rng(1)
q, v, u = (jnp.asarray(rng.standard_normal((5, k))) for k in (scene.nq, scene.nv, scene.nu))
mc.resolve_references(scene, np.asarray(q[0]))
value = jax.jit(lambda q, v, u: sum((x**2).sum() for x in dynamics(q, v, u)))
gradient = jax.grad(value)(q, v, u)
step, h = jnp.asarray(rng.standard_normal(q.shape)), 1e-5
difference = (value(q + h * step, v, u) - value(q - h * step, v, u)) / (2 * h)
print((gradient * step).sum(), difference)
assert abs((gradient * step).sum() - difference) < 1e-5 * abs(difference)
