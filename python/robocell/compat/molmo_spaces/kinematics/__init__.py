"""Forward and inverse kinematics, and a tool that tests them."""
