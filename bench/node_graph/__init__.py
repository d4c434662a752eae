"""What bench/graph.py measures of the node graph."""
