"""Updates of an installed robot that the page asks for."""
