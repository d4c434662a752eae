"""Vocabulary: the records, units and errors that cross borders."""
