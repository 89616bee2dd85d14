"""Contact dynamics and derivatives of one robot by manycontact and, where it is installed, by Pinocchio.

    beside_pinocchio.py models/humanoid.urdf left_sole right_sole

Each link named is fixed in 6D. Both libraries are given the same URDF, configuration, velocity and torques. The program
prints differences, relative to the largest number, and medians of times, which include the calls from Python.
"""

import sys
import time

import manycontact as mc
import numpy as np

try:
    import pinocchio as pin
except ImportError:
    pin = None


def median_us(call):
    """The median time of a call, after one that is not counted."""
    times = []
    for k in range(301):
        before = time.perf_counter()
        call()
        times.append(time.perf_counter() - before)
    return 1e6 * np.median(times[1:])


class Manycontact:
    def __init__(self, urdf, links):
        self.scene = mc.Scene()
        mc.add_robot(self.scene, "robot", mc.load_urdf(urdf, floating_base=True))
        for link in links:
            mc.add_contact(self.scene, mc.Contact(name=link, type="6d", A=mc.attach(self.scene, "robot", link)))
        self.data = mc.SceneData(self.scene)

    def solve(self):
        mc.solve_tau(self.scene, *self.state, self.data)

    def differentiate(self):
        mc.differentiate(self.scene, self.data)

    def results(self):
        d = mc.dense_derivatives(self.scene, self.data)
        return {"a": self.data.a, "f": self.data.f, "da_dq": d.da_dq, "da_dv": d.da_dv, "da_du": d.da_du}


class Pinocchio:
    def __init__(self, urdf, links):
        self.model = pin.buildModelFromUrdf(urdf, pin.JointModelFreeFlyer())
        self.data = self.model.createData()
        self.contacts, self.of_contacts = pin.StdVec_RigidConstraintModel(), pin.StdVec_RigidConstraintData()
        for link in links:
            frame = self.model.frames[self.model.getFrameId(link)]
            contact = pin.RigidConstraintModel(
                pin.ContactType.CONTACT_6D, self.model, frame.parentJoint, frame.placement, pin.ReferenceFrame.LOCAL
            )
            self.contacts.append(contact)
            self.of_contacts.append(contact.createData())
        pin.initConstraintDynamics(self.model, self.data, self.contacts)
        self.settings = pin.ProximalSettings(1e-12, 0, 1)  # sound for independent contacts; otherwise (1e-12, 1e-6, 20)

    def solve(self):
        pin.constraintDynamics(self.model, self.data, *self.state, self.contacts, self.of_contacts, self.settings)

    def differentiate(self):
        pin.computeConstraintDynamicsDerivatives(self.model, self.data, self.contacts, self.of_contacts, self.settings)

    def results(self):
        f = np.concatenate([contact.contact_force.vector for contact in self.of_contacts])
        d = self.data
        return {"a": d.ddq, "f": f, "da_dq": d.ddq_dq, "da_dv": d.ddq_dv, "da_du": d.ddq_dtau[:, 6:]}


urdf, *links = sys.argv[1:]
ours = Manycontact(urdf, links)
libraries = {"manycontact " + mc.__version__: ours}
if pin:
    theirs = Pinocchio(urdf, links)
    libraries["Pinocchio " + pin.__version__] = theirs
    if theirs.model.nq != ours.scene.nq:
        sys.exit("nq differs: a continuous joint has two numbers in Pinocchio and one here")
else:
    print("Pinocchio is missing: Python has no module pinocchio, so that nothing is compared.")

random = np.random.default_rng(0).standard_normal
q = mc.integrate(ours.scene, mc.neutral(ours.scene), 0.2 * random(ours.scene.nv))
mc.resolve_references(ours.scene, q)  # the links are fixed where they are at q, and at rest
v = mc.make_consistent(ours.scene, q, random(ours.scene.nv)).v
tau = np.concatenate([np.zeros(6), 5 * random(ours.scene.nv - 6)])
found = {}
for name, library in libraries.items():
    library.state = q, v, tau
    solve = median_us(library.solve)
    print(f"{name}: solve {solve:.1f} us, derivatives {median_us(library.differentiate):.1f} us")
    found[name] = library.results()
expected, *others = found.values()
for other in others:
    for quantity, values in other.items():
        print(f"{quantity} differs by {abs(values - expected[quantity]).max() / abs(expected[quantity]).max():.1e}")
