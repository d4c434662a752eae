"""Several vehicles as one: upload that releases all or none, start, flight to the end."""
