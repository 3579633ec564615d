"""The bring-up of a robot, from the page and the shell."""
