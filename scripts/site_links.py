"""A hook of mkdocs: links to files of the tree that are no pages, ../examples/fit_record.cc, become
text."""
import re


def on_page_markdown(markdown, **_):
    return re.sub(r"\[([^\]]*)\]\(\.\./[^)]*\)", r"\1", markdown)
