"""Who shows: figures and the site of plain files. Reads finished tables, computes nothing new."""
