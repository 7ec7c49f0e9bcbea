"""What a pressure does to a body: displacement of the top, fields inside, equivalent loads."""
