"""Whether the samples of a tow can be true: missing pieces, dead or stuck instruments, mix-ups.

A fault costs what it touches. Up to `LEFT_OUT_S` of a run may be no number, drop out or spike:
those samples become NaN, and no sum counts them. Longer faults cost the run; of log 2 and the GPS,
which only check and calibrate, the channel in that run. What makes every run doubtful (columns
exchanged, a wrong unit, another boat's samples) costs the tow. Judging a good tow (steady windows,
agreement of out and back) is measuring method and belongs to `pipeline`.
"""
