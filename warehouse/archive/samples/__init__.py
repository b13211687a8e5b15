"""Reading the samples of a tow, from whatever file they are in to the frame that is worked with.

Form only. Whether they can be true is the business of `plausibility`.
"""
