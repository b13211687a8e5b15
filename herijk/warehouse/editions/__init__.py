"""Editions: registers that were published, each a folder that is never changed afterwards.

| module | holds |
| --- | --- |
| `publish` | from the tables of a method, or a printed register, to an edition |
| `inputs` | the tows and files that go in, and their hashes |
| `lines` | the lines that a method gives on a day, at publication or made again |
| `sheets` | the register as people read it: CSV, XLSX, data package, verification codes |
| `compare` | two editions side by side, with causes and effect on races |
| `notes` | the release notes of an edition, in Dutch |
| `verify` | whether editions and archive are what they were, and editions can be made again |
| `lineage` | from a printed line to files, runs and seconds |

Nothing here looks at a clock: the day of publication is handed in.
"""
