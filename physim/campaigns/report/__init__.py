"""What the rows of a campaign say: a table for the terminal, values, and one page of HTML."""
