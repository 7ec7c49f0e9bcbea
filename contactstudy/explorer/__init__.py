"""Interactive page of a study: choices of swept parameters, figures and numbers of one case or of two cases.

The page needs the extra ``explore``: ``pip install "contactstudy[explore]"``.
"""

from contactstudy.explorer.server import explore, serve

__all__ = ["explore", "serve"]
