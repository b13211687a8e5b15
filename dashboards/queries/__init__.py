"""What each document is about: one query per template, which gives its rows and verdicts, no words.

Queries read tables and compute no number about a boat: numbers and verdicts are made by `pipeline`.
"""
