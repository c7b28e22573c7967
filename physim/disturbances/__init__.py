"""What the real world does to robots: sensing stages and disturbances by name, one a file.

Everything random in them is a pure function of seed, step and robots (`physim.randomness`), and
what they remember is what happened, so states do not depend on who looks.
"""
