"""Cross references of the docstrings: ``:func:`name``` becomes a link to where the name is documented."""

from __future__ import annotations

import re

from griffe import AliasResolutionError, Extension, NameResolutionError, Object

ROLE = re.compile(r":(?:func|class|meth|data|mod|attr):`(~?)([\w.]+)`")


class Roles(Extension):
    """Rewrites the roles of every docstring that is loaded."""

    def on_object(self, *, obj: Object, **_: object) -> None:
        """Replace the roles in the docstring of one object."""
        if obj.docstring is not None:
            text = ROLE.sub(lambda match: _link(obj, match[2], bool(match[1])), obj.docstring.value)
            obj.docstring.value = text.replace("::\n\n", ":\n\n")


def _link(obj: Object, name: str, is_short: bool) -> str:
    """Return a link that stays plain code where the name is not documented on its own."""
    try:
        target = name if name.startswith("contactstudy.") else obj.resolve(name)
    except (NameResolutionError, AliasResolutionError):
        target = name
    text = name.rpartition(".")[2] if is_short or name.startswith("contactstudy.") else name
    return f'<autoref optional identifier="{target}"><code>{text}</code></autoref>'
