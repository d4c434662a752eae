"""Links: bytes in and out over UDP, TCP and serial lines, frames and signatures."""
