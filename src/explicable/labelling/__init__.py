"""Learning from labelled plans what people find explicable."""
