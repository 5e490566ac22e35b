"""Files of studies read strictly: YAML, frozen models of mappings, and one-line faults."""
