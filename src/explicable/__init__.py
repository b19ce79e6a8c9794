"""Robot plans that human teammates expect."""
