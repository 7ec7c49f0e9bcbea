"""A page to look through a study: choices for what was swept, figures that follow, two cases side by side.

It needs the extra ``explore``: ``pip install "contactstudy[explore]"``.
"""

from contactstudy.explorer.server import serve
from contactstudy.explorer.show import explore

__all__ = ["explore", "serve"]
