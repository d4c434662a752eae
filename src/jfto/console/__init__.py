"""The one console: lines that stay, and what is drawn below them. Knows no other room."""
