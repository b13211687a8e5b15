"""Are equal boats equal? Statistics of boats of one type and of repeated tows.

Belongs here: what a table of curves says about boats of a type (`compared`, `lines`,
`homogeneity`), about the speed of the tow (`tow_speed`), about repeats (`repeats`, `eras`,
`components`) and about a boat that was only measured (`prediction`). Does not belong here: how a
curve is made, which differences matter to a race (`pipeline.register.changes`), and any judgement:
tables say, people decide.

`observed` joins the tables and carries the measuring errors; `mixed` describes what is fitted to
`reml`; `tables` puts it all together.
"""
