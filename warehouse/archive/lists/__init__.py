"""The lists of an archive, each in its module, and the points of a curve that anybody typed.

How any list is read is in `sheets`; what lists say about each other belongs to `index`.
"""
