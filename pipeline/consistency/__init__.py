"""Are equal boats equal? Boats of one type, and repeated tows of one boat.

Read in this order: `observed` joins the tables and brings curves to one speed; `repeats` is about
several tows of one boat, and `noise` what they say of the measuring errors; `boat_model` is the
statistical model; `types` fits it per type and quantity and gives the verdicts; `compared` puts
every tow beside its type; `prediction` does without a tow. How a curve is made does not belong
here, nor which differences matter to a race (`pipeline.register.changes`).
"""
