"""References: desired position, velocity and acceleration as functions of time.

Each is a frozen callable `t -> (q_d, v_d, a_d)` of shapes (nq,), (nv,), (nv,) that returns fresh
arrays. Any other callable of this kind will do as well.

The public names stand in `__init__.pyi`; each is imported when it is first used, as the splines'
part of SciPy takes most of a second.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

del lazy_loader
