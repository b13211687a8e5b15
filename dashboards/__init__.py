"""Who shows: every document as a page, as text and on paper. Reads finished tables.

- A document is a query (`queries`) and a template (`templates`); `document` fills it in one
  language.
- It is shown as a page of the site (`page`, `site`), as text (`terminal`), on paper (`paper`), on
  the `workbench`, and in reports and mail (`reports`); `reading` turns a page into blocks.
- What templates call things: `columns`, `words`, `language`. Charts: `charts`, drawn on a `plot`.
"""
