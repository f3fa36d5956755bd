"""A plain compiled loop of the same arithmetic, against which the stepper is measured on a block without
contact.
"""
