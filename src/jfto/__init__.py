"""The front: command line, scenarios, pipeline, figures and report."""

__version__ = "0.1.0"
