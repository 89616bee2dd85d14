"""Forward dynamics of many robots in contact, its derivatives, and optimal control.

    import manycontact as mc

    file = mc.load_scene("models/humanoid_standing.xml")
    data = mc.SceneData(file.scene)
    report = mc.solve(file.scene, file.q, file.v, file.u, data)     # data.a, data.f
    blocks = mc.differentiate(file.scene, data).islands[0]          # blocks.da_dq, ...

Names, shapes, units and conventions are those of the C++ library: linear part first, q = [x y z, qx qy qz qw] and v in
the base's own frame for a floating base, SI units. Bad input raises ValueError with the text of the C++ library.
"""

from . import _classes, _manycontact
from ._manycontact import *  # noqa: F401,F403
from ._manycontact import __version__  # noqa: F401
from .descriptions import description_path, load_description  # noqa: F401
from .files import joint_limits, load_urdf_text, srdf_configurations, write_scene  # noqa: F401
from .mcap import write_mcap  # noqa: F401
from .notebook import view  # noqa: F401

_classes.complete(_manycontact)
