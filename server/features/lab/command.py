"""`mucat lab`."""

import click


@click.group()
def lab() -> None:
    """Run a lab: a server without a robot, which keeps the sessions of several."""
