"""What is done with saved results: run again, cite."""
