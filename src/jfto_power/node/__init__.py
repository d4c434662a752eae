"""The power and radio nodes: messages in and out, diagnostics."""
