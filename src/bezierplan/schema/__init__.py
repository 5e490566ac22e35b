"""What every floor may use: models of mappings (`model`), and YAML read strictly (`checked`)."""
