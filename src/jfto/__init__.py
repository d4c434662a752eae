"""The front: command line, scenario, pipeline and report."""
