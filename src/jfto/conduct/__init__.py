"""Takes a fleet through its flight: link, upload, check, start, follow, home."""
