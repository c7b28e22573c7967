"""What users read, kept: figures, reports, pictures and help, compared by value.

``python -m tests.goldens`` writes all of them anew; the diff of the commit shows what changed.
"""
