r"""Equations become MathML while the site is built: no script, no font and no network when it is read.

A displayed equation with ``\tag{3}`` gets its number and the anchor ``#eq-3``.
"""

from __future__ import annotations

import html
import re

from latex2mathml.converter import convert
from mkdocs.structure.pages import Page

DISPLAYED = re.compile(r"^\$\$\n(.*?)^\$\$$", re.DOTALL | re.MULTILINE)
TAG = re.compile(r"\\tag\{([^}]+)\}")
BLOCK = re.compile(r'<div class="arithmatex">\\\[(.*?)\\\]</div>', re.DOTALL)
INLINE = re.compile(r'<span class="arithmatex">\\\((.*?)\\\)</span>', re.DOTALL)
IN_NOTEBOOK = re.compile(r"(?<![\\$\w])\$([^$<>\n]{1,60})\$(?![\w$])")
FUNCTION = re.compile(
    r"<mi>(?:sin|cos|sinh|cosh|tanh|coth|exp|ln)</mi>(?=<m[in])|(?<=</m[in]>)(?=<mi>(?:sin|cos|sinh|cosh|tanh|coth)</mi>)"
)
CODE = re.compile(r"(<pre.*?</pre>|<code.*?</code>|<script.*?</script>|<style.*?</style>)", re.DOTALL)


def on_page_markdown(markdown: str, **_: object) -> str:
    """Put an anchor before every numbered equation."""

    def anchored(match: re.Match[str]) -> str:
        tag = TAG.search(match[1])
        return f'<div class="anchor" id="eq-{tag[1]}"></div>\n\n{match[0]}' if tag else match[0]

    return DISPLAYED.sub(anchored, markdown)


def on_page_content(content: str, *, page: Page, **_: object) -> str:
    """Replace TeX by MathML."""
    content = BLOCK.sub(_block, content)
    content = INLINE.sub(lambda match: _mathml(html.unescape(match[1])), content)
    if page.file.src_uri.endswith(".ipynb"):
        parts = CODE.split(content)
        parts[::2] = [IN_NOTEBOOK.sub(lambda match: _mathml(html.unescape(match[1])), part) for part in parts[::2]]
        content = "".join(parts)
    return content


def _block(match: re.Match[str]) -> str:
    source = html.unescape(match[1])
    tag = TAG.search(source)
    shown = _mathml(TAG.sub("", source).strip(), display="block")
    number = f'<span class="number">({tag[1]})</span>' if tag else ""
    return f'<div class="equation"><div>{shown}</div>{number}</div>'


def _mathml(source: str, display: str = "inline") -> str:
    """Return TeX as MathML, with a thin space around the names of functions."""
    return FUNCTION.sub(lambda match: f'{match[0]}<mspace width="0.167em" />', convert(source, display=display))
