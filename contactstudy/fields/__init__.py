"""Response of a body to a pressure: displacement of the top, fields inside, equivalent loads."""
