"""Data generation: registered configurations and the command that runs them."""
