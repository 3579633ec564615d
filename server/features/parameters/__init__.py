"""Parameters as people tune them: who changed what, undo, and profiles kept under names."""
