"""Flight modes: one file each; every mode moves the target that the body follows."""
