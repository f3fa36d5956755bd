"""Time steps: their schemes, their length, the transfer between points and grid, and threads."""
