"""The site of plain files: every page made from the tables, written beside and swapped in whole.

`pages` says what is on which page, `parts` what a page is made of, and `render` turns that into
files. Charts are in `dashboards.figures`, numbers in the warehouse.
"""
