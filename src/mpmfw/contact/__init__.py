"""Contact: a detection lists rows, where two bodies may touch; a law turns them into forces or impulses."""
