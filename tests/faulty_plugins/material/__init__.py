"""Materials that are wrong on purpose, each in one thing: the conformance kit must catch every one."""
