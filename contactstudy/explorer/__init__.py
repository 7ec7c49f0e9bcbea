"""Interactive page of a study: choices of swept parameters, figures and numbers of a case, and of a second one.

It needs the extra ``explore``: ``pip install "contactstudy[explore]"``.
"""

from contactstudy.explorer.server import explore, serve

__all__ = ["explore", "serve"]
