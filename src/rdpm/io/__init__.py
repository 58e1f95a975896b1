"""Tables, fields and provenance: what a run writes, and how it is read back."""
