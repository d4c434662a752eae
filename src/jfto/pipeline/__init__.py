"""The whole job in one directory: terrain to report, stage by stage."""
