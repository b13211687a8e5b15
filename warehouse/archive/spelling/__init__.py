"""How people write things: text, numbers, dates, units, and the names of columns.

Knows no file and no list. What people may say in other words is in `synonyms` and
`units`; nothing is guessed from the size of a number.
"""
