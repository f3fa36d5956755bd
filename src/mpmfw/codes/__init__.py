"""Other codes as methods: an adapter writes a code's input from a scene, runs it, and reads its outputs."""
