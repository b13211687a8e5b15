"""The workbench: try values of options that no method has, and save them as a method file.

What is asked is in the address, so a link shows the same to others. `form` makes controls of the
model of a method, `bench` makes of an address a method and what follows from it, `server` listens
on loopback; the page is a template like all others.
"""
