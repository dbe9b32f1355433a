"""Fractional-order terminal sliding mode control on Pinocchio, for any arm that has a URDF.

The public names are in `__init__.pyi`; each is imported when it is first used.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

__version__ = "0.2.0"

del lazy_loader
