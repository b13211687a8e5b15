"""The methods that come with the package, one TOML file each. No code here."""
