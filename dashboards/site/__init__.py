"""The site of plain files: every page made from the tables, written beside and swapped in whole.

`pages` says what is on which page, `render` turns that into files; texts are in
`words`, charts in `dashboards.figures`, numbers in the warehouse.
"""
