r"""Equations become MathML while the site is built: no script, no font and no network when it is read.

A displayed equation with ``\tag{3}`` gets its number and the anchor ``#eq-3``.
"""

from __future__ import annotations

import html
import re

from latex2mathml.converter import convert
from mkdocs.structure.pages import Page

DISPLAYED_EQUATION = re.compile(r"^\$\$\n(.*?)^\$\$$", re.DOTALL | re.MULTILINE)
NUMBER_TAG = re.compile(r"\\tag\{([^}]+)\}")
RENDERED_BLOCK = re.compile(r'<div class="arithmatex">\\\[(.*?)\\\]</div>', re.DOTALL)
RENDERED_INLINE = re.compile(r'<span class="arithmatex">\\\((.*?)\\\)</span>', re.DOTALL)
NOTEBOOK_FORMULA = re.compile(r"(?<![\\$\w])\$([^$<>\n]{1,60})\$(?![\w$])")
FUNCTION_NAME = re.compile(
    r"<mi>(?:sin|cos|sinh|cosh|tanh|coth|exp|ln)</mi>(?=<m[in])|(?<=</m[in]>)(?=<mi>(?:sin|cos|sinh|cosh|tanh|coth)</mi>)"
)
CODE = re.compile(r"(<pre.*?</pre>|<code.*?</code>|<script.*?</script>|<style.*?</style>)", re.DOTALL)


def on_page_markdown(markdown: str, **_: object) -> str:
    """Put an anchor before every numbered equation."""

    def add_anchor(match: re.Match[str]) -> str:
        tag = NUMBER_TAG.search(match[1])
        return f'<div class="anchor" id="eq-{tag[1]}"></div>\n\n{match[0]}' if tag else match[0]

    return DISPLAYED_EQUATION.sub(add_anchor, markdown)


def on_page_content(content: str, *, page: Page, **_: object) -> str:
    """Replace TeX by MathML."""
    content = RENDERED_BLOCK.sub(_render_block, content)
    content = RENDERED_INLINE.sub(lambda match: _render_mathml(html.unescape(match[1])), content)
    if page.file.src_uri.endswith(".ipynb"):
        texts = CODE.split(content)
        texts[::2] = [
            NOTEBOOK_FORMULA.sub(lambda match: _render_mathml(html.unescape(match[1])), text) for text in texts[::2]
        ]
        content = "".join(texts)
    return content


def _render_block(match: re.Match[str]) -> str:
    source = html.unescape(match[1])
    tag = NUMBER_TAG.search(source)
    mathml = _render_mathml(NUMBER_TAG.sub("", source).strip(), display="block")
    number = f'<span class="number">({tag[1]})</span>' if tag else ""
    return f'<div class="equation"><div>{mathml}</div>{number}</div>'


def _render_mathml(source: str, display: str = "inline") -> str:
    """Return TeX as MathML, with a thin space around the names of functions."""
    return FUNCTION_NAME.sub(lambda match: f'{match[0]}<mspace width="0.167em" />', convert(source, display=display))
