"""Layouts of panels, which people keep under names."""
