"""pytest runs every folder with a test.json."""
pytest_plugins = ["trilens.pytest_plugin"]
