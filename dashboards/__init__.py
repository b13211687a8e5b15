"""Who shows: figures and the site of plain files. Reads finished tables, computes nothing new.

- Pages and papers: `site`, `workbench`, `documents`, the page of a rebuild
  (`report_page`), and the project's own documents as pages (`guides`, `markdown`).
- Pictures as files: `audit_plots`.
- Charts: `figures`, drawn without a browser by `drawn`, in the `fonts` of the pages.
- Sentences: `statements`, and numbers as people write them (`speech`).
- Underneath: `html`, texts that are `kept`, and the `guard` of every server.
"""
