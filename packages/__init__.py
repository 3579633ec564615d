"""The build of the packages that users install: the wheels and the container image."""
