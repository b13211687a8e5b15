"""The site of plain files: every page made from the tables, written beside and swapped in whole.

`pages` says what stands on which page, `render` turns that into files; texts stand in
`dashboards.words`, charts in `dashboards.figures`, numbers in the warehouse.
"""

from herijk.dashboards.site.render import build_pages, build_site

__all__ = ["build_pages", "build_site"]
