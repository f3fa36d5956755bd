"""State of a simulation: fields, structs of arrays, pairs, windows and declared history."""
