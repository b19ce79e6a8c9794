"""The first-response domain of the paper."""
