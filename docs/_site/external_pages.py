"""Pages of the site whose source lies outside the folder docs: README, notebooks, changelog, and targets of links."""

from __future__ import annotations

import re
from pathlib import Path

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.plugins import event_priority
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page

ROOT = Path(__file__).parents[2]
NOTEBOOKS = ROOT / "studies" / "notebooks"
FIRST_NOTEBOOKS = ("first_steps", "exploring_a_study", "designing_a_profile", "verification")
LINKED_FILES = ("studies/*.toml", "studies/*.py", "LICENSE", "CITATION.cff")
"""Files that pages link to as they lie in the repository."""

DIAGRAMS = re.compile(r'<script type="module">(?:(?!</script>).)*mermaid.*?</script>', re.DOTALL)
"""Script in every notebook's page that loads diagrams from another host; the notebooks contain no diagrams."""

PAGES = {
    "index.md": "README.md",
    "contributing.md": "CONTRIBUTING.md",
    "releasing.md": "RELEASING.md",
    "changelog.md": "CHANGELOG.md",
}


def on_config(config: MkDocsConfig) -> MkDocsConfig:
    """Put the notebooks into the navigation."""
    names = [
        *FIRST_NOTEBOOKS,
        *sorted(path.stem for path in NOTEBOOKS.glob("*.ipynb") if path.stem not in FIRST_NOTEBOOKS),
    ]
    for section in config.nav or []:
        for entry in next(iter(section.values())):
            if isinstance(entry, dict) and entry.get("Notebooks") == "notebooks":
                entry["Notebooks"] = [f"notebooks/{name}.ipynb" for name in names]
    return config


@event_priority(100)  # before the notebooks are looked for
def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add the pages."""
    for path in sorted(NOTEBOOKS.glob("*.ipynb")):
        name = f"notebooks/{path.name}"
        files.append(File(name, str(NOTEBOOKS.parent), config.site_dir, use_directory_urls=config.use_directory_urls))
    for pattern in LINKED_FILES:
        for path in sorted(ROOT.glob(pattern)):
            files.append(File.generated(config, str(path.relative_to(ROOT)), content=path.read_bytes()))
    for page, source in PAGES.items():
        text = (ROOT / source).read_text().replace("](docs/", "](")
        for name, original in PAGES.items():
            text = text.replace(f"]({original})", f"]({name})")
        files.append(File.generated(config, page, content=text))
    return files


def on_page_markdown(markdown: str, **_: object) -> str:
    """Links out of the folder docs lead to the copies in the site."""
    markdown = markdown.replace("](../../studies/notebooks/", "](../notebooks/")
    return markdown.replace("](../../studies/", "](../studies/")


def on_page_content(content: str, *, page: Page, **_: object) -> str:
    """Remove the diagrams of notebooks, which a browser would fetch from other hosts."""
    return DIAGRAMS.sub("", content) if page.file.src_uri.endswith(".ipynb") else content
