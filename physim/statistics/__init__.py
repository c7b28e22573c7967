"""How sure a figure from a number of runs is: intervals, tests, and goals that stop a campaign."""
