"""Who shows: figures and pages made from finished tables. Computes nothing new."""
