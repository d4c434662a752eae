"""The stages of the pipeline, each from records to records."""
