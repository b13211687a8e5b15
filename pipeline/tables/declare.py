"""Dataframely, in which tables are declared. Modules import it from here.

It imports SQLAlchemy, which takes 0.5 s of processor time: only what declares, checks or describes
tables imports this module.
"""

import dataframely as dy

__all__ = ["dy"]
