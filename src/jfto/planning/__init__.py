"""From a scenario to a certified plan, each stage from records to records."""
