"""How uncertain a number is: sampling noise, propagation into a curve, the ensemble."""
