"""Working together with a person."""
