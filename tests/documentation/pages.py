"""The pages of the project."""

GENERATED = ("REFERENCE.md", "EXTREMES.md")


def pages_of(source):
    """All Markdown files below a folder, but those of build folders and templates."""
    return sorted(page for page in source.rglob("*.md")
                  if not any(part.startswith((".", "build")) or part == "templates"
                             or part.endswith(".out")
                             for part in page.relative_to(source).parts))


def is_generated(page):
    return page.name in GENERATED
