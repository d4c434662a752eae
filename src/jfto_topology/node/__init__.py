"""The topology node: messages in and out of the core, markers, diagnostics."""
