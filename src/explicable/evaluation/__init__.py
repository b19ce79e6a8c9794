"""Experiments, records, tables and reports."""
