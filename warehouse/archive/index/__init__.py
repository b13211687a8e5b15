"""What is in an archive: its boats, its tows with their files, and what is set aside."""
