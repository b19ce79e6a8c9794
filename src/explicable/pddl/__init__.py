"""Reading and writing PDDL."""
