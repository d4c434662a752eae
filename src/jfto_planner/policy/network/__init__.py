"""The network and its environment in tensors: what a trainer trains, on any device."""
