"""A method is data: what it may say, how its file is read, written and varied."""
