"""Where search meets labelling."""
