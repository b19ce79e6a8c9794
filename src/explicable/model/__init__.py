"""Planning models as frozen values."""
