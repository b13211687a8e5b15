"""Reading a table that people typed: from its bytes to rows with values.

Of every list alike. What the columns of each list mean is in `lists`.
"""
